// the nanopositioner's project once, then every file it wrote.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "base/documents/document.hpp"
#include "base/text.hpp"
#include "browser_check.hpp"
#include "chain/model_file.hpp"
#include "cli/main_example.hpp"
#include "kept_text.hpp"
#include "lti/cascade.hpp"
#include "lti/sections.hpp"
#include "run_program.hpp"
#include "signal/csv.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kProject = std::string(BODESMITH_SOURCE_DIR) + "/examples/nanopositioner/seed.toml";

/// The paper's design at two frequencies or one and a given clock, which spares every alternative its search (tests/project has the clocks that are found).
void write_with_clock(const fs::path& folder, const std::string& fpaa_percent,
                      const std::string& hz = "1, 100", const std::string& measured_percent = "0.98, 0.56") {
  fs::copy(fs::path(kProject).parent_path(), folder, fs::copy_options::recursive);
  std::string text =
      replaced(read_file(kProject), "fpaa_percent = 0.05 ", "fpaa_percent = " + fpaa_percent + " ");
  text = replaced(text, "(\\[hardware.fpaa\\]\n)", "$1clock_hz = 2000.0\n");
  text = replaced(text, "frequency_hz = \\[1, 10, 20, [^\\]]*", "frequency_hz = [" + hz);
  text = replaced(text, "measured_percent = [^\\]]*", "measured_percent = [" + measured_percent);
  write_file(folder / "seed.toml", text);
}

fs::path written(const std::string& name) {
  return main_example().folder / name;
}
Node written_json(const std::string& name) {
  return parse_json(read_file(written(name)), name);
}

TEST(MainExample, EndsWellAndWritesEveryArtefact) {
  ASSERT_EQ(main_example().result.status, 0) << main_example().result.err;
  for (const char* name : {"cascade.json", "sections.json", "fpaa/plan.json", "spice/compensator.sub",
                           "spice/parts.csv", "layout/layout.json", "layout/disturbance.sub", "run.json",
                           "report.html", "bode.csv", "tracking.csv"}) {
    EXPECT_TRUE(fs::is_regular_file(written(name))) << name;
  }
  EXPECT_THAT(main_example().result.out, HasSubstr("report.html"));
}

TEST(MainExample, EveryJsonHasSchemaVersionAndInputs) {
  for (const auto& entry : fs::recursive_directory_iterator(main_example().folder)) {
    if (entry.path().extension() != ".json") continue;
    const Node node = parse_json(read_file(entry.path()), entry.path().string());
    EXPECT_THAT(node.at("schema").string(), ::testing::StartsWith("bodesmith.")) << entry.path();
    EXPECT_THAT(node.at("program").string(), ::testing::StartsWith("bodesmith ")) << entry.path();
    EXPECT_GT(node.at("inputs").size(), 0u) << entry.path();
    for (const Node& input : node.at("inputs").items()) EXPECT_EQ(input.at("sha256").string().size(), 64u);
  }
}

TEST(MainExample, InterpolatesEveryPoint) {
  Provenance from;
  const Cascade cascade = Cascade::read(written("cascade.json"), from);
  // Facts: solving eq. 18 for exactly the printed gains gives these orders.
  ASSERT_EQ(cascade.terms.size(), 4u);
  const double wanted[] = {-0.0428, 1.0245, -1.2113, 2.2908};
  for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(cascade.terms[i].beta, wanted[i], 1e-4);
  for (const auto& [f, gain] : {std::pair{10.0, 1.06}, {20.0, 1.1}, {60.0, 1.04}, {100.0, 1.17}}) {
    EXPECT_NEAR(cascade.magnitude_db(Hertz{f}.rad_s()), to_decibel(gain), 1e-9);
  }
}

