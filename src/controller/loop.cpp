#include "controller/loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "controller/library.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/loop_margins.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith::controller {
namespace {

using Branch = Disturbance::Branch;

constexpr int kDrives = 200;
constexpr Band kLoopBand{Hertz{100.0}, Hertz{1e8}};
constexpr int kPointsOfLoop = 241;  // 40 a decade

double derivative(const Disturbance& disturbance, Branch which, double v) {
  const std::array<double, 3>& a = disturbance.coefficients(which);
  return a[0] + v * (2.0 * a[1] + v * 3.0 * a[2]);
}

/// Steepest place of a branch: the greatest K d' (sign +1) or the least (-1), over drives and rates.
LoopPoint steepest(const AnalogController& controller, Branch which, double sign) {
  std::vector<Hertz> rates = controller.disturbance.rate.frequency;
  if (rates.empty()) rates.push_back(Hertz{1.0});
  LoopPoint out;
  out.which = which;
  double best = -std::numeric_limits<double>::infinity();
  for (const Hertz f : rates) {
    for (int i = 0; i <= kDrives; ++i) {
      const double v = controller.loop.greatest_drive * i / kDrives;
      const double slope = controller.rated_gain(which, f) * derivative(controller.disturbance, which, v);
      if (sign * slope > best) {
        best = sign * slope;
        out.slope = slope;
        out.drive_v = v;
        out.rate = f;
      }
    }
  }
  return out;
}

/// Fills the figures from L over the grid.
void judge(const std::vector<Hertz>& grid, const std::vector<std::complex<double>>& loop, LoopPoint& out) {
  const LoopMargins margins = loop_margins(grid, loop);
  if (const auto* least = margins.least_phase_margin())
    out.phase_margin_deg = std::abs(least->phase_margin_deg);
  out.gain_margin_db = margins.gain_margin_db();
  out.nearest = 1.0 / margins.max_sensitivity;
  const double rest = std::abs(loop.front());
  out.bandwidth = grid.back();
  for (std::size_t i = grid.size(); i-- > 0;) {
    const double size = std::abs(loop[i]);
    if (size >= out.greatest_gain) {
      out.greatest_gain = size;
      out.greatest_at = grid[i];
    }
    if (size < rest / std::numbers::sqrt2) out.bandwidth = grid[i];
  }
}

}  // namespace

std::string loop_library(const AnalogController& controller, const LoopPoint& point) {
  const double k = controller.rated_gain(point.which, point.rate);
  const double r = point.drive_v + k * controller.disturbance.value(point.which, point.drive_v);
  const double slope = controller.slope ? -controller.slope->volts_per_hz * point.rate.value : 0.0;
  return controller_library(controller, "controller, its loop cut", {nullptr, true}) +
         fmt::format(
             "\n.subckt loop in out\nVbias x in {:.12g}\nVr r 0 {:.12g}\nVbranch branch 0 {}\n"
             "Vslope slope 0 {:.12g}\nXopen r x branch slope out controller_open\n.ends loop\n",
             point.drive_v, r, point.which == Branch::ascending ? 1 : 0, slope);
}

std::vector<LoopPoint> measure_loop(const AnalogController& controller) {
  std::vector<LoopPoint> out;
  if (controller.form != Form::self_fed) return out;
  const std::vector<Hertz> grid = log_grid(kLoopBand, kPointsOfLoop);
  for (const Branch which : {Branch::ascending, Branch::descending}) {
    for (const double sign : {1.0, -1.0}) {
      LoopPoint point = steepest(controller, which, sign);
      std::vector<std::complex<double>> loop =
          spice::run_ac_of_text(loop_library(controller, point), "controller.sub", grid, "loop");
      for (std::complex<double>& one : loop) one = -one;
      judge(grid, loop, point);
      out.push_back(point);
    }
  }
  return out;
}

}  // namespace bodesmith::controller
