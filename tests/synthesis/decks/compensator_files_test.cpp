#include "synthesis/decks/compensator_files.hpp"

// The reference netlists are what the program writes today, and ngspice runs them.

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "kept_text.hpp"
#include "run_program.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "schematic/writers/spice_library.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/realise.hpp"
#include "synthesis/seed_sections.hpp"

namespace bodesmith::synthesis {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(BODESMITH_SOURCE_DIR) / "netlists/first_seed";

TEST(ReferenceNetlists, PartsAreWhatTheProgramChoosesToday) {
  Provenance from;
  const Sections sections = Sections::read(kFolder / "sections.json", from);
  // Every part and the value it was given are the same; the wanted values may differ by rounding.
  const std::string kept = read_file(kFolder / "parts.csv");
  const Realised made = realise(sections);
  const std::string now = parts_csv(made.circuit);
  const auto cells = [](const std::string& text) {
    std::vector<std::string> out;
    for (const std::string_view line : split(text, '\n')) {
      for (const std::string_view cell : split(line, ',')) out.emplace_back(cell);
    }
    return out;
  };
  const std::vector<std::string> before = cells(kept), after = cells(now);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    double a = 0.0, b = 0.0;
    if (parse_number(before[i], a) && parse_number(after[i], b)) {
      EXPECT_NEAR(a, b, 1e-9 * std::abs(a));
    } else {
      EXPECT_EQ(before[i], after[i]);
    }
  }
  OutputSet files;
  add_compensator_files(made, "compensator from sections.json", files);
  for (const auto& path : files.paths()) {
    if (path != "parts.csv" && std::filesystem::exists(kFolder / path))
      expect_kept("../netlists/first_seed/" + path.string(), *files.content(path));
  }
}

TEST(CompensatorLibrary, CallsEachStageBetweenItsNodes) {
  const Circuit circuit = realise(seed_sections()).circuit;
  const schematic::SpiceLibrary library = compensator_library(circuit, "title");
  ASSERT_EQ(library.subcircuits.size(), circuit.stages.size() + 1);
  const auto& calls = library.subcircuits.back().netlist.instances;
  ASSERT_EQ(calls.size(), circuit.stages.size());
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const std::string number = std::to_string(i + 1);
    EXPECT_EQ(calls[i].name, number);
    EXPECT_EQ(calls[i].of, "compensator_stage" + number);
    EXPECT_EQ(library.subcircuits[i].name, calls[i].of);
    EXPECT_EQ(calls[i].nodes, (std::vector{circuit.stages[i].in, circuit.stages[i].out}));
    EXPECT_EQ(library.subcircuits[i].netlist.parts.size(), circuit.stages[i].part_count);
    for (const Part& part : library.subcircuits[i].netlist.parts)
      EXPECT_TRUE(part.name.ends_with("_" + number));
  }
}

TEST(ReferenceNetlists, CompensatorMeetsTheSectionsInNgspice) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  Provenance from;
  const Sections sections = Sections::read(kFolder / "sections.json", from);
  const auto grid = log_grid({Hertz{1}, Hertz{1000}}, 40);
  std::vector<std::complex<double>> wanted;
  for (const Hertz f : grid) wanted.push_back(sections.response(f.rad_s()));
  EXPECT_LT(compare_responses(grid, ngspice::run_ac_of_sub(kFolder / "compensator.sub", grid), wanted)
                .max_magnitude_db,
            0.02);
}

TEST(ReferenceNetlists, DecksRun) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  const TemporaryFolder folder;
  for (const char* deck : {"ac", "transient", "noise", "monte_carlo_ngspice"}) {
    std::filesystem::copy_file(kFolder / (std::string(deck) + ".cir"), folder / (std::string(deck) + ".cir"));
  }
  std::filesystem::copy_file(kFolder / "compensator.sub", folder / "compensator.sub");
  for (const std::string deck : {"ac", "transient", "noise", "monte_carlo_ngspice"}) {
    const ProgramResult run =
        run_shell("cd " + folder.path().string() + " && ngspice -n -b " + deck + ".cir");
    EXPECT_EQ(run.status, 0) << deck << run.err;
    EXPECT_EQ(run.err.find("rror"), std::string::npos) << deck << run.err;
    EXPECT_TRUE(
        std::filesystem::exists(folder / (deck.starts_with("monte") ? "monte_carlo.txt" : deck + ".txt")))
        << deck;
  }
}

}  // namespace

