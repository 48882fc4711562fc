#include "spice/layout_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "spice/emit.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith {
namespace {

double polynomial(const std::vector<double>& a, double x) {
  double out = 0.0;
  for (size_t k = a.size(); k-- > 0;) out = (out + a[k]) * x;
  return out;
}

void check_static(const DisturbanceLayout& layout, const std::string& library, LayoutCheck& out) {
  for (size_t b = 0; b < layout.branches.size(); ++b) {
    const std::string deck = "static\n.options reltol=1e-6\n" + library +
                             fmt::format("Vx x 0 0\nVb branch 0 {}\n", b == 0 ? 1 : 0) +
                             "X1 x branch out disturbance\n";
    const DcSweep sweep = run_dc(deck, "Vx", 0.0, 1.0, 0.01, {"out"}, "disturbance.sub");
    for (size_t i = 0; i < sweep.source_v.size(); ++i) {
      const double x = sweep.source_v[i], v = sweep.v[0][i];
      out.static_percent =
          std::max(out.static_percent, 100.0 * std::abs(v - polynomial(layout.branches[b].wanted, x)));
      out.static_against_program =
          std::max(out.static_against_program, 100.0 * std::abs(v - layout.branches[b].value(x)));
    }
  }
}

LayoutCheck::Dynamic check_triangle(const DisturbanceLayout& layout, const std::string& library, Hertz f) {
  const double period = 1.0 / f.value;
  std::string points = "0 0";
  for (int half = 1; half <= 4; ++half) points += fmt::format(" {:.12g} {}", half * 0.5 * period, half % 2);
  const std::string deck = "triangle\n" + library + "Vx x 0 PWL(" + points +
                           ")\nXs x branch slope_detector\nX1 x branch out disturbance\n";
  const Transient run =
      run_transient(deck, {"x", "branch", "out"}, period / 2000.0, 2.0 * period, "disturbance.sub");
  LayoutCheck::Dynamic out;
  out.frequency = f;
  double sum = 0.0, total = 0.0, late = 0.0;
  for (size_t i = 1; i < run.time_s.size(); ++i) {
    const double now = run.time_s[i], dt = now - run.time_s[i - 1];
    if (now < period) continue;
    const bool rising = std::fmod(now, period) < 0.5 * period;
    if ((run.v[1][i] > 0.5) != rising) late += dt;
    const double error = run.v[2][i] - polynomial(layout.branches[rising ? 0 : 1].wanted, run.v[0][i]);
    sum += dt * error * error;
    total += dt;
  }
  out.rms_percent = 100.0 * std::sqrt(sum / total);
  out.late_share = late / period;
  return out;
}

}  // namespace

LayoutCheck check_layout_with_ngspice(const DisturbanceLayout& layout, const std::vector<Hertz>& triangles) {
  const std::string library = disturbance_library(layout, "check");
  LayoutCheck out;
  check_static(layout, library, out);
  if (layout.branches.size() > 1) {
    for (const Hertz f : triangles) out.dynamic.push_back(check_triangle(layout, library, f));
  }
  return out;
}

}  // namespace bodesmith
