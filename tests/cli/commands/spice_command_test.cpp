#include <gtest/gtest.h>

#include "base/documents/document.hpp"
#include "base/files.hpp"
#include "run_program.hpp"
#include "schematic/ngspice/ngspice.hpp"

namespace bodesmith {
namespace {

const char* const kSpiceSections = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":0.918,"zeros_rad_s":[[-48.79,0],[-14.8,0]],"poles_rad_s":[[-47.49,0],[-13.99,0]]},
{"gain":1.885,"zeros_rad_s":[[-107.6,0],[-63.68,0]],"poles_rad_s":[[-126.4,0],[-102.2,0]]},
{"gain":0.318,"zeros_rad_s":[[-380.2,0],[-221.6,0]],"poles_rad_s":[[-214.9,0],[-124.8,0]]},
{"gain":2.628,"zeros_rad_s":[[-400,0],[-365.6,0]],"poles_rad_s":[[-652.1,0],[-589.4,0]]}]})";

TEST(SpiceCommand, WritesItsFilesAndDecksRun) {
  const TemporaryFolder folder;
  write_file(folder / "sections.json", kSpiceSections);
  const std::string out = (folder / "spice").string();
  const ProgramResult run =
      run_bodesmith("spice " + (folder / "sections.json").string() + " --json -o " + out);
  ASSERT_EQ(run.status, 0) << run.err;
  const Node summary = parse_json(run.out, "stdout");
  summary.expect_schema("circuit");
  EXPECT_LT(summary.at("error").at("all").at("max_magnitude_db").number(), 0.02);
  EXPECT_GE(summary.at("timing_s").at("compute").number(), 0.0);
  for (const char* name : {"compensator.sub", "ac.cir", "transient.cir", "parts.csv", "circuit.json"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "spice" / name)) << name;
  }
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  for (const std::string deck : {"ac", "transient", "noise", "monte_carlo_ngspice"}) {
    const ProgramResult spice = run_shell("cd " + out + " && ngspice -n -b " + deck + ".cir");
    EXPECT_EQ(spice.status, 0) << spice.out << spice.err;
    const std::string table = deck.starts_with("monte") ? "monte_carlo.txt" : deck + ".txt";
    EXPECT_TRUE(std::filesystem::exists(folder / "spice" / table)) << spice.out << spice.err;
  }
}

TEST(SpiceCommand, CheckAgreesWithNgspice) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  const TemporaryFolder folder;
  write_file(folder / "sections.json", kSpiceSections);
  const ProgramResult run = run_bodesmith("spice " + (folder / "sections.json").string() +
                                          " --check --json -o " + (folder / "spice").string());
  ASSERT_EQ(run.status, 0) << run.err;
  const Node check = parse_json(run.out, "stdout").at("ngspice");
  EXPECT_LT(check.at("against_program").at("max_complex_percent").number(), 1e-6);
  EXPECT_LT(check.at("against_sections").at("max_magnitude_db").number(), 0.02);
  EXPECT_LT(check.at("transient_percent").number(), 0.05);
  EXPECT_LT(check.at("noise_percent").number(), 1e-3);
}

// What is ordered is what is drawn: in the deck, in the order list, by `yield`.
TEST(SpiceCommand, TolerancesAreThoseOfTheOrder) {
  const TemporaryFolder folder;
  write_file(folder / "sections.json", kSpiceSections);
  const std::string out = (folder / "spice").string();
  ASSERT_EQ(run_bodesmith("spice " + (folder / "sections.json").string() +
                          " --resistor-percent 0.5 --capacitor-percent 2 -o " + out)
                .status,
            0);
  EXPECT_NE(read_file(folder / "spice/monte_carlo_ngspice.cir").find("within 0.5 % (R) and 2 % (C)"),
            std::string::npos);
  EXPECT_NE(read_file(folder / "spice/bom.csv").find(",0.5%,"), std::string::npos);
  const ProgramResult drawn = run_bodesmith("yield " + out + "/circuit.json --samples 50 --json");
  EXPECT_EQ(parse_json(drawn.out, "stdout").at("capacitor_percent").number(), 2.0);
  const ProgramResult refused =
      run_bodesmith("spice " + (folder / "sections.json").string() + " --capacitor-percent 100 -o " + out);
  EXPECT_EQ(refused.status, 2);
}

// 0.5 + 20/s + 0.001 s/(1 + s/1000), and a pole at 500 rad/s behind it.
TEST(SpiceCommand, AControllerIsItsSections) {
  const TemporaryFolder folder;
  write_file(folder / "controller.json",
             R"({"schema":"bodesmith.controller/1","type":"pid","kp":0.5,"ki_per_s":20,"kd_s":0.001,
"derivative_corner_hz":159.15494309189535,
"filter":{"schema":"bodesmith.sections/1","gain":1,"sections":[{"gain":500,"zeros_rad_s":[],"poles_rad_s":[[-500,0]]}]}})");
  // (0.5 + 1) s^2 + (0.5 1000 + 20) s + 20000 over s (s + 1000)
  write_file(folder / "sections.json",
             R"({"schema":"bodesmith.sections/1","gain":1,"sections":[
{"gain":1.5,"zeros_rad_s":[[-44.061870468897894,0],[-302.6047961977688,0]],"poles_rad_s":[[0,0],[-1000,0]]},
{"gain":500,"zeros_rad_s":[],"poles_rad_s":[[-500,0]]}]})");
  for (const char* name : {"controller", "sections"}) {
    const ProgramResult run = run_bodesmith("spice " + (folder / name).string() + ".json --series exact -o " +
                                            (folder / (std::string(name) + "_spice")).string());
    ASSERT_NE(run.status, 2) << run.err;
  }
  const auto parts = [&](const char* name) {
    return parse_json(read_file(folder / name / "circuit.json"), name).at("stages").items();
  };
  const auto made = parts("controller_spice"), wanted = parts("sections_spice");
  ASSERT_EQ(made.size(), wanted.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    const auto a = made[i].at("parts").items(), b = wanted[i].at("parts").items();
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      const char* key = a[k].has("realised_ohm") ? "realised_ohm" : "realised_f";
      EXPECT_NEAR(a[k].at(key).number() / b[k].at(key).number(), 1.0, 1e-6) << a[k].at("part").string();
    }
  }
}