namespace {

TEST(Compensator, NgspiceAgreesWithTheNetworkAndTheSections) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  const Realised made = realise(seed_sections());
  const CompensatorCheck check = check_compensator(made.circuit, seed_sections());
  EXPECT_LT(check.against_network.max_complex_percent, 1e-8);
  EXPECT_LT(check.against_sections.max_magnitude_db, 0.015);
  EXPECT_LT(check.transient_percent, 0.05);
  EXPECT_LT(check.noise_percent, 1e-3);
  EXPECT_GE(check.band.to.value, 10.0 * 652.1 / (2.0 * 3.14159265358979) * 0.999);
}

TEST(Compensator, BiquadAndIdealOpAmps) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  Sections sections;
  Section peak;
  peak.zeros = {{-40, 90}, {-40, -90}};
  peak.poles = {{-20, 97}, {-20, -97}};
  Section right;
  right.zeros = {{300, 0}};
  right.poles = {{-300, 0}};
  sections.sections = {peak, right};
  RealiseOptions options;
  options.opamp = schematic::OpAmpModel::ideal();
  const Realised made = realise(sections, options);
  const CompensatorCheck check = check_compensator(made.circuit, sections);
  EXPECT_LT(check.against_network.max_complex_percent, 1e-5);
}

/// Beside a notch both say one figure: what is told as a shift in one is in the other.
TEST(Compensator, NgspiceJudgesANotchAsTheProgramDoes) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  Sections sections;
  Section notch;
  notch.zeros = {{-0.2132, 21.25}, {-0.2132, -21.25}};
  notch.poles = {{-3.556, 31.78}, {-3.556, -31.78}};
  Section lag;
  lag.gain = 4431.0;
  lag.poles = {{-4431.0, 0}};
  sections.sections = {notch, lag};
  const Realised made = realise(sections);
  const CompensatorCheck check = check_compensator(made.circuit, sections);
  const double own = made.report.all.max_magnitude_db;
  EXPECT_NEAR(check.against_sections.max_magnitude_db, own, 0.03 * own);
}

TEST(Compensator, LibraryIsPortable) {
  const std::string text =
      schematic::spice_text(compensator_library(realise(seed_sections()).circuit, "seed"));
  EXPECT_EQ(text.find(".control"), std::string::npos);
  EXPECT_EQ(text.find(".ac"), std::string::npos);
  EXPECT_EQ(text.find('^'), std::string::npos);
  EXPECT_EQ(text.find("**"), std::string::npos);
  EXPECT_EQ(text.find("LIMIT("), std::string::npos);
  const auto all = ngspice::list_subcircuits(text, "compensator.sub");
  bool found = false;
  for (const ngspice::Subcircuit& one : all) {
    if (one.name == "compensator") {
      found = true;
      EXPECT_EQ(one.pins, (std::vector<std::string>{"in", "out"}));
    }
  }
  EXPECT_TRUE(found);
}

TEST(Compensator, ToleranceLibraryOnlyChangesTheValues) {
  const Circuit circuit = realise(seed_sections()).circuit;
  const schematic::SpiceLibrary library = compensator_library(circuit, "t");
  const std::string plain = schematic::spice_text(library),
                    spread = schematic::spice_text(
                        library, {.value = [](const schematic::Part&part) {
                          return *dialect_registry().get("ltspice").value_with_tolerance(part);
                        }});
  EXPECT_EQ(std::count(plain.begin(), plain.end(), '\n'), std::count(spread.begin(), spread.end(), '\n'));
  EXPECT_NE(spread.find("{mc("), std::string::npos);
  EXPECT_EQ(ngspice::list_subcircuits(plain, "a").size(), ngspice::list_subcircuits(spread, "b").size());
}

TEST(Compensator, PartsCsvHasTheContractsColumns) {
  const std::string text = parts_csv(realise(seed_sections()).circuit);
  EXPECT_EQ(text.substr(0, text.find('\n')),
            "part,section,series,wanted_ohm,realised_ohm,wanted_f,realised_f");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 41);
}

}  // namespace

}  // namespace bodesmith::synthesis
