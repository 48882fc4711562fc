// A dialect from outside the library: one class and one line that registers it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/files.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/seed_sections.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::synthesis {
namespace {

class CountingDialect final : public Dialect {
 public:
  std::string_view name() const override { return "counting"; }
  std::vector<Deck> decks(const DeckRequest& request) const override {
    std::string text = "* " + request.title + "\n.include compensator.sub\n";
    for (const schematic::Part& part : request.circuit.parts) text += *value_with_tolerance(part) + "\n";
    return {{"counting.cir", text}, {"counting.lib", "* nothing\n"}};
  }
  std::optional<std::string> value_with_tolerance(const schematic::Part& part) const override {
    return part.name + " within tolerance";
  }
};

TEST(OwnDialect, IsEmittedWithTheOthers) {
  static const CountingDialect dialect;
  dialect_registry().add(dialect);
  EXPECT_THROW(dialect_registry().add(dialect), std::logic_error);
  const Realised made = realise(seed_sections());
  const TemporaryFolder folder;
  OutputSet out(folder / "made");
  add_compensator_files(made, "seed", out);
  out.commit();
  for (const char* file :
       {"compensator.sub", "parts.csv", "ac.cir", "transient.cir", "noise.cir", "monte_carlo_ngspice.cir",
        "ltspice_ac.cir", "ltspice_monte_carlo.cir", "compensator_mc.sub", "xyce_ac.cir", "counting.lib"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "made" / file)) << file;
  }
  const std::string text = read_file(folder / "made" / "counting.cir");
  EXPECT_TRUE(text.starts_with("* seed\n.include compensator.sub\n"));
  EXPECT_EQ(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')),
            made.circuit.parts.size() + 2);
}

TEST(CompensatorFiles, HaveTheFilesOfAKicadProject) {
  OutputSet out;
  RealiseOptions options;
  options.tolerances = {.resistor_percent = 0.25, .capacitor_percent = 2.5};
  add_compensator_files(realise(seed_sections(), options), "seed", out);
  const auto paths = out.paths();
  for (const char* file :
       {"compensator.kicad_pro", "compensator.kicad_sch", "bodesmith.kicad_sym", "sym-lib-table"}) {
    EXPECT_NE(std::find(paths.begin(), paths.end(), std::filesystem::path(file)), paths.end()) << file;
  }
  // What is ordered is what the decks draw.
  const std::string ordered = *out.content("bom.csv");
  EXPECT_THAT(ordered, testing::AllOf(testing::HasSubstr(",0.25%,"), testing::HasSubstr(",2.5%,"),
                                      testing::Not(testing::HasSubstr(",1%,"))));
  EXPECT_THAT(*out.content("monte_carlo_ngspice.cir"), testing::HasSubstr("within 0.25 % (R) and 2.5 % (C)"));
}

}  // namespace
}  // namespace bodesmith::synthesis
