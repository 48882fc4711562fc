#include "fpaa/cams/sum_diff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

ZTransfer SumDiff::transfer(std::size_t input) const {
  const Input& in = inputs.at(input);
  return {{(in.inverting ? -1.0 : 1.0) * in.units}, {static_cast<double>(cout)}};
}

SumDiff SumDiff::best(const std::vector<double>& gains, int max_capacitor) {
  SumDiff out;
  double scale = 0.0;
  for (const double g : gains) scale = std::max(scale, std::abs(g));
  double min_error = std::numeric_limits<double>::infinity();
  for (int cout = 1; cout <= max_capacitor; ++cout) {
    SumDiff trial;
    trial.cout = cout;
    double error = 0.0;
    for (const double g : gains) {
      const int units = static_cast<int>(
          std::clamp(std::round(std::abs(g) * cout), 1.0, static_cast<double>(max_capacitor)));
      error = std::max(error, std::abs(units / static_cast<double>(cout) - std::abs(g)) / scale);
      trial.inputs.push_back({units, g < 0.0});
    }
    if (error < min_error) {
      min_error = error;
      out = trial;
    }
  }
  return out;
}

namespace {

CamFacts sum_diff_facts() {
  CamFacts f;
  f.name = "SumDiff";
  f.options = {"2 inputs", "3 inputs", "4 inputs"};
  f.parameters = {{"gain_1"}, {"gain_2"}, {"gain_3"}, {"gain_4"}};
  f.resources = Resources{.opamps = 1, .capacitors = 3};
  f.transfer =
      "sum of +-Ci/Cout Vi; inverting inputs without delay, the others z^-1/2; output valid for half a "
      "cycle";
  f.transfer_ground = Ground::seen;
  f.delay_cycles = 0.5;  // of an input that does not invert
  f.half_cycle_output = true;
  f.limits = "one capacitor more for each further input";
  return f;
}

class SumDiffCam : public Cam {
 public:
  SumDiffCam() : Cam(sum_diff_facts()) {}

  /// One capacitor an input and Cout.
  std::optional<Resources> resources(std::size_t inputs) const override {
    Resources out = facts().resources.value();
    out.capacitors = static_cast<int>(inputs) + 1;
    return out;
  }
};

}  // namespace

std::string SumDiffSpec::option() const {
  return fmt::format("{} inputs", gains.size());
}

CamValues SumDiffSpec::values() const {
  CamValues out;
  for (std::size_t i = 0; i < gains.size(); ++i) out.set(fmt::format("gain_{}", i + 1), gains[i]);
  return out;
}

const Cam& sum_diff_cam() {
  static const SumDiffCam cam;
  return cam;
}

}  // namespace bodesmith::fpaa
