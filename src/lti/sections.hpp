#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "base/documents/document.hpp"
#include "base/documents/json_fwd.hpp"
#include "base/provenance.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith {

/// One integer-order section, H(s) = gain * prod(s - z) / prod(s - p), rad/s, one or two poles, no more zeros
/// than poles; complex ones come in conjugate pairs within the section.
struct Section {
  double gain = 1.0;
  std::vector<Complex> zeros;
  std::vector<Complex> poles;

  Complex response(Complex s) const;
  Complex response(RadPerSecond w) const { return response(Complex(0.0, w.value)); }
  /// H(0); infinite for a pole at the origin.
  double dc_gain() const;
  /// H(infinity): `gain` with as many zeros as poles, otherwise 0.
  double high_frequency_gain() const { return zeros.size() == poles.size() ? gain : 0.0; }
  bool is_stable() const;

  /// (s + zero)/(s + pole) form scaled to a wanted DC gain; zero and pole are positive corner frequencies.
  static Section pole_zero(double dc_gain, RadPerSecond zero, RadPerSecond pole);
};

/// H(s) = gain * prod_i H_i(s) * exp(-s delay), with its error against what it approximates. Only a measured response has
/// a delay; whatever is built of poles and zeros leaves it out.
struct Sections {
  double gain = 1.0;
  std::vector<Section> sections;

  struct Error {
    Band band;
    double max_magnitude_db = 0.0;
    std::optional<double> max_phase_deg;  ///< none: the phase was not asked for
    double everywhere_max_magnitude_db = 0.0;
  };
  std::optional<Error> error;
  double delay_s = 0.0;

  Complex response(Complex s) const;
  Complex response(RadPerSecond w) const { return response(Complex(0.0, w.value)); }
  double dc_gain() const;
  int pole_count() const;
  /// Lowest and highest |pole| or |zero| above 0; {0, 0} when there is none.
  Band corner_band() const;

  /// Refuses (with file and line): no or more than two poles, more zeros than poles, complex roots without
  /// their conjugate, poles with Re >= 0, a gain of 0.
  static Sections from_node(const Node& node);
  static Sections read(const std::filesystem::path& path, Provenance& from);
  /// gain, sections and (when present) error and delay_s; without the header.
  Json to_json() const;
};

/// Largest differences between two responses over a grid.
struct ResponseDifference {
  double max_magnitude_db = 0.0;
  double max_phase_deg = 0.0;
  /// Largest |a/b - 1| in percent.
  double max_complex_percent = 0.0;
  Hertz worst;  ///< where max_complex_percent is met
};
ResponseDifference compare_responses(const std::vector<Hertz>& grid, const std::vector<Complex>& got,
                                     const std::vector<Complex>& wanted);

/// A pole at the origin, all others in the left half plane.
bool integrates(const Section& section);
/// Some section has a pole at the origin.
bool integrates(const Sections& sections);

/// Roots as files have them: [[re, im], …], rad/s.
std::vector<Complex> roots_from(const Node& node);
Json roots_json(const std::vector<Complex>& roots);

}  // namespace bodesmith
