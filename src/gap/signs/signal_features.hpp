#pragma once

#include <Eigen/Core>

#include "gap/signs/signs.hpp"

namespace bodesmith::gap {

/// Middles and sizes of the signals of all records, so that all are seen on the same scale.
struct SignalScales {
  double middle_y = 0.0;
  double size_y = 0.0;
  double middle_u = 0.0;
  double size_u = 0.0;
  std::size_t eighth_of_period = 1;  ///< samples, of the output's mean frequency in the quickest record
};
SignalScales signal_scales(const std::vector<Leftover>& records);

/// Features of signals from which a missing effect could be predicted: samples by features, each column of
/// zero mean. Curves of the output, its change, the input's branch, earlier inputs and outputs, plays, slow
/// averages.
Eigen::MatrixXd signal_features(const Leftover& record, const SignalScales& scales);

}  // namespace bodesmith::gap