TEST(MainExample, PlanStaysCloseToTheSections) {
  const Node plan = written_json("fpaa/plan.json");
  // Stages follow their input through phase 1 and keep its value through phase 2: no half period of delay. At a clock that is
  // searched most of what boards are off is mismatch.
  const double designed = plan.at("error_with_delays").at("max_complex_percent").number();
  EXPECT_LE(designed, 0.02);
  EXPECT_LE(plan.at("total").at("p95_percent").number(), 0.2);
  EXPECT_GE(plan.at("total").at("p95_percent").number(), designed);
  EXPECT_GE(plan.at("total").at("at_input_v").number(), 2.0);
}

TEST(MainExample, TrackingTableKnowsEveryDesignAndSaysTheSurprise) {
  const Csv table = Csv::parse(read_file(written("tracking.csv")), "tracking.csv");
  EXPECT_EQ(table.rows(), 7u);
  for (const char* column :
       {"frequency_hz", "none_percent", "polynomial_percent", "cascade_percent", "sections_percent",
        "fpaa_percent", "fpaa_with_holds_percent", "circuit_percent"}) {
    EXPECT_TRUE(table.has(column)) << column;
  }
  // Without compensation the loop's full width is the error: several percent. The fixed polynomial is exact at 1 Hz
  // by the formula alone: the stage reads its drive.
  EXPECT_GT(table.column("none_percent")[0], 3.0);
  EXPECT_LT(table.column("polynomial_on_reference_percent")[0], 0.1);
  EXPECT_NEAR(table.column("polynomial_percent")[0], 0.616, 0.01);
  EXPECT_LT(table.column("self_fed_percent")[0], 0.01);
  // Magnitude-only compensation turns the phase: worse than the fixed polynomial at 100 Hz, and the program
  // says so.
  EXPECT_GT(table.column("cascade_percent")[6], table.column("polynomial_percent")[6]);
  EXPECT_THAT(read_file(written("summary.txt")), HasSubstr("worse"));
}

TEST(MainExample, ReportIsOneSelfContainedPage) {
  const std::string html = read_file(written("report.html"));
  EXPECT_THAT(html, HasSubstr("content=\"default-src &apos;none&apos;; script-src &apos;sha256-"));
  EXPECT_THAT(html, Not(HasSubstr("<script src")));
  EXPECT_THAT(html, Not(HasSubstr("<link")));
  EXPECT_FALSE(has_match(html, "(src|href)=\"(https?:)?//")) << "something is loaded from outside";
  EXPECT_THAT(html, Not(HasSubstr(">nan")));
  for (const char* chapter : {"Target", "Fit", "Sections", "Error budget", "FPAA", "Circuit",
                              "Disturbance generator", "Tracking"}) {
    EXPECT_THAT(html, HasSubstr(std::string("<h2>") + chapter)) << chapter;
  }
  for (const char* drawing : {"Op-amp circuit", "Disturbance generator"})
    EXPECT_THAT(html, HasSubstr(std::string("<title>") + drawing + "</title>"));
}

// What the page says of every alternative is what run.json says.
TEST(MainExample, AlternativesAreChosenInThePage) {
  if (const std::string why = no_browser(); !why.empty()) GTEST_SKIP() << why;
  const ProgramResult checked =
      drive_page("check_pages.py", written("report.html").string() + " " + written("run.json").string());
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  EXPECT_LT(read_file(written("report.html")).size(), 1000000u);
}

// Styles and ids of one drawing must not reach another: the page shows each as its own file does, element by element.
TEST(MainExample, DrawingsInThePageLookAsTheirFilesDo) {
  if (const std::string why = no_browser(); !why.empty()) GTEST_SKIP() << why;
  const ProgramResult checked = drive_page(
      "check_drawings.py", written("report.html").string() + " " + written("fpaa/board.svg").string() + " " +
                               written("layout/disturbance.svg").string());
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
}

