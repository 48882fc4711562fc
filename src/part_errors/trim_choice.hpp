#pragma once

#include <vector>

#include "part_errors/trim.hpp"

namespace bodesmith::part_errors {

/// The linear model of a controller's errors: what each cause (at one standard deviation) and each trim (at one
/// unit_setting) moves the tracking error's waveforms and the readings by.
class TrimModel {
 public:
  TrimModel(const controller::AnalogController& controller, const tracking::Stage& stage,
            const StudyOptions& options, double reading_noise_v);

  /// Trims with readings, in the order in which turning one after the other settles fastest. `foreseen`: share of
  /// the mean square left after none, one, two, … of them.
  std::vector<TrimStep> choose(int count, int rounds, std::vector<double>& foreseen) const;

 private:
  struct Pick {
    std::size_t trim = 0, reading = 0;
  };
  double left(const std::vector<Pick>& picks) const;
  /// How far from settled the readings are after so many rounds, 0: settled.
  double unsettled(const std::vector<Pick>& picks, int rounds) const;
  double left_settled(std::vector<Pick> picks, int rounds, double bound) const;
  bool refine(std::vector<Pick>& picks, int rounds, double& best) const;
  bool usable(const std::vector<Pick>& picks, std::size_t except, std::size_t trim,
              std::size_t reading) const;
  /// The order and the giving of readings to trims that has settled best, and how well.
  double put_in_order(std::vector<Pick>& picks, int rounds) const;
  std::vector<double> settings(const std::vector<Pick>& picks, const std::vector<double>& readings) const;

  std::vector<Trim> trims_;
  std::vector<Reading> readings_;
  std::vector<double> expected_v_;
  double noise_v_;
  std::size_t causes_ = 0;
  std::vector<std::vector<double>> gram_;   ///< waveforms of causes, then trims
  std::vector<std::vector<double>> moved_;  ///< [cause or trim][reading]
};

}  // namespace bodesmith::part_errors
