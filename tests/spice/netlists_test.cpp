// The reference netlists are what the program writes today, and ngspice runs them.
#include <gtest/gtest.h>

#include "base/files.hpp"
#include "circuit/response.hpp"
#include "circuit/text.hpp"
#include "run_program.hpp"
#include "spice/emit.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith::spice {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(BODESMITH_SOURCE_DIR) / "netlists/first_seed";

TEST(ReferenceNetlists, PartsAreWhatTheProgramChoosesToday) {
  Provenance from;
  const Sections sections = Sections::read(kFolder / "sections.json", from);
  EXPECT_EQ(read_file(kFolder / "parts.csv"), circuit::parts_csv(circuit::realise(sections).circuit));
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
