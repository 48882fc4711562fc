#pragma once

#include <complex>
#include <vector>

#include "fpaa/network.hpp"

namespace bodesmith::fpaa {

/// Complex numbers at the points of a grid, real and imaginary parts apart; filled up to a multiple of four.
struct GridNumbers {
  explicit GridNumbers(std::size_t points = 0);
  GridNumbers(const std::vector<std::complex<double>>& from, std::complex<double> fill);

  std::complex<double> at(std::size_t k) const { return {re[k], im[k]}; }

  std::size_t points = 0;
  std::vector<double> re, im;
};

/// One stage of a network with everything round it as it is. The output is linear in the response of one stage,
/// so what other capacitors of it do to the weighted errors is exact, and costs one stage instead of all.
class StageView {
 public:
  StageView(const Network& network, std::size_t stage, const NetworkResponse& response);

  /// What a stage in this place adds to the weighted output.
  void share_of(const NetworkStage& stage, GridNumbers& out) const;
  /// That of the stage as it is.
  const GridNumbers& share() const { return share_; }
  /// Weighted errors with the stage as it is.
  const GridNumbers& errors() const { return errors_; }
  /// Largest weighted error with this stage in its place.
  double largest_error_with(const NetworkStage& stage) const;

 private:
  GridNumbers d_;
  GridNumbers errors_;
  std::vector<GridNumbers> ways_;  ///< from each input's response to the weighted output
  GridNumbers share_;
};

}  // namespace bodesmith::fpaa
