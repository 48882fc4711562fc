#include "synthesis/controller/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "base/json.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/loop_margins.hpp"
#include "numeric/parallel_for.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "synthesis/controller/as_built.hpp"
#include "synthesis/controller/library.hpp"

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

double rms_percent(const std::vector<double>& a, const std::vector<double>& b, double range) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return 100.0 * std::sqrt(sum / static_cast<double>(a.size())) / range;
}

/// Over the time between the instants, which lie close where v moves fast.
double rms_in_time_percent(const std::vector<double>& t, const std::vector<double>& a,
                           const std::vector<double>& b, double range) {
  double sum = 0.0, total = 0.0;
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double before = a[i - 1] - b[i - 1], now = a[i] - b[i], dt = t[i] - t[i - 1];
    sum += dt * (before * before + before * now + now * now) / 3.0;
    total += dt;
  }
  return total > 0.0 ? 100.0 * std::sqrt(sum / total) / range : 0.0;
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

std::vector<AsBuilt> measure_as_built(const AnalogController& controller,
                                      const std::vector<Hertz>& frequencies,
                                      const tracking::Reference& reference, const NgspiceRun& options) {
  std::vector<AsBuilt> out;
  for (const Hertz f : frequencies) {
    const SteadyState run = run_in_ngspice(controller, reference, f, options);
    AsBuilt one;
    one.frequency = f;
    one.error = stage_error(controller.disturbance, run);
    SteadyState plain = run;
    plain.v = run.r;
    one.without = stage_error(controller.disturbance, plain);
    one.cvode_difference_percent = rms_in_time_percent(
        run.own_s, run.own_v, run_in_cvode(controller, reference, f, run.v.size(), run.own_s).own_v,
        reference.alpha());
    one.start_up_percent = rms_percent(run.first_v, run.v, reference.alpha());
    one.wall_s = run.wall_s;
    out.push_back(one);
  }
  return out;
}

std::vector<AsBuilt> predict_as_built(const AnalogController& controller,
                                      const tracking::Reference& reference) {
  std::vector<AsBuilt> out(controller.tracked.size());
  parallel_for(out.size(), thread_count(0), [&](std::size_t i) {
    SteadyState run = run_in_cvode(controller, reference, controller.tracked[i]);
    out[i].frequency = controller.tracked[i];
    out[i].error = stage_error(controller.disturbance, run);
    run.v = run.r;
    out[i].without = stage_error(controller.disturbance, run);
  });
  return out;
}

double worst_percent(const std::vector<AsBuilt>& cases) {
  double out = 0.0;
  for (const AsBuilt& one : cases) out = std::max(out, one.error.rms_percent_without_lag);
  return out;
}

Json to_json(const std::vector<AsBuilt>& cases) {
  Json out = Json::array();
  for (const AsBuilt& one : cases) {
    out.push_back({{"frequency_hz", one.frequency.value},
                   {"rms_percent", one.error.rms_percent},
                   {"rms_percent_without_lag", one.error.rms_percent_without_lag},
                   {"max_percent", one.error.max_percent},
                   {"lag_s", one.error.lag_s},
                   {"none_rms_percent", one.without.rms_percent},
                   {"cvode_difference_percent", one.cvode_difference_percent},
                   {"start_up_percent", one.start_up_percent},
                   {"ngspice_s", one.wall_s}});
  }
  return out;
}

Json to_json(const std::vector<LoopPoint>& loop) {
  Json out = Json::array();
  for (const LoopPoint& one : loop) {
    Json json = {{"branch", one.which == Disturbance::Branch::ascending ? "ascending" : "descending"},
                 {"rate_hz", one.rate.value},
                 {"drive", one.drive_v},
                 {"slope", one.slope},
                 {"greatest_gain", one.greatest_gain},
                 {"greatest_at_hz", one.greatest_at.value},
                 {"nearest", one.nearest},
                 {"bandwidth_hz", one.bandwidth.value}};
    if (one.phase_margin_deg) json["phase_margin_deg"] = *one.phase_margin_deg;
    if (one.gain_margin_db) json["gain_margin_db"] = *one.gain_margin_db;
    out.push_back(json);
  }
  return out;
}

}  // namespace bodesmith::controller
