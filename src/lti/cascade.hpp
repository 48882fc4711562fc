#pragma once

#include <complex>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/document.hpp"
#include "base/json_fwd.hpp"
#include "base/provenance.hpp"
#include "lti/fractional_lead_lag.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith {

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

  std::complex<double> response(RadPerSecond w) const;
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