TEST(MainExample, BodeReadsEveryArtefactInOneTable) {
  const bool ngspice = run_shell("command -v ngspice").status == 0;
  const std::string files = written("cascade.json").string() + " " + written("sections.json").string() + " " +
                            written("fpaa/plan.json").string() + " " + std::string(BODESMITH_SOURCE_DIR) +
                            "/examples/nanopositioner/gains.csv " +
                            (ngspice ? written("spice/compensator.sub").string() : std::string());
  const TemporaryFolder folder;
  const fs::path table = folder / "bode.csv";
  const ProgramResult result =
      run_bodesmith("bode " + files + " --from-hz 1 --to-hz 100 --count 41 -o " + table.string());
  ASSERT_EQ(result.status, 0) << result.err;
  const Csv csv = Csv::parse(read_file(table), "bode.csv");
  ASSERT_EQ(csv.rows(), 41u);
  // The complex error that the plan states, in dB and degrees, and a little for its grid.
  const double stated =
      1.02e-2 * written_json("fpaa/plan.json").at("error_with_delays").at("max_complex_percent").number();
  const double degrees = stated * 180.0 / std::numbers::pi;
  for (size_t i = 0; i < csv.rows(); ++i) {
    const double sections = csv.column("sections_magnitude_db")[i];
    EXPECT_NEAR(csv.column("plan_magnitude_db")[i], sections, -to_decibel(1.0 - stated));
    EXPECT_NEAR(csv.column("plan_phase_deg")[i], csv.column("sections_phase_deg")[i], degrees);
    if (ngspice) {
      EXPECT_NEAR(csv.column("compensator_magnitude_db")[i], sections, 0.02);
    }
  }
  EXPECT_NEAR(csv.column("gains_magnitude_db")[40], to_decibel(1.17), 1e-12);
  EXPECT_NEAR(csv.column("cascade_magnitude_db")[40], to_decibel(1.17), 1e-9);
}

TEST(Run, ALimitThatIsNotMetIsStatusOneAndASecondRunWritesTheSameBytesButForTimes) {
  const TemporaryFolder folder;
  write_with_clock(folder / "p", "0.0001", "100", "0.56");
  for (const char* out : {"one", "two"}) {  // without a simulator: the limit is the plan's
    const ProgramResult result =
        run_shell("BODESMITH_NGSPICE=/nowhere " + std::string(BODESMITH_PROGRAM) + " run " +
                  (folder / "p/seed.toml").string() + " -o " + (folder / out).string());
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.out, HasSubstr("fpaa_percent"));
  }
  EXPECT_TRUE(fs::exists(folder / "one/report.html")) << "a missed limit must not lose the results";
  int compared = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder / "one")) {
    if (!entry.is_regular_file()) continue;
    const auto without_times = [](const std::string& bytes) {
      return replaced(bytes, "\"timing_s\": \\{[^}]*\\}", "");
    };
    const fs::path twin = folder / "two" / fs::relative(entry.path(), folder / "one");
    ASSERT_TRUE(fs::exists(twin)) << twin;
    EXPECT_TRUE(without_times(read_file(entry.path())) == without_times(read_file(twin))) << entry.path();
    ++compared;
  }
  EXPECT_GT(compared, 10);
}

TEST(Run, AFitToTheWaveformTracksBetterThanTheMagnitude) {
  const TemporaryFolder folder;
  fs::copy(fs::path(kProject).parent_path(), folder / "p", fs::copy_options::recursive);
  write_file(folder / "p/waveform.toml",
             replaced(read_file(folder / "p/waveform.toml"), "frequency_hz = \\[1, 10, 20, 40, [^\\]]*",
                      "frequency_hz = [1, 40, 100"));
  const ProgramResult result =  // in closed form
      run_shell("BODESMITH_NGSPICE=/nowhere " BODESMITH_PROGRAM " run " +
                (folder / "p/waveform.toml").string() + " -o " + (folder / "out").string());
  ASSERT_EQ(result.status, 0) << result.err << result.out;
  const Csv table = Csv::parse(read_file(folder / "out/tracking.csv"), "tracking.csv");
  const auto worst = [&](const std::string& column) {
    return *std::max_element(table.column(column).begin(), table.column(column).end());
  };
  EXPECT_LT(worst("self_fed_circuit_percent"), 0.6 * worst("self_fed_percent"));
  EXPECT_LT(worst("circuit_on_reference_percent"), 0.5 * worst("cascade_on_reference_percent"));
  Provenance from;
  EXPECT_LE(Sections::read(folder / "out/sections.json", from).pole_count(), 6);
}

