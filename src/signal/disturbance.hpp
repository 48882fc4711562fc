#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "base/documents/document.hpp"
#include "base/documents/json_fwd.hpp"
#include "base/provenance.hpp"
#include "base/units.hpp"

namespace bodesmith {

/// The hysteretic disturbance of a piezo stage, disturbance paper eq. 1-13:
///   d(x) = a1 x + a2 x^2 + a3 x^3, x in [0, 1], other coefficients while x rises (ascending) than while it
///   falls.
/// Optional tables: amplitude gains alpha_1(alpha), alpha_2(alpha) (Fig. 3c, d) and rate gains over the
/// operating frequency (Table I), one a branch. Gains are relative to the full-stroke, lowest-frequency
/// polynomials.
struct Disturbance {
  enum class Branch { ascending, descending };

  std::array<double, 3> ascending{};
  std::array<double, 3> descending{};

  struct AmplitudeGains {
    std::vector<double> alpha;  ///< input amplitude relative to full stroke, rising
    std::vector<double> ascending;
    std::vector<double> descending;

    std::vector<double>& of(Branch branch) { return branch == Branch::ascending ? ascending : descending; }
    const std::vector<double>& of(Branch branch) const {
      return branch == Branch::ascending ? ascending : descending;
    }
    /// alpha_b(alpha): the table interpolated linearly, through 0 below it and held above it. Without a table alpha itself: the
    /// loop keeps its shape.
    double at(Branch branch, double stroke) const;
  } amplitude;

  struct RateGains {
    std::vector<Hertz> frequency;  ///< rising
    std::vector<double> ascending;
    std::vector<double> descending;

    std::vector<double>& of(Branch branch) { return branch == Branch::ascending ? ascending : descending; }
    const std::vector<double>& of(Branch branch) const {
      return branch == Branch::ascending ? ascending : descending;
    }
  } rate;  ///< empty: 1 at every frequency

  std::array<double, 3>& coefficients(Branch branch) {
    return branch == Branch::ascending ? ascending : descending;
  }
  const std::array<double, 3>& coefficients(Branch branch) const {
    return branch == Branch::ascending ? ascending : descending;
  }
  /// d(x) of one branch without the gain tables.
  double value(Branch branch, double x) const {
    const auto& a = coefficients(branch);
    return x * (a[0] + x * (a[1] + x * a[2]));
  }
  /// d'(x).
  double slope(Branch branch, double x) const {
    const auto& a = coefficients(branch);
    return a[0] + x * (2.0 * a[1] + x * 3.0 * a[2]);
  }
  /// Largest |d'| over 0 ... to: the gain of a loop round the generator.
  double steepest(Branch branch, double to) const;
  /// As the stage (or, without `operating`, the generator) makes it at one amplitude and frequency: k_b(f) alpha_b(alpha)
  /// d_b(x/alpha), gains in the coefficients.
  Disturbance at(double alpha, std::optional<Hertz> operating = std::nullopt) const;
  /// Rate gain of a branch at an operating frequency: the table interpolated linearly in log frequency, held
  /// at its ends; 1 without a table.
  double rate_gain(Branch branch, Hertz frequency) const;
  /// Under a stiff, linear load that leaves this share of the stroke (disturbance paper, V.C.2): what the drive does up to
  /// there is the new full stroke, x' = x/stroke, d' = d/stroke, so that its polynomials are those here times
  /// alpha_b(stroke)/stroke and its amplitude gains alpha_b(stroke alpha')/alpha_b(stroke). The paper keeps the polynomials, which
  /// only amplitude gains alpha_b = alpha allow. InputError unless there is a table of amplitude gains, and 0 < stroke <= 1.
  Disturbance at_load(double stroke) const;
  /// True when the branch's rate gains are all 1 (within 1e-12): it needs no compensator.
  bool is_static(Branch branch) const;

  static Disturbance from_node(const Node& node);
  static Disturbance read(const std::filesystem::path& path, Provenance& from);
  /// Without the header.
  Json to_json() const;
};

inline constexpr Disturbance::Branch kBranches[] = {Disturbance::Branch::ascending,
                                                    Disturbance::Branch::descending};
/// Its place in kBranches.
inline constexpr std::size_t branch_index(Disturbance::Branch branch) {
  return static_cast<std::size_t>(branch);
}
inline constexpr Disturbance::Branch branch_of(bool rising) {
  return rising ? Disturbance::Branch::ascending : Disturbance::Branch::descending;
}
/// "ascending", "descending".
std::string_view to_string(Disturbance::Branch branch);

/// Coefficients [c0, c1, c2, c3] of the cubic through f at 0, 1/3, 2/3 and 1.
std::vector<double> cubic_of(const std::function<double(double)>& f);

}  // namespace bodesmith
