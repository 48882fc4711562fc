#include "tracking/compensator.hpp"

#include <cmath>

#include "tracking/stage.hpp"

namespace bodesmith::tracking {
Complex compensator_response(const Compensator& compensator, RadPerSecond w) {
  struct At {
    RadPerSecond w;
    Complex operator()(const Uncompensated&) const { return 0.0; }
    Complex operator()(const ConstantGain& c) const { return c.gain; }
    Complex operator()(const Sections& c) const { return c.response(w); }
    Complex operator()(const ResponseCompensator& c) const { return c.response(w); }
    Complex operator()(const ScheduledGain&) const { return 0.0; }
    Complex operator()(const SlopeGain&) const { return 0.0; }
    Complex operator()(const FilterAndSchedule& c) const {
      return c.filter.response(w) + (c.schedule.gain.size() == 1 ? c.schedule.gain.front() : 0.0);
    }
  };
  return std::visit(At{w}, compensator);
}

Compensator settled_at(const Compensator& compensator, Hertz frequency) {
  if (const auto* scheduled = std::get_if<ScheduledGain>(&compensator))
    return ConstantGain{gain_at(*scheduled, frequency.value)};
  if (const auto* sum = std::get_if<FilterAndSchedule>(&compensator))
    return FilterAndSchedule{sum->filter, {{frequency}, {gain_at(sum->schedule, frequency.value)}}};
  return compensator;
}

double gain_at(const ScheduledGain& table, double hz) {
  if (!(hz > table.frequency.front().value)) return table.gain.front();
  if (!(hz < table.frequency.back().value)) return table.gain.back();
  std::size_t i = 1;
  while (table.frequency[i].value < hz) ++i;
  const double t = std::log(hz / table.frequency[i - 1].value) /
                   std::log(table.frequency[i].value / table.frequency[i - 1].value);
  return table.gain[i - 1] + t * (table.gain[i] - table.gain[i - 1]);
}

double gain_slope_at(const ScheduledGain& table, double hz) {
  if (!(hz > table.frequency.front().value) || !(hz < table.frequency.back().value)) return 0.0;
  std::size_t i = 1;
  while (table.frequency[i].value < hz) ++i;
  return (table.gain[i] - table.gain[i - 1]) /
         std::log(table.frequency[i].value / table.frequency[i - 1].value) / hz;
}

ScheduledGain rest_of(const Sections& filter, const Disturbance& disturbance, Disturbance::Branch branch) {
  constexpr std::size_t kSamples = 1024;
  std::vector<double> w(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double theta = 2.0 * static_cast<double>(i) / static_cast<double>(kSamples);
    w[i] = disturbance.value(branch, theta < 1.0 ? theta : 2.0 - theta);
  }
  const std::size_t begin = branch == Disturbance::Branch::ascending ? 0 : kSamples / 2;
  ScheduledGain out;
  for (const Hertz f : disturbance.rate.frequency) {
    const std::vector<double> filtered =
        through_path(filter, w, 1.0 / (f.value * static_cast<double>(kSamples)));
    double product = 0.0;
    double square = 0.0;
    for (std::size_t i = begin; i < begin + kSamples / 2; ++i) {
      product += (disturbance.rate_gain(branch, f) * w[i] - filtered[i]) * w[i];
      square += w[i] * w[i];
    }
    out.frequency.push_back(f);
    out.gain.push_back(square > 0.0 ? product / square : 0.0);
  }
  return out;
}

}  // namespace bodesmith::tracking
