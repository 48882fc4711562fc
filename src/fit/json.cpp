#include <fmt/format.h>

#include <cmath>

#include "base/documents/json.hpp"
#include "base/hertz_values.hpp"
#include "base/text.hpp"
#include "fit/cascade/cascade_fit.hpp"
#include "fit/direct/direct_fit.hpp"
#include "fit/measured/measured_fit.hpp"
#include "fit/waveform/waveform_fit.hpp"

namespace bodesmith {
namespace {

/// Null for what the data do not determine.
Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json roots_report(const std::vector<MeasuredFit::Root>& roots) {
  Json out = Json::array();
  for (const MeasuredFit::Root& root : roots) {
    Json one = {{"frequency_hz", root.frequency.value},
                {"frequency_deviation_hz", number_or_null(root.frequency_deviation.value)}};
    if (root.pair) {
      one["damping_ratio"] = root.damping;
      one["damping_ratio_deviation"] = number_or_null(root.damping_deviation);
    }
    out.push_back(one);
  }
  return out;
}

Json error_json(const WaveformError& error) {
  Json points = Json::array();
  for (const WaveformErrorPoint& point : error.points) {
    points.push_back({{"frequency_hz", point.frequency.value},
                      {"rms_percent", point.rms_percent},
                      {"peak_percent", point.peak_percent}});
  }
  return {{"rms_percent", error.rms_percent}, {"worst_percent", error.worst_percent}, {"points", points}};
}

}  // namespace

Json CascadeFit::to_json() const {
  Json out = cascade.to_json();
  Json& fit = out["fit"];
  fit["kind"] = bounded ? "bounded" : least_squares ? "least squares" : "interpolation";
  if (fewest_bands) fit["limit_met"] = limit_met;
  if (bounded) {
    fit["beta_bounds"] = {lower_bound, upper_bound};
    fit["optimality_residual"] = optimality_residual;
  }
  fit["base"] = {{"frequency_hz", base.value}, {"got_relative_db", base_got_db}};
  fit["terms"] = Json::array();
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const CascadeFitTerm& term = terms[i];
    fit["terms"].push_back({{"from_hz", term.band.from.value},
                            {"to_hz", term.band.to.value},
                            {"beta", term.beta},
                            {"orientation", term.beta == 0.0 ? "flat"
                                            : term.rises     ? "lead"
                                                             : "lag"},
                            {"slope_db", 20.0 * term.beta},
                            {"at_bound", term.at_bound},
                            {"beta_change_per_gain_percent", sensitivity[i]},
                            {"max_beta_change_per_gain_percent", term.max_sensitivity}});
    if (term.beta_max) fit["terms"].back()["beta_max"] = *term.beta_max;
  }
  fit["left_out"] = Json::array();
  for (const LeftOutPoint& l : left_out) {
    fit["left_out"].push_back({{"frequency_hz", l.frequency.value},
                               {"miss_db", l.error_db},
                               {"max_change_db", l.max_change_db},
                               {"max_change_hz", l.max_change_at.value}});
  }
  fit["excursions"] = Json::array();
  for (const Excursion& e : excursions) {
    fit["excursions"].push_back({{"from_hz", e.between.from.value},
                                 {"to_hz", e.between.to.value},
                                 {"worst_hz", e.worst.value},
                                 {"outside_db", e.outside_db}});
  }
  fit["points_below_base_hz"] = hertz_values(points_below_base);
  fit["warnings"] = warnings;
  return out;
}

Json DirectFit::report_json() const {
  Json out;
  out["points"] = Json::array();
  for (const DirectFitPoint& point : points) {
    out["points"].push_back(
        {{"frequency_hz", point.frequency.value}, {"wanted_db", point.wanted_db}, {"got_db", point.got_db}});
  }
  out["rms_db"] = rms_db;
  out["max_db"] = max_db;
  out["mask_violation_db"] = mask_violation_db;
  out["highest_gain_above_band_db"] = highest_gain_above_band_db;
  out["parameters"] = parameters;
  out["starts_tried"] = starts_tried;
  out["cancelled_poles"] = cancelled;
  out["distant_zeros"] = distant_zeros;
  out["warnings"] = warnings;
  out["not_tried"] = not_tried;
  return out;
}

Json MeasuredFit::report_json() const {
  Json out = {{"order", order},
              {"rms_db", rms_db},
              {"max_db", max_db},
              {"rms_percent", rms_percent},
              {"noise_percent", noise_percent},
              {"rms_over_noise", rms_noise},
              {"converged", converged},
              {"delay_s", delay_s},
              {"delay_deviation_s", number_or_null(delay_deviation_s)},
              {"gain_deviation_percent", number_or_null(gain_deviation_percent)},
              {"poles", roots_report(poles)},
              {"zeros", roots_report(zeros)},
              {"orders", Json::array()},
              {"warnings", warnings}};
  // What an order too many leaves depends on where its fit, which is ill posed, happens to end: from the fourth digit on another
  // compiler finds another figure, and their scatter is far larger.
  const auto told = [](double value) {
    parse_number(fmt::format("{:.3g}", value), value);
    return value;
  };
  for (const Order& tried : orders) {
    out["orders"].push_back({{"order", tried.order},
                             {"held_out", told(tried.held_out)},
                             {"standard_errors_above_best", told(tried.against_best)}});
  }
  return out;
}

Json WaveformFit::report_json() const {
  Json out = {{"error", error_json(error)},
              {"between", error_json(between)},
              {"between_none", error_json(between_none)},
              {"no_compensation", error_json(none)}};
  if (!magnitude_only.points.empty()) out["magnitude_only"] = error_json(magnitude_only);
  out["constant_gain"] = constant_gain;
  out["constant"] = error_json(constant);
  out["lower_bound_percent"] = lower_bound_percent;
  out["starts_tried"] = starts_tried;
  out["warnings"] = warnings;
  return out;
}

}  // namespace bodesmith
