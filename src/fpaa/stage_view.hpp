#pragma once

#include <complex>
#include <vector>

#include "fpaa/network.hpp"

namespace bodesmith::fpaa {

/// One stage of a network with everything round it as it is. The output is linear in the response of one stage,
/// so what other capacitors of it do to the weighted errors is exact, and costs one stage instead of all.
class StageView {
 public:
  StageView(const Network& network, std::size_t stage, const NetworkResponse& response);

  /// What a stage in this place adds to the weighted output.
  std::vector<std::complex<double>> share_of(const NetworkStage& stage) const;
  /// That of the stage as it is.
  const std::vector<std::complex<double>>& share() const { return share_; }
  /// Weighted errors with the stage as it is.
  const std::vector<std::complex<double>>& errors() const { return errors_; }
  /// Largest weighted error with this stage in its place.
  double largest_error_with(const NetworkStage& stage) const;

 private:
  const std::vector<std::complex<double>>& d_;
  std::vector<std::complex<double>> errors_;
  std::vector<std::vector<std::complex<double>>>
      ways_;  ///< from each input's response to the weighted output
  std::vector<std::complex<double>> share_;
};

}  // namespace bodesmith::fpaa
