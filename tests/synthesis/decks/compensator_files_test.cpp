// The reference netlists are what the program writes today, and ngspice runs them.
#include <gtest/gtest.h>

#include <cmath>

#include "base/files.hpp"
#include "base/text.hpp"
#include "run_program.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/decks/compensator_files.hpp"

namespace bodesmith::spice {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(BODESMITH_SOURCE_DIR) / "netlists/first_seed";

TEST(ReferenceNetlists, PartsAreWhatTheProgramChoosesToday) {
  Provenance from;
  const Sections sections = Sections::read(kFolder / "sections.json", from);
  // Every part and the value it was given are the same; the wanted values may differ by rounding.
  const std::string kept = read_file(kFolder / "parts.csv");
  const std::string now = circuit::parts_csv(circuit::realise(sections).circuit);
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
}

TEST(ReferenceNetlists, CompensatorMeetsTheSectionsInNgspice) {
  if (!ngspice_available()) GTEST_SKIP() << "ngspice is not installed";
  Provenance from;
  const Sections sections = Sections::read(kFolder / "sections.json", from);
  const auto grid = log_grid({Hertz{1}, Hertz{1000}}, 40);
  std::vector<std::complex<double>> wanted;
  for (const Hertz f : grid) wanted.push_back(sections.response(f.rad_s()));
  EXPECT_LT(
      compare_responses(grid, run_ac_of_sub(kFolder / "compensator.sub", grid), wanted).max_magnitude_db,
      0.02);
}

TEST(ReferenceNetlists, DecksRun) {
  if (!ngspice_available()) GTEST_SKIP() << "ngspice is not installed";
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
}  // namespace bodesmith::spice
