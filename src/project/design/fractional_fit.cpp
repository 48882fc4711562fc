#include "project/design/fractional_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "lti/bulk_response.hpp"
#include "lti/judge_responses.hpp"

namespace bodesmith::project {
namespace {

/// The exact response as complex Bode points, 40 a decade.
BodePoints sampled_points(const FractionalTransfer& transfer, const std::string& file, const Band& band) {
  BodePoints out;
  out.file = file;
  const int count = whole_number(40.0 * std::log10(band.to.value / band.from.value), 20, 40 * 700);
  for (const Hertz f : log_grid(band, count)) {
    const auto g = transfer.response(f.rad_s());
    out.points.push_back({f, std::abs(g), to_degrees(std::arg(g)), 1.0, 0});
  }
  return out;
}

FractionalStability checked_stability(const FractionalTransfer& transfer, const std::string& file) {
  FractionalStability out = fractional_stability(transfer.denominator);
  if (!out.stable()) {
    throw DesignError(
        file, 0,
        fmt::format("is unstable ({} poles in the right half plane), expected a stable transfer function",
                    out.unstable_poles));
  }
  if (fractional_stability(transfer.numerator).unstable_poles > 0) {
    throw DesignError(file, 0,
                      "has zeros in the right half plane, expected a minimum-phase transfer function");
  }
  return out;
}

/// Poles at 0 that stand for an integrator of this power: 1 for s^-0.9, 2 for s^-1.6.
int whole_integrators(double power) {
  return power > 0.0 ? std::max(1, nearest_whole<int>(power)) : 0;
}

/// The points without the integrators: times (j w)^n.
BodePoints without_integrators(BodePoints points, int integrators) {
  for (BodePoint& point : points.points) {
    point.gain *= std::pow(point.frequency.rad_s().value, integrators);
    point.phase_deg = *point.phase_deg + 90.0 * integrators;
  }
  return points;
}

void add_integrators(Sections& sections, int integrators) {
  for (int i = 0; i < integrators; ++i) {
    Section one;
    one.poles = {{0.0, 0.0}};
    sections.sections.insert(sections.sections.begin(), one);
  }
}

/// Over the band, not at the points that were fitted.
void state_error(const FractionalTransfer& transfer, Band band, DirectFit& fit) {
  const Responses wanted = at_each([&](RadPerSecond w) { return transfer.response(w); });
  const ResponseDifference off = judge_responses(
      [&](const std::vector<Hertz>& grid) { return responses(fit.sections, grid); }, wanted, band);
  fit.max_db = off.max_magnitude_db;
  fit.max_phase_deg = off.max_phase_deg;
  fit.sections.error = Sections::Error{band, fit.max_db, fit.max_phase_deg, fit.max_db};
}

}  // namespace

Hertz FractionalFit::lowest_pole() const {
  double out = INFINITY;
  for (const Section& section : fit.sections.sections) {
    for (const Complex& pole : section.poles) out = std::min(out, std::abs(pole));
  }
  return RadPerSecond{out}.hz();
}

Json FractionalFit::report_json() const {
  Json out = fit.report_json();
  out.erase("points");
  out["max_phase_deg"] = fit.max_phase_deg;
  Json& said = out["stability"];
  said["stable"] = stability.stable();
  said["unstable_poles"] = stability.unstable_poles;
  if (stability.matignon_count) said["unstable_poles_by_matignon"] = *stability.matignon_count;
  said["common_step"] = stability.common_step;
  said["integrator_power"] = stability.powers_of_s;
  out["poles_at_0"] = poles_at_zero;
  return out;
}

FractionalFit fit_fractional(const FractionalTransfer& transfer, const std::string& file,
                             const FractionalFitOptions& options) {
  FractionalFit out;
  out.stability = checked_stability(transfer, file);
  out.poles_at_zero = options.keep_integrator ? whole_integrators(out.stability.powers_of_s) : 0;
  if (options.keep_integrator && out.poles_at_zero == 0)
    throw DesignError(file, 0, "has no integrator to keep");
  const BodePoints points =
      without_integrators(sampled_points(transfer, file, options.band), out.poles_at_zero);
  DirectFitOptions direct = options.direct;
  direct.use_phase = true;
  if (options.order) direct.order = *options.order;
  out.fit = options.max_error_db && !options.order
                ? fit_directly_within(points, direct, *options.max_error_db,
                                      std::max(1, direct.relative_degree), std::min(12, options.max_order))
                : fit_directly(points, direct);
  add_integrators(out.fit.sections, out.poles_at_zero);
  state_error(transfer, options.band, out.fit);
  return out;
}

}  // namespace bodesmith::project
