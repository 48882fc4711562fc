#include "identify/compensation.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::identify {
namespace {

/// u with scaling(u) = y.
double inverse(const hysteresis::Scaling& scaling, double y) {
  return (y - scaling.offset) / scaling.gain;
}

}  // namespace

Compensation compensate(const StageModel& stage, const std::vector<double>& reference, double step_s,
                        bool preview) {
  Compensation out;
  if (reference.empty()) return out;
  out.drive.reserve(reference.size());
  const std::vector<double> ahead = preview ? delayed(reference, step_s, -stage.delay_s) : reference;
  if (stage.model.type == nullptr) {
    for (const double y : ahead) out.drive.push_back(inverse(stage.input, inverse(stage.output, y)));
  } else {
    const std::unique_ptr<hysteresis::Inverse> hysteresis = make_inverse(stage.model);
    const auto [low, high] = std::minmax_element(ahead.begin(), ahead.end());
    const double tolerance = 1e-6 * std::max(*high - *low, 1e-300);
    for (const double y : ahead) {
      const double target = inverse(stage.output, y);
      const double u = out.drive.empty() ? hysteresis->reset(target) : hysteresis->step(target, step_s);
      if (std::abs((hysteresis->achieved() - target) * stage.output.gain) > tolerance) ++out.out_of_reach;
      out.drive.push_back(inverse(stage.input, u));
    }
  }
  out.predicted = stage.simulate(out.drive, step_s);
  return out;
}

}  // namespace bodesmith::identify