TEST(Run, DisturbancesThatNoLoopCanFollowAreOneLine) {
  const TemporaryFolder folder;
  fs::copy(fs::path(kProject).parent_path(), folder / "p", fs::copy_options::recursive);
  const std::string good = read_file(folder / "p/disturbance.json");
  const auto run_with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    write_file(folder / "p/disturbance.json", text);
    const ProgramResult result =
        run_bodesmith("run " + (folder / "p/project.toml").string() + " -o " + (folder / "out").string());
    EXPECT_EQ(result.status, 2) << to;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(folder / "out")) << to;
    return result.err;
  };
  EXPECT_THAT(run_with("[-0.2398, 0.0838, 0.156]", "[-0.9398, 0.7838, 0.156]"),
              HasSubstr("disturbance.json:5: 'descending' has a slope of 1.1 with its gains at 1 Hz"));
  EXPECT_THAT(run_with("\"ascending\": [1, 1, 1, 1, 1]", "\"ascending\": [1, 1, 1, 1]"),
              HasSubstr("expected one length"));
  EXPECT_THAT(run_with("\"rate\": {",
                       "\"amplitude\": {\"alpha\": [0.5, 0.25, 1], \"ascending\": [0.4, 0.2, 1], "
                       "\"descending\": [0.4, 0.2, 1]}, \"rate\": {"),
              HasSubstr("out of order, expected rising numbers"));
}

TEST(MainExample, PartsOfItsModelDoWhatWasKept) {
  Provenance from;
  const chain::Chain model = chain::read_model(main_example().folder / "model.toml", from);
  std::string all;
  for (const chain::Block& block : model.blocks) {
    if (!block.parts) continue;
    for (const chain::PartChange& part : *block.parts) {
      all += fmt::format("{} within {:.4g} {}:", part.part, part.tolerance, part.unit);
      // Bends of the size of rounding are none.
      for (const auto& one : part.entries)
        all += fmt::format(" {} {:.4g} {:.4g}", one.parameter, one.slope,
                           std::round(1e6 * one.bend) * 1e-6 + 0.0);
      all += "\n";
    }
  }
  expect_kept("cli/commands/kept_example_parts.txt", all);
}

