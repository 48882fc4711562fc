#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "base/units.hpp"
#include "hysteresis/model_type.hpp"
#include "lti/sections.hpp"
#include "signal/time_record.hpp"
#include "tracking/stage.hpp"

namespace bodesmith::tracking {

/// A stage of another family: a hysteresis model (Preisach, Prandtl-Ishlinskii, Bouc-Wen, …) identified from the
/// loops of a polynomial stage, full stroke and partial ones, at every operating frequency of its own, as the
/// disturbance paper does with its Preisach model (section V-B). A stage is not its polynomial: what a controller
/// made of the polynomial leaves here can be as good as the model's own fit, not better.
///   u = D{v},   y = P{H[u]},  or P{2u - H[u]} where the loops run clockwise (as those of the printed polynomials
/// do): these families' loops only run the other way, so they are identified from 2u - y.
class IdentifiedStage final : public Stage {
 public:
  struct Options {
    std::size_t samples = 80;  ///< a half stroke
    hysteresis::IdentifyOptions identify;
  };

  IdentifiedStage(const hysteresis::ModelType& type, Disturbance disturbance, StagePaths paths,
                  Options options);

  const std::string& name() const override;
  std::vector<double> response(std::span<const double> v, double step_s, Hertz operating,
                               DriveKind kind) const override;

  /// How far the model is from the loops it was identified from at that frequency, percent of range (eq. 8), over
  /// the full stroke.
  double fit_percent(Hertz operating) const;

 private:
  struct Found {
    hysteresis::Identified model;
    double fit_percent = 0.0;
  };
  const Found& found(Hertz operating) const;
  TimeRecord loops(Hertz operating) const;

  const hysteresis::ModelType& type_;
  Disturbance disturbance_;
  StagePaths paths_;
  Options options_;
  bool mirrored_ = false;
  mutable std::mutex mutex_;
  mutable std::map<std::pair<double, double>, Found> known_;  ///< by the rate gains of both branches
};

/// w/(s + w): a first-order lag as a path.
Sections lowpass_path(Hertz corner);

/// w^2/(s^2 + 2 zeta w s + w^2).
Sections resonance_path(Hertz natural_frequency, double damping_ratio);

}  // namespace bodesmith::tracking
