// Every plant of a family beside what its parameters say by hand.
#include "tuning/plant_family.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/files.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::tuning {
namespace {

using Complex = std::complex<double>;

/// k (1 + s/wz) exp(-sT)/((1 + s/wp)(1 + 2 zeta s/w0 + (s/w0)^2)).
struct ByHand {
  double k = 3.0, zero_hz = 40.0, pole_hz = 5.0, pair_hz = 20.0, zeta = 0.1, delay_s = 2e-3;

  Complex response(double hz) const {
    const Complex s(0.0, hz);  // everything in Hz: ratios alone count
    return k * (1.0 + s / zero_hz) * std::polar(1.0, -2.0 * std::numbers::pi * hz * delay_s) /
           (1.0 + s / pole_hz) / (1.0 + 2.0 * zeta * s / pair_hz + s * s / (pair_hz * pair_hz));
  }
  std::string sections() const {
    const double wz = 2.0 * std::numbers::pi * zero_hz, wp = wz * pole_hz / zero_hz,
                 w0 = wz * pair_hz / zero_hz;
    return fmt::format(
        R"({{"schema": "bodesmith.sections/1", "gain": 1, "delay_s": {}, "sections": [
        {{"gain": {}, "zeros_rad_s": [[{}, 0]], "poles_rad_s": [[{}, 0]]}},
        {{"gain": {}, "zeros_rad_s": [], "poles_rad_s": [[{}, {}], [{}, {}]]}}],
        "fit": {{"gain_deviation_percent": 4, "delay_deviation_s": 0.0015,
          "poles": [{{"frequency_hz": 5, "frequency_deviation_hz": 0.5}},
            {{"frequency_hz": 20, "frequency_deviation_hz": 1, "damping_ratio": 0.1, "damping_ratio_deviation": 0.02}}],
          "zeros": [{{"frequency_hz": 40, "frequency_deviation_hz": 100}}]}}}})",
        delay_s, k * wp / wz, -wz, -wp, w0 * w0, -zeta * w0, w0 * std::sqrt(1.0 - zeta * zeta), -zeta * w0,
        -w0 * std::sqrt(1.0 - zeta * zeta));
  }
};

TEST(PlantFamily, EachParameterMovesByWhatIsStatedOfIt) {
  const TemporaryFolder folder;
  const ByHand plant;
  write_file(folder / "p.json", plant.sections());
  Provenance from;
  const PlantFamily family = read_plants({(folder / "p.json").string()}, {.sigmas = 2.0}, from);
  std::vector<ByHand> wanted(13, plant);
  std::size_t i = 1;
  for (const double side : {2.0, -2.0}) {
    wanted[i++].k *= std::exp(side * 0.04);
    wanted[i++].delay_s = std::max(0.0, plant.delay_s + side * 1.5e-3);  // down to none
    wanted[i++].pole_hz *= std::exp(side * 0.1);
    wanted[i++].pair_hz *= std::exp(side * 0.05);
    wanted[i++].zeta *= std::exp(side * 0.2);
    wanted[i++].zero_hz *= std::exp(side / 2.0);  // what is not known: by e at most
  }
  ASSERT_EQ(family.members.size(), wanted.size());
  for (i = 0; i < wanted.size(); ++i) {
    for (const double hz : {0.3, 4.0, 18.0, 21.0, 300.0})
      EXPECT_LT(std::abs(family.members[i].response(Hertz{hz}.rad_s()) / wanted[i].response(hz) - 1.0), 1e-9)
          << family.members[i].name << " at " << hz;
  }
  EXPECT_NEAR(family.band->from.value, 5.0, 1e-9);
  EXPECT_NEAR(family.band->to.value, 40.0, 1e-9);
}

TEST(PlantFamily, ABlockWithoutStatesHasNoCorner) {
  const TemporaryFolder folder;
  write_file(folder / "plant.toml",
             "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 0.1\n"
             "[[block]]\ntype = \"lowpass\"\ncorner_hz = 20.0\n");
  Provenance from;
  const PlantFamily family = read_plants({(folder / "plant.toml").string()}, {}, from);
  ASSERT_TRUE(family.band);
  EXPECT_NEAR(family.band->from.value, 20.0, 1e-9);
  EXPECT_NEAR(family.band->to.value, 20.0, 1e-9);
}

TEST(PlantFamily, AGainToleranceAloneIsTwoPlantsMore) {
  const TemporaryFolder folder;
  const std::string text = ByHand().sections();
  write_file(folder / "a.json", text.substr(0, text.find(",\n        \"fit\"")) + "}");
  Provenance from;
  const PlantFamily family = read_plants({(folder / "a.json").string()}, {.gain_percent = 25.0}, from);
  ASSERT_EQ(family.members.size(), 3u);
  for (const auto& [at, gain] : {std::pair{1u, 1.25}, {2u, 0.8}}) {
    const auto ratio =
        family.members[at].response(Hertz{19.0}.rad_s()) / family.members[0].response(Hertz{19.0}.rad_s());
    EXPECT_LT(std::abs(ratio - gain), 1e-12);
  }
}

TEST(PlantFamily, CornersOfGainAndFrequencyAndOtherFiles) {
  const TemporaryFolder folder;
  ByHand plant;
  std::string text = plant.sections();
  write_file(folder / "a.json", text.substr(0, text.find(",\n        \"fit\"")) + "}");
  plant.k = 4.0;
  write_file(folder / "b.json", plant.sections());
  Provenance from;
  const PlantFamily family = read_plants({(folder / "a.json").string(), (folder / "b.json").string()},
                                         {.gain_percent = 25.0, .frequency_percent = 10.0}, from);
  // Both files as they stand (the second without its neighbours), and four corners of each.
  ASSERT_EQ(family.members.size(), 10u);
  EXPECT_EQ(family.members[0].name, "nominal");
  std::size_t at = 2;
  for (const double k : {3.0, 4.0}) {
    for (const double gain : {1.25, 0.8}) {
      for (const double scale : {1.1, 1.0 / 1.1}) {
        ByHand moved;
        moved.k = k * gain;
        moved.zero_hz *= scale;
        moved.pole_hz *= scale;
        moved.pair_hz *= scale;
        moved.delay_s /= scale;
        for (const double hz : {1.0, 19.0, 100.0})
          EXPECT_LT(std::abs(family.members[at].response(Hertz{hz}.rad_s()) / moved.response(hz) - 1.0), 1e-9)
              << family.members[at].name;
        ++at;
      }
    }
  }
}

}  // namespace
}  // namespace bodesmith::tuning
