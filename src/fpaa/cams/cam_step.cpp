#include "fpaa/cams/cam_step.hpp"

#include <algorithm>

namespace bodesmith::fpaa {
namespace {

/// Everything one place later, the newest in front.
void push_history(std::vector<double>& history, double newest) {
  if (history.empty()) return;
  std::copy_backward(history.begin(), history.end() - 1, history.end());
  history.front() = newest;
}

}  // namespace

LinearStep::LinearStep(const PlacedCam& cam) {
  const double a0 = cam.z.denominator.at(0);
  for (std::size_t input = 1; input <= cam.input_count(); ++input) {
    Tap tap;
    for (const double b : cam.z_from(input).numerator) tap.above.push_back(b / a0);
    tap.history.assign(tap.above.size() - 1, 0.0);
    taps_.push_back(std::move(tap));
  }
  for (std::size_t p = 1; p < cam.z.denominator.size(); ++p) below_.push_back(cam.z.denominator[p] / a0);
  outputs_.assign(below_.size(), 0.0);
}

double LinearStep::at_edge(std::span<const double> inputs) {
  double y = 0.0;
  const std::size_t wired = std::min(taps_.size(), inputs.size());
  for (std::size_t k = 0; k < wired; ++k) {
    Tap& tap = taps_[k];
    y += tap.above[0] * inputs[k];
    for (std::size_t p = 0; p < tap.history.size(); ++p) y += tap.above[p + 1] * tap.history[p];
    push_history(tap.history, inputs[k]);
  }
  for (std::size_t p = 0; p < below_.size(); ++p) y -= below_[p] * outputs_[p];
  push_history(outputs_, y);
  return y;
}

}  // namespace bodesmith::fpaa
