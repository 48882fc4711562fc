#include "gap/report/constant_offset.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/text.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {

std::vector<ConstantOffset> constant_offsets(const GapMeter& meter, const Model& model, const Study& study) {
  constexpr double kMostOfIt = 0.5;
  std::vector<ConstantOffset> out;
  for (std::size_t i = 0; i < study.holdout().size(); ++i) {
    const auto* time = std::get_if<TimeExperiment>(&study.holdout()[i]);
    if (time == nullptr) continue;
    const auto residual = meter.holdout_residual(model, i);
    const double middle = mean(residual), whole = rms(residual);
    const double share = middle * middle / (whole * whole);
    if (!(share >= kMostOfIt)) continue;
    out.push_back({time->file(), middle, share, whole * std::sqrt(std::max(0.0, 1.0 - share))});
  }
  return out;
}

std::string to_text(const ConstantOffset& offset) {
  return fmt::format(
      "A constant offset of {} is {:.0f} % of the gap that is left on {}; without it {} rms would be left, as when the zero "
      "moves between records (drift, creep, another preload), which no term of the model can know.",
      rounded_text(offset.value, 3), 100.0 * offset.share, offset.file, rounded_text(offset.rms_without, 3));
}

}  // namespace bodesmith::gap
