#include <cmath>

#include "base/json.hpp"
#include "fit/measured_fit.hpp"

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

}  // namespace

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
  for (const Order& tried : orders) {
    out["orders"].push_back({{"order", tried.order},
                             {"held_out", tried.held_out},
                             {"standard_errors_above_best", tried.against_best}});
  }
  return out;
}

}  // namespace bodesmith