TEST(MainExample, TracksBestAndSaysSoFirst) {
  const auto& [result, out] = main_example();
  EXPECT_THAT(result.out.substr(0, 300), HasSubstr("as built: "));
  // Short enough for a terminal; the tables are a file.
  std::istringstream console(result.out);
  int lines = 0;
  for (std::string line; std::getline(console, line); ++lines) EXPECT_LE(line.size(), 100u) << line;
  EXPECT_LE(lines, 20);
  EXPECT_THAT(result.out, HasSubstr("out/report.html"));
  EXPECT_THAT(read_file(out / "summary.txt"), HasSubstr("two passes, gain by the known frequency"));
  const Node run = parse_json(read_file(out / "run.json"), "run.json");
  const Csv table = Csv::parse(read_file(out / "tracking.csv"), "tracking.csv");
  const std::string built = run.at("tracking").at("as_built").string();
  const bool ngspice = run_shell("command -v ngspice").status == 0;
  EXPECT_EQ(built, ngspice ? "controller_circuit" : "controller_cvode");
  for (size_t i = 0; i < table.rows(); ++i) {
    EXPECT_LT(table.column(built + "_without_lag_percent")[i], ngspice ? 0.10 : 0.35);
    if (ngspice) {
      EXPECT_LT(table.column(built + "_percent")[i], table.column("polynomial_percent")[i]);
    }
  }
  EXPECT_TRUE(fs::is_regular_file(out / "controller/controller.sub"));
  EXPECT_TRUE(fs::is_regular_file(out / "tracking_stages.csv"));
  // The board in its loop: charge conservation harmonic by harmonic, and ngspice with every switch and image.
  const Node board = run.at("tracking").at("engines")[2];
  EXPECT_THAT(board.at("what").string(), HasSubstr("FPAA with holds"));
  if (ngspice) {
    EXPECT_NEAR(board.at("ngspice_percent").number(), board.at("closed_form_percent").number(), 0.01);
    EXPECT_LT(board.at("agreement_percent").number(), 0.01);
  }
  // The whole controller on the board: at the highest frequency ngspice has every switch of its loop, too.
  const Node on_board = run.at("tracking").at("engines")[3];
  EXPECT_THAT(on_board.at("what").string(), HasSubstr("FPAA controller (outside, loop)"));
  if (ngspice) {
    EXPECT_NEAR(on_board.at("ngspice_percent").number(), on_board.at("closed_form_percent").number(), 0.003);
    EXPECT_LT(on_board.at("agreement_percent").number(), 0.01);
    EXPECT_THAT(on_board.at("missing").string(), HasSubstr("ngspice ran at 100 Hz"));
  } else {
    EXPECT_THAT(on_board.at("missing").string(), HasSubstr("ngspice is not installed"));
  }
}

TEST(Run, BadProjectsAreOneLineAndLeaveNothing) {
  const TemporaryFolder folder;
  fs::copy(fs::path(kProject).parent_path(), folder / "p", fs::copy_options::recursive);
  const std::string good = read_file(folder / "p/seed.toml");
  const auto run_with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    write_file(folder / "p/seed.toml", text.replace(at, from.size(), to));
    const ProgramResult result =
        run_bodesmith("run " + (folder / "p/seed.toml").string() + " -o " + (folder / "out").string());
    EXPECT_EQ(result.status, 2) << to;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(folder / "out")) << to;
    return result.err;
  };
  EXPECT_THAT(run_with("gains.csv", "nowhere.csv"), HasSubstr("seed.toml:11: 'target.points' names"));
  EXPECT_THAT(run_with("\"triangle\"", "\"square\""), HasSubstr("expected one of: triangle, sine, two_tone"));
  EXPECT_THAT(run_with("frequency_hz = [1, 10, 20", "amplitude = [1.0, 1.5]\nfrequency_hz = [1, 10, 20"),
              HasSubstr("'track.amplitude[1]' is 1.5, beyond the full stroke"));
  EXPECT_THAT(run_with("stroke_m = 6.92e-6", "stroke_m = 6.92e-6\ndrive_range = [0.0, 0.9]"),
              HasSubstr("the amplifier (plant.drive_range) makes 0 to 0.9"));
  EXPECT_THAT(run_with("[0.98, 0.82,", "[0.98,"),
              HasSubstr("expected one for each of the 7 tracked frequencies"));
  EXPECT_THAT(run_with("stroke_m = 6.92e-6", "stroke_m = -1"), HasSubstr("'plant.stroke_m' is -1"));
  EXPECT_THAT(run_with("stroke_m = 6.92e-6", "strok_m = 6.92e-6"), HasSubstr("is not known here"));
  EXPECT_THAT(run_with("method = \"minimax\"", "method = \"magic\""), HasSubstr("magic"));
  EXPECT_THAT(run_with("board = \"an231k04-quad4\"", "board = \"breadboard\""), HasSubstr("breadboard"));
  EXPECT_THAT(run_with("resistors = \"E96\"", "resistors = \"E97\""), HasSubstr("E97"));
  EXPECT_THAT(run_with("[fit]", "[fit"), HasSubstr("not valid TOML"));
}

}  // namespace
}  // namespace bodesmith