TEST(SpiceCommand, ALimitThatIsMissedIsStatusOne) {
  const TemporaryFolder folder;
  write_file(folder / "sections.json", kSpiceSections);
  const ProgramResult run = run_bodesmith("spice " + (folder / "sections.json").string() +
                                          " --max-error-db 1e-6 -o " + (folder / "spice").string());
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "spice" / "compensator.sub"));
}

TEST(SpiceCommand, BadInputIsOneLineAndWritesNothing) {
  const TemporaryFolder folder;
  write_file(folder / "sections.json", kSpiceSections);
  write_file(
      folder / "broken.json",
      R"({"schema":"bodesmith.sections/1","sections":[{"gain":0,"zeros_rad_s":[],"poles_rad_s":[[-1,0]]}]})");
  const std::string good = (folder / "sections.json").string(), out = (folder / "spice").string();
  for (const std::string& arguments :
       {"spice " + good, "spice " + (folder / "broken.json").string() + " -o " + out,
        "spice " + good + " --series E97 -o " + out, "spice " + good + " --realization nothing -o " + out,
        "spice " + good + " --max-ohm 10 -o " + out, "spice " + good + " --max-f 1e-12 -o " + out,
        "spice " + (folder / "none.json").string() + " -o " + out}) {
    const ProgramResult run = run_bodesmith(arguments);
    EXPECT_EQ(run.status, 2) << arguments << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "spice")) << arguments;
  }
}

TEST(SpiceCommand, StockListIsWhatPartsAreMadeOf) {
  const TemporaryFolder folder;
  write_file(folder / "sections.json", kSpiceSections);
  write_file(folder / "drawer.csv", "resistance_ohm,capacitance_f\n100e3,\n4q7,\n");
  const std::string out = (folder / "spice").string();
  const std::string command = "spice " + (folder / "sections.json").string() + " -o " + out + " --stock ";
  const ProgramResult bad = run_bodesmith(command + (folder / "drawer.csv").string());
  EXPECT_EQ(bad.status, 2);
  EXPECT_NE(bad.err.find("drawer.csv:3: '4q7'"), std::string::npos) << bad.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "spice"));
  write_file(folder / "drawer.toml",
             "schema = \"bodesmith.stock/1\"\n[resistors]\nseries = \"E24\"\n[capacitors]\n"
             "values_f = [1e-9, 2.2e-9, 4.7e-9, 1e-8, 2.2e-8, 4.7e-8, 1e-7, 2.2e-7]\n");
  const ProgramResult good = run_bodesmith(command + (folder / "drawer.toml").string() + " --json");
  ASSERT_EQ(good.status, 0) << good.err;
  const Node error = parse_json(good.out, "stdout").at("error");
  EXPECT_LT(error.at("parts").at("max_magnitude_db").number(), 0.1);
  EXPECT_LT(error.at("parts").at("max_magnitude_db").number(),
            error.at("nearest_rounding").at("max_magnitude_db").number());
  const std::string parts = read_file(folder / "spice" / "parts.csv");
  EXPECT_NE(parts.find(",stock,"), std::string::npos);
  EXPECT_NE(parts.find(",E24,"), std::string::npos);
  EXPECT_EQ(parts.find(",E12,"), std::string::npos);
}

TEST(SpiceCommand, LaddersAgreeWithNgspice) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  const TemporaryFolder folder;
  write_file(folder / "sections.json", kSpiceSections);
  for (const std::string form : {"foster1", "foster2", "cauer1", "cauer2"}) {
    SCOPED_TRACE(form);
    const ProgramResult run =
        run_bodesmith("spice " + (folder / "sections.json").string() + " --realization " + form +
                      " --check --json -o " + (folder / "spice").string());
    ASSERT_EQ(run.status, 0) << run.err;
    const Node summary = parse_json(run.out, "stdout"), check = summary.at("ngspice");
    EXPECT_LT(check.at("against_program").at("max_complex_percent").number(), 1e-6);
    EXPECT_LT(check.at("against_sections").at("max_magnitude_db").number(), 0.2);
    EXPECT_LT(check.at("transient_percent").number(), 0.05);
    EXPECT_LT(check.at("noise_percent").number(), 2e-3);
    EXPECT_LT(summary.at("opamps").number(), 7);
  }
}

/// Four zeros on the axis at one frequency, which a grid's middle falls upon.
TEST(SpiceCommand, BandStopsAreBuilt) {
  const TemporaryFolder folder;
  const std::string sections = (folder / "stop.json").string();
  ASSERT_EQ(run_bodesmith("design bandstop --order 4 --from-hz 45 --to-hz 55 -o " + sections).status, 0);
  const ProgramResult run = run_bodesmith("spice " + sections + " --json -o " + (folder / "spice").string());
  EXPECT_EQ(run.status, 0) << run.out << run.err;
  const Node judged = parse_json(run.out, "stdout").at("judged");
  EXPECT_LT(judged.at("max_magnitude_db").number(), 0.3);
  const ProgramResult words = run_bodesmith("spice " + sections + " -o " + (folder / "spice").string());
  EXPECT_NE(words.out.find("a percent counts as 1 dB"), std::string::npos) << words.out;
}

}  // namespace
}  // namespace bodesmith
