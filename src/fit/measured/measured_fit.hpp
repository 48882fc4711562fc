#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "fit/measured/factored_response.hpp"
#include "lti/sections.hpp"
#include "signal/bode_points.hpp"

namespace bodesmith {

struct MeasuredFitOptions {
  std::optional<int> order;  ///< poles; absent: chosen by held-out points
  int max_order = 16;        ///< of the choice
  bool delay = true;         ///< look for a pure delay
};

/// A measured complex response as
///   H(s) = e^(-s delay) gain prod (s - zero)/prod (s - pole),
/// poles stable, zeros in either half plane: relaxed vector fitting from several starts, then maximum likelihood with the
/// noise that the points themselves show.
struct MeasuredFit {
  /// A pole or zero (single: frequency is its distance from 0, negative for a root in the right half plane).
  struct Root {
    bool pair = false;
    Hertz frequency;
    Hertz frequency_deviation;
    double damping = 1.0;
    double damping_deviation = 0.0;
  };
  /// An order that was tried.
  struct Order {
    int order = 0;
    double held_out = 0.0;      ///< mean of |error/noise|^2 over the held-out points: 1 is the noise
    double against_best = 0.0;  ///< its excess over the best order's, in standard errors of the difference
  };

  Sections sections;  ///< the delay in it
  int order = 0;
  double delay_s = 0.0;
  double delay_deviation_s = 0.0;
  double gain_deviation_percent = 0.0;
  std::vector<Root> poles;
  std::vector<Root> zeros;
  std::vector<Order> orders;   ///< rising; one in five points was left out of these fits
  double rms_noise = 0.0;      ///< root mean square of |error/noise|
  double noise_percent = 0.0;  ///< median noise relative to the magnitude
  double rms_db = 0.0;
  double max_db = 0.0;
  double rms_percent = 0.0;  ///< of |error/measured|
  bool converged = false;
  std::vector<std::string> warnings;

  Json report_json() const;
};

/// Throws InputError for fewer than 8 points, values of 0 everywhere, or an order that the points cannot determine.
MeasuredFit fit_measured(const FrequencyRecord& record, const MeasuredFitOptions& options);

}  // namespace bodesmith
