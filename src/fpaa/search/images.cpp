#include "fpaa/search/score.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fpaa/network/periodic_network.hpp"
#include "fpaa/plan/clock_features.hpp"
#include "fpaa/plan/error_reference.hpp"
#include "numeric/sinc.hpp"

namespace bodesmith::fpaa {
namespace {

/// int exp(jrt) dt over a span that begins at `from`, over a period.
Complex turning(double rate, double from, double length, double period) {
  return length / period * sinc(0.5 * rate * length) * std::polar(1.0, rate * (from + 0.5 * length));
}

/// (1/T) int y exp(-jmt) dt over both phases of a stage's period.
struct PhaseMeans {
  Complex first = 0.0, second = 0.0;
};

/// The last stage's line at w + `away`; `at` is the point of the response's grid.
Complex line_of(const DesignResponse& response, std::size_t at, double w, double away) {
  const Design& design = response.design();
  const double master_hz = response.table().target().master_hz;
  const auto period_of = [&](const DesignStage& s) { return static_cast<double>(s.divisor) / master_hz; };
  std::vector<PhaseMeans> means(design.stages.size());
  for (std::size_t s = 0; s < means.size(); ++s) {
    const DesignStage& stage = design.stages[s];
    const ClockFactors& clock = response.table().clock(stage.divisor)[at / 2];
    const double period = period_of(stage);
    const double half = 0.5 * period;
    const double line = w + away;
    const Complex hold1 = turning(-line, 0.0, half, period);
    const Complex hold2 = turning(-line, half, half, period);
    // The value at a phase's end, held through the phase.
    const auto held1 = [&](const Parts& v) {
      return product(product(v.end1.at(at % 2), std::conj(clock.half.at(at % 2))), hold1);
    };
    const auto held2 = [&](const Parts& v) {
      return product(product(v.end2.at(at % 2), std::conj(clock.period.at(at % 2))), hold2);
    };
    means[s] = {held1(response.signal(s, at / 2)), held2(response.signal(s, at / 2))};
    for (std::size_t i = 0; i < stage.from.size(); ++i) {
      const StageFactors& f = response.factors(s, i, at / 2);
      const Parts x = response.input_of(s, i, at / 2);
      PhaseMeans in;
      if (stage.from[i] == DesignStage::kBoardInput) {
        in = {turning(-away, 0.0, half, period), turning(-away, half, half, period)};
      } else {
        const auto source = static_cast<std::size_t>(stage.from[i]);
        const double own = period_of(design.stages[source]);
        in = means[source];
        if (own < period) {
          const double turns = std::round(half / own);
          const double turn = std::remainder(-away * own, 2.0 * std::numbers::pi);
          const Complex sum = size_of_turns(turn, turns) * std::polar(1.0, 0.5 * (turns - 1.0) * turn);
          in.first = product(in.first + in.second, sum) * (own / period);
          in.second = product(in.first, std::polar(1.0, -away * half));
        }
      }
      means[s].first += f.follow1 * (held1(x) - in.first);
      means[s].second += f.follow2 * (held2(x) - in.second);
    }
  }
  return means.back().first + means.back().second;
}

}  // namespace

double image_share(const Design& design, const DesignTarget& target) {
  constexpr double kMostSines = 400.0;
  std::vector<double> clocks;
  for (const DesignStage& stage : design.stages) {
    const double clock = target.master_hz / static_cast<double>(stage.divisor);
    if (clock < 2.0 * target.band.to.value && std::ranges::find(clocks, clock) == clocks.end())
      clocks.push_back(clock);
  }
  if (clocks.empty()) return 0.0;
  DesignTarget sines;
  sines.band = target.band;
  sines.master_hz = target.master_hz;
  const std::vector<BandSine> band_sines = image_sines(clocks, target.band, kMostSines);
  for (const BandSine& sine : band_sines) sines.grid.push_back(sine.frequency.rad_s());
  const StageFactorTable table(sines);
  const DesignResponse response(design, table);
  double sum = 0.0;
  for (std::size_t k = 0; k < sines.grid.size(); ++k) {
    const double f = sines.grid[k].hz().value;
    double squares = 0.0;
    for (const double line : clock_lines_hz(clocks, band_sines[k].clock, f, target.band)) {
      const double away = 2.0 * std::numbers::pi * (line - f);
      squares += std::norm(line_of(response, k, sines.grid[k].value, away));
    }
    sum += squares * (band_sines[k].share / std::pow(error_reference(target.sections, sines.grid[k]), 2));
  }
  return std::sqrt(sum);
}

}  // namespace bodesmith::fpaa
