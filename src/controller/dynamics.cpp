#include "controller/dynamics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "multiplier_layout/slope_detector.hpp"
#include "schematic/analysis/in_time.hpp"

namespace bodesmith::controller {

using tracking::Reference;

namespace {

schematic::InTime::Input repeating(const Reference& reference, double repeat_s) {
  return [&reference, repeat_s](double t) {
    const double theta = t / repeat_s;
    return reference.value(theta - std::floor(theta));
  };
}

}  // namespace

SteadyState run_in_cvode(const AnalogController& controller, const Reference& reference, Hertz operating,
                         std::size_t samples, const std::vector<double>& at_s) {
  const Stopwatch watch;
  const double repeat = static_cast<double>(reference.periods()) / operating.value;
  const int settling = repeats_to_settle(controller, repeat);
  const double begin = settling * repeat;
  SteadyState out{reference, operating, repeat / static_cast<double>(samples), {}, {}, {}, at_s, {}, 0.0};
  const schematic::InTime::Input input = repeating(reference, repeat);
  schematic::InTime run(controller, input, {.input = "r"});
  run.begin(0.0);
  const auto take = [&](double from, double to) {
    const auto within = [&](double t) { return t <= to && t >= from; };
    while (out.v.size() < samples) {
      const double t = begin + static_cast<double>(out.v.size()) * out.step_s;
      if (!within(t)) break;
      out.r.push_back(input(t));
      out.v.push_back(run.volts("v", t));
    }
    while (out.own_v.size() < at_s.size() && within(begin + at_s[out.own_v.size()]))
      out.own_v.push_back(run.volts("v", begin + at_s[out.own_v.size()]));
  };
  std::vector<double> ends = reference.turns();
  ends.erase(ends.begin());
  ends.push_back(1.0);
  for (int k = 0; k <= settling; ++k) {
    for (const double theta : ends) run.run_to((k + theta) * repeat, take);
  }
  // Rounding at the very end.
  for (; out.v.size() < samples; out.v.push_back(out.v.back())) out.r.push_back(out.r.back());
  out.own_v.resize(at_s.size(), out.v.back());
  out.wall_s = watch.seconds();
  return out;
}

double switch_delay_s(const AnalogController& controller, const Reference& reference, Hertz operating) {
  const multiplier_layout::SlopeDetector detector(
      schematic::subset(
          controller, [&](std::size_t group) { return controller.purpose_of(group) == Purpose::slope_sign; }),
      "r");
  const double repeat = static_cast<double>(reference.periods()) / operating.value;
  const double turn = reference.turns().back(), next = reference.turns()[1];
  const std::optional<double> delay =
      detector.delay_s(repeating(reference, repeat), turn * repeat, repeat, (1.0 + next) * repeat);
  if (!delay) {
    throw InputError(fmt::format("a {} of {} Hz is too slow for the slope detector",
                                 to_string(reference.shape()), rounded_text(operating.value)));
  }
  return *delay + controller.analog_switch.on_delay_s;
}

}  // namespace bodesmith::controller
