#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "base/documents/document.hpp"
#include "base/documents/json_fwd.hpp"
#include "base/provenance.hpp"
#include "base/units.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith {

/// The fractional-order compensator of the disturbance paper, eq. 14:
///   G(s) = ((lambda s + 1) / (x lambda s + 1))^beta,   lambda > 0 (seconds), x > 0, beta real.
/// Corners at 1/lambda (zero of the base for beta > 0) and 1/(x lambda). G(0) = 1, G(infinity) = x^(-beta).
/// With x < 1 and beta > 0 it is a lead: between the corners the magnitude rises by 20 beta dB a decade.
/// The power is the principal one: the base never touches the negative real axis for Re s >= 0.
struct FractionalLeadLag {
  double lambda_s = 1.0;
  double x = 1.0;
  double beta = 0.0;

  Complex response(RadPerSecond w) const;
  /// ln |G(jw)|, without overflow for large |beta|.
  double log_magnitude(RadPerSecond w) const;
  double phase_rad(RadPerSecond w) const;

  RadPerSecond first_corner() const { return {1.0 / lambda_s}; }
  RadPerSecond second_corner() const { return {1.0 / (x * lambda_s)}; }
  RadPerSecond low_corner() const { return x < 1.0 ? first_corner() : second_corner(); }
  RadPerSecond high_corner() const { return x < 1.0 ? second_corner() : first_corner(); }
  /// Ratio of the corners, >= 1.
  double corner_ratio() const { return x < 1.0 ? 1.0 / x : x; }
  /// True when the magnitude rises with frequency (a lead).
  bool rises() const { return (x < 1.0) == (beta > 0.0); }
};

/// G(s) = gain * prod_i ((lambda_i s + 1)/(x_i lambda_i s + 1))^beta_i, disturbance paper eq. 15.
struct Cascade {
  double gain = 1.0;
  std::vector<FractionalLeadLag> terms;

  /// What the fit met; absent when the cascade was written by hand.
  struct FitPoint {
    Hertz frequency;
    double wanted_db = 0.0;
    double got_db = 0.0;
  };
  struct FitSummary {
    std::vector<FitPoint> points;
    double rms_db = 0.0;
    double max_db = 0.0;
    double condition_number = 0.0;  ///< infinite for a singular fit (written as 1e300)
  };
  std::optional<FitSummary> fit;

  Complex response(RadPerSecond w) const;
  double magnitude_db(RadPerSecond w) const;
  /// From the lowest to the highest corner (and fit point); an error for a cascade without terms is the
  /// caller's.
  Band corner_band() const;

  static Cascade from_node(const Node& node);
  static Cascade read(const std::filesystem::path& path, Provenance& from);
  /// gain, terms and (when present) fit; without the header.
  Json to_json() const;
};

}  // namespace bodesmith
