#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "lti/loop_margins.hpp"
#include "tuning/controller_kind.hpp"
#include "tuning/plant_family.hpp"

namespace bodesmith::tuning {

/// What every loop of a family shall keep.
struct LoopLimits {
  double phase_margin_deg = 60.0;
  double gain_margin_db = 6.0;            ///< either way: gain that may be added, and lost
  std::optional<double> max_sensitivity;  ///< |1/(1 + L)|
};

/// Whether 1/(1 + L) is stable for L without poles in the right half plane, by the turns of 1 + L(jw) round 0 (Nyquist),
/// from samples so dense that no step turns by half a turn. `integrators`: poles of L at 0. Needs |L| < 1 at the last
/// sample and beyond; false otherwise.
bool turns_are_stable(std::span<const Complex> loop, int integrators);

/// How far the samples of L are from keeping the limits: 0 when they do, the sum of the relative shortfalls otherwise, 2
/// more when the loop is unstable. Crossings between neighbours by straight lines in log magnitude and phase.
double shortfall(std::span<const Complex> loop, int integrators, const LoopLimits& limits);

struct TuneOptions {
  LoopLimits limits;
  /// Where the nominal loop's gain is 1; absent: the highest at which the limits can be kept.
  std::optional<Hertz> bandwidth;
  /// Of the derivative and the roll-off; absent: ten times the bandwidth.
  std::optional<Hertz> derivative_corner;
  std::uint64_t seed = 1;
};

/// The margins of one plant of the family.
struct MemberMargins {
  std::string plant;
  LoopMargins margins;
  bool stable = false;
};

struct TunedLoop {
  SeriesController controller;
  Hertz bandwidth;
  std::vector<MemberMargins> members;  ///< nominal first
  std::vector<std::string> missed;     ///< limits that some plant does not keep: what, by which plant most
  /// When the bandwidth asked for cannot be had: one at which the limits are kept.
  std::optional<Hertz> reachable_bandwidth;

  bool met() const { return missed.empty(); }
  bool stable() const;  ///< with every plant
  /// `bandwidth_hz`, `asked`, `nominal`, `worst`, `plants`, `missed`.
  Json report_json(const TuneOptions& options) const;
};

/// Least over the plants, in size.
struct LeastMargins {
  std::optional<double> phase_margin_deg;
  std::optional<double> gain_margin_db;
  double max_sensitivity = 0.0;
};
LeastMargins least_margins(const std::vector<MemberMargins>& members);

/// The controller of this kind with the largest gain at a hundredth of the bandwidth among those that keep the limits with
/// every plant of the family, by differential evolution on sampled loops; margins as returned are found again by
/// loop_margins() on the controller as made. A plant has no poles in the right half plane. DesignError when no bandwidth
/// was asked for and none can be had within the plant's band.
TunedLoop tune(const PlantFamily& plants, const ControllerKind& kind, const TuneOptions& options);

}  // namespace bodesmith::tuning
