// Of the starts of a proposal the first is the one that promises most, and the second the one that leaves least of the others.
#include "gap/search/shortlist.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "gap/effect.hpp"
#include "gap/made_model.hpp"
#include "gap/made_record.hpp"
#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "signal/statistics.hpp"

namespace best_starts {
namespace {

using namespace bodesmith;

TEST(BestStarts, HaveTheOneThatLeavesLeastInSecondPlace) {
  const auto base = model_of("[[block]]\ntype = \"gain\"\ngain = 1.0\n");
  const std::string truth =
      "[[block]]\ntype = \"resonator\"\nnatural_frequency_hz = 70.0\ndamping_ratio = 0.25\n"
      "[[block]]\ntype = \"dead_zone\"\nwidth = 0.4\n";
  const gap::Experiments records = {
      gap::TimeExperiment(measured(truth, two_sines(700, 1.0, 11.0), 1e-3, 1e-3, 1))};
  const gap::Model model(base);
  const auto scene = gap::make_scene(model, records);
  std::vector<gap::Proposal> proposals;
  for (const char* name : {"resonance", "amplifier_pole", "slew_limit"})
    gap::effect_registry().get(name).propose(scene, proposals);
  for (const auto& promising : gap::shortlist(model, proposals, records)) {
    const auto left = [&](std::size_t start) {
      const auto& values = promising.proposal.starts[start];
      gap::Model at_start = promising.proposal.model;
      at_start.set_values(values);
      return gap::rms_of(at_start, records);
    };
    std::vector<double> others;
    for (std::size_t k = 1; k < promising.best_starts.size(); ++k)
      others.push_back(left(promising.best_starts[k]));
    EXPECT_EQ(others.front(), *std::min_element(others.begin(), others.end()));
  }
}

}  // namespace
}  // namespace best_starts
