#include "fpaa/cams/sum_diff.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {

ZTransfer SumDiff::transfer(std::size_t input) const {
  const Input& in = inputs.at(input);
  return {{(in.inverting ? -1.0 : 1.0) * in.units}, {static_cast<double>(cout)}};
}

SumDiff SumDiff::best(const std::vector<double>& gains, int largest) {
  SumDiff out;
  double scale = 0.0;
  for (const double g : gains) scale = std::max(scale, std::abs(g));
  double least = std::numeric_limits<double>::infinity();
  for (int cout = 1; cout <= largest; ++cout) {
    SumDiff trial;
    trial.cout = cout;
    double error = 0.0;
    for (const double g : gains) {
      const int units = static_cast<int>(std::clamp(std::round(std::abs(g) * cout), 1.0, double(largest)));
      error = std::max(error, std::abs(units / static_cast<double>(cout) - std::abs(g)) / scale);
      trial.inputs.push_back({units, g < 0.0});
    }
    if (error < least) {
      least = error;
      out = trial;
    }
  }
  return out;
}

const CamType& sum_diff_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "SumDiff";
    t.options = {"2 inputs", "3 inputs", "4 inputs"};
    t.parameters = {"gain_1", "gain_2", "gain_3", "gain_4"};
    t.resources = Resources{.opamps = 1, .capacitors = 3, .comparators = 0, .sars = 0, .lookup_tables = 0};
    t.transfer =
        "sum of +-Ci/Cout Vi; inverting inputs without delay, the others z^-1/2; output valid for half a "
        "cycle";
    t.transfer_ground = Ground::seen;
    t.half_cycle_output = true;
    t.limits = "one capacitor more for each further input";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
