#include "part_errors/loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/text.hpp"
#include "lti/frequency_grid.hpp"
#include "part_errors/loop_network.hpp"
#include "part_errors/margin.hpp"

namespace bodesmith::part_errors {
namespace {

using controller::AnalogController;

/// v = 0, 1/4 … 1; both branches; the gain curve's corners, where the gains' extremes are.
std::vector<LoopPoint> loop_points(const AnalogController& c) {
  std::vector<Hertz> operating = {c.tracked.empty() ? Hertz{1.0} : c.tracked.front()};
  if (c.curve) operating = c.curve->corner;
  std::vector<LoopPoint> out;
  for (const auto branch : {Disturbance::Branch::ascending, Disturbance::Branch::descending}) {
    std::vector<double> seen;
    for (const Hertz f : operating) {
      const double gain = c.curve ? c.curve->value(branch, f) : 1.0;
      const bool known =
          std::any_of(seen.begin(), seen.end(), [&](double one) { return std::abs(one - gain) < 1e-6; });
      if (known) continue;
      seen.push_back(gain);
      for (int i = 0; i <= 4; ++i) out.push_back({branch, 0.25 * i, f, gain});
    }
  }
  return out;
}

LoopAt look_at(const AnalogController& controller, const LoopPoint& point, const std::vector<Hertz>& grid) {
  const LoopNetwork network(controller, point);
  LoopAt out;
  out.point = point;
  std::vector<std::complex<double>> loop;
  std::vector<std::vector<std::complex<double>>> own(network.opamps().size());
  for (const Hertz f : grid) {
    loop.push_back(network.generator(f.rad_s()));
    if (std::abs(loop.back()) > out.greatest_gain) {
      out.greatest_gain = std::abs(loop.back());
      out.greatest_at = f;
    }
    const auto ratios = network.return_ratios(f.rad_s());
    for (std::size_t k = 0; k < own.size(); ++k) own[k].push_back(ratios[k]);
  }
  out.gain_margin_db = gain_margin_db(loop);
  for (std::size_t k = 0; k < own.size(); ++k) {
    const controller::OpAmp& u = controller.opamps[network.opamps()[k]];
    const Margin margin = phase_margin(grid, own[k]);
    out.opamps.push_back({u.name, u.role, margin.deg, margin.crossing});
  }
  return out;
}

}  // namespace

/// Every crossing of |T| = 1, straight in the logarithms; unstable when T goes round -1.
Margin phase_margin(const std::vector<Hertz>& grid, const std::vector<std::complex<double>>& t) {
  Margin out;
  double turned = 0.0;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    turned += std::arg((1.0 + t[i + 1]) / (1.0 + t[i]));
    const double a = std::log(std::abs(t[i])), b = std::log(std::abs(t[i + 1]));
    if ((a > 0.0) == (b > 0.0)) continue;
    const double share = a / (a - b);
    const double phase = std::arg(t[i]) + share * std::arg(t[i + 1] / t[i]);
    const double from_minus_one = std::abs(std::remainder(phase - std::numbers::pi, 2.0 * std::numbers::pi));
    const double deg = from_minus_one * 180.0 / std::numbers::pi;
    if (deg >= out.deg) continue;
    out.deg = deg;
    out.crossing = Hertz{grid[i].value * std::pow(grid[i + 1].value / grid[i].value, share)};
  }
  // From a large positive real T to 0, arg(1 + T) comes back to about 0 without an encirclement.
  if (std::abs(turned) > std::numbers::pi) out.deg = -out.deg;
  return out;
}

double gain_margin_db(const std::vector<std::complex<double>>& t) {
  double greatest = 0.0;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    if ((t[i].imag() > 0.0) == (t[i + 1].imag() > 0.0)) continue;
    const double share = t[i].imag() / (t[i].imag() - t[i + 1].imag());
    greatest = std::max(greatest, -(t[i].real() + share * (t[i + 1].real() - t[i].real())));
  }
  // A loop gain that is negative at rest counts from there.
  if (!t.empty()) greatest = std::max(greatest, -t.front().real());
  return greatest > 0.0 ? -20.0 * std::log10(greatest) : 0.0;
}

LoopStability loop_stability(const AnalogController& controller) {
  LoopStability out;
  if (controller.opamp.is_ideal) return out;
  const std::vector<Hertz> grid = log_grid({Hertz{1e2}, Hertz{3e9}}, 120);
  for (const LoopPoint& point : loop_points(controller)) {
    out.at.push_back(look_at(controller, point, grid));
    const LoopAt& at = out.at.back();
    out.greatest_gain = std::max(out.greatest_gain, at.greatest_gain);
    for (const LoopAt::OpAmpMargin& one : at.opamps) {
      if (one.margin_deg >= out.margin_deg) continue;
      out.margin_deg = one.margin_deg;
      out.opamp = one.opamp;
      out.role = one.role;
      out.point = point;
      out.crossing = one.crossing;
    }
  }
  return out;
}

std::string loop_warning(const LoopStability& loop) {
  const double margin = loop.ngspice ? std::min(loop.margin_deg, loop.ngspice->margin_deg) : loop.margin_deg;
  if (margin >= kGoodMarginDeg) return {};
  return fmt::format(
      "{} ({}) has a phase margin of {} degrees at v = {}, {} branch, crossing at {}: expected at least {}; an op-amp "
      "with a lower output resistance or another gain-bandwidth, or a capacitor of some picofarads across its "
      "feedback resistor, changes it",
      loop.opamp, loop.role, rounded_text(margin, 3), rounded_text(loop.point.v, 3),
      loop.point.branch == Disturbance::Branch::ascending ? "ascending" : "descending",
      engineering_text(loop.crossing.value, "Hz"), rounded_text(kGoodMarginDeg));
}

void require_stable(const LoopStability& loop, bool allowed) {
  const double margin = loop.ngspice ? std::min(loop.margin_deg, loop.ngspice->margin_deg) : loop.margin_deg;
  if (allowed || margin >= kLeastMarginDeg) return;
  throw DesignError(loop_warning(loop));
}

}  // namespace bodesmith::part_errors
