#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "lti/sections.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::tracking {

/// What makes a drive: an analog circuit, whose every turn is one; or a board (harmonics, too), whose clocked steps are none.
enum class DriveKind { smooth, stepped };

/// A stage that reads its drive. Whatever makes the drive v(t) (an ideal controller, ngspice on the emitted
/// circuit, a board tick by tick) hands v here and gets the displacement a real stage would show. Units: v = 1
/// is the full-stroke drive, y = 1 the full stroke.
class Stage {
 public:
  Stage() = default;
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  virtual ~Stage() = default;

  virtual const std::string& name() const = 0;
  /// y in steady state, as many samples as v: v is sampled every step_s and repeats after its last sample (one
  /// period of the reference, or several where a clock and the reference meet only then). `operating`: the
  /// reference's frequency, at which the rate gains are taken. InputError: no samples, or one that is no number.
  virtual std::vector<double> response(std::span<const double> v, double step_s, Hertz operating,
                                       DriveKind kind) const = 0;
};

/// What stands before and behind the hysteresis: amplifier; damping compensator and resonance.
struct StagePaths {
  Sections drive;      ///< default the identity
  Sections mechanics;  ///< default the identity
};

/// The stage of the disturbance paper, reading its drive (facts/tracking; contract, compensator.sub):
///   u = D{v},   q = u + K_b(f) alpha_b(alpha) d_b(u/alpha),   y = P{q},   b the branch by the slope of u.
class PolynomialStage final : public Stage {
 public:
  enum class Rule {
    slope,   ///< b by the sign of the slope alone, at the fixed amplitude alpha
    nested,  ///< turning points are remembered: closed minor loops (hysteresis/polynomial_disturbance.hpp)
  };
  struct Options {
    double alpha =
        1.0;  ///< amplitude of the drive, for the amplitude gains; the rule `nested` sees it itself
    Rule rule = Rule::slope;
  };

  /// InputError when alpha is not above 0.
  PolynomialStage(Disturbance disturbance, StagePaths paths, Options options);
  PolynomialStage(Disturbance disturbance, StagePaths paths = {});

  const std::string& name() const override { return name_; }
  std::vector<double> response(std::span<const double> v, double step_s, Hertz operating,
                               DriveKind kind) const override;

 private:
  std::vector<double> by_slope(const std::vector<double>& u, Hertz operating, DriveKind kind) const;
  std::vector<double> by_turning_points(const std::vector<double>& u, Hertz operating) const;

  std::string name_ = "polynomial";
  Disturbance disturbance_;
  StagePaths paths_;
  Options options_;
};

/// InputError for a drive without samples, or with one that is no number.
void check_drive(std::span<const double> v);

/// One period through a path of stable poles, in steady state (settled_path()).
std::vector<double> through_path(const Sections& path, std::span<const double> u, double step_s);

/// For each sample of a repeating signal of that amplitude whether it rises there: cut at the turning points from which it goes back
/// by more than a simulator's noise (1e-5 of that), or the steps of a clocked drive (2 %). All true when it never does.
std::vector<bool> rising_samples(std::span<const double> u, double alpha, DriveKind kind);

/// Eq. 8 of the disturbance paper: 100 rms(y - x)/(max y - min y), and the same with the best pure delay of x.
struct TrackingError {
  double rms_percent = 0.0;
  double max_percent = 0.0;  ///< largest |y - x|
  double range = 0.0;        ///< max y - min y
  double lag_s = 0.0;        ///< the delay of x that makes the rms smallest
  double rms_percent_without_lag = 0.0;
};
/// y over whole periods; x, the wanted displacement, over one (repeated as often as y is long), which lasts
/// period_s. InputError when the lengths do not go together or y does not move.
TrackingError tracking_error(std::span<const double> y, std::span<const double> x, double period_s);
/// The same without looking for a delay (lag_s and rms_percent_without_lag stay 0), which takes most of the time.
TrackingError plain_error(std::span<const double> y, std::span<const double> x);

/// Delay of the reference that makes the rms of y - x(t - lag) smallest, and that rms.
struct LagResult {
  double lag_s = 0.0;
  double rms = 0.0;
};
/// Both sampled over `period_s`, after which both repeat.
LagResult best_lag(const std::vector<double>& y, const std::vector<double>& x, double period_s);

}  // namespace bodesmith::tracking
