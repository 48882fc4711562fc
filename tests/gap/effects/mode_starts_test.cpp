// Where a mode is looked for that a response lacks: the least squares of each place and damping have a closed form.
#include "gap/effects/mode_starts.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "chain/registry.hpp"
#include "gap/made_response.hpp"
#include "gap/study.hpp"

namespace mode_starts_of {
namespace {

using namespace bodesmith;
using made::Complex;
using made::mode;

/// Lines 2 % apart from 20 Hz to 1 kHz.
gap::Scene scene_of(const std::function<Complex(double)>& over_model) {
  gap::Scene out;
  out.frequency_only = true;
  for (double hz = 20.0; hz < 1000.0; hz *= 1.02) {
    out.frequency.push_back(Hertz{hz});
    out.measured_over_model.push_back(over_model(hz));
  }
  return out;
}

TEST(ModeStarts, TheFirstIsTheModeThatIsMissing) {
  const auto modes = chain::make_block("parallel_modes");
  for (const double gain : {0.2, -0.05}) {
    for (const double scale : {1.0, 40.0}) {
      const auto scene = scene_of([&](double hz) { return scale * (1.0 + gain * mode(hz, 200.0, 0.03)); });
      const gap::Starts starts = gap::mode_starts(scene, modes);
      ASSERT_FALSE(starts.empty());
      EXPECT_NEAR(starts[0][0], 200.0, 2.0) << gain;
      EXPECT_EQ(starts[0][1], 0.03) << gain;
      EXPECT_NEAR(starts[0][2], gain, 0.1 * std::abs(gain));
      for (std::size_t i = 0; i < starts.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
          EXPECT_TRUE(starts[i][2] * starts[k][2] < 0.0 || std::abs(std::log(starts[i][0] / starts[k][0])) >=
                                                               std::max(starts[i][1], starts[k][1]));
        }
      }
    }
  }
}

// Lines of no weight tell nothing: a second mode among them is not looked for.
TEST(ModeStarts, GoByTheWeights) {
  auto scene =
      scene_of([](double hz) { return 1.0 + 0.1 * mode(hz, 100.0, 0.03) + 0.3 * mode(hz, 600.0, 0.01); });
  for (const Hertz f : scene.frequency) scene.weights.push_back(f.value > 400.0 ? 1e-6 : 1.0);
  const gap::Starts starts = gap::mode_starts(scene, chain::make_block("parallel_modes"));
  ASSERT_FALSE(starts.empty());
  EXPECT_NEAR(starts[0][0], 100.0, 2.0);
}

// Responses are told apart by what they hold, not by the order in which they are named.
TEST(Study, ResponsesStandInTheOrderOfWhatTheyHold) {
  const auto response = [](double corner) {
    return made::measured([corner](double hz) { return made::lag(hz, corner); }, 1.0, 100.0, 30,
                          [](double) { return 0.0; }, 1);
  };
  const auto base = model_of("[[block]]\ntype = \"gain\"\ngain = 1.0\noffset = 0.0\nfree = [\"gain\"]\n");
  const auto first_of = [&](std::vector<gap::MeasuredResponse> train) {
    const gap::Study study = gap::Study::of(std::move(train), {response(7.0)}, base);
    std::vector<double> out;
    for (const auto& one : study.train())
      out.push_back(std::get<gap::FrequencyExperiment>(one).record().response[5].real());
    return out;
  };
  const std::vector<double> one = first_of({response(30.0), response(3.0), response(10.0)});
  EXPECT_EQ(first_of({response(10.0), response(30.0), response(3.0)}), one);
  EXPECT_TRUE(std::is_sorted(one.begin(), one.end()));
}

}  // namespace
}  // namespace mode_starts_of
