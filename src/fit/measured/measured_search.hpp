#pragma once

#include <vector>

#include "fit/measured/factored_response.hpp"

namespace bodesmith {

/// Fits of rising order to one set of samples, each order started from evenly spread poles and from the order before with
/// one or two poles added where its error is largest.
class MeasuredSearch {
 public:
  MeasuredSearch(const ResponseSamples& samples, bool with_delay);

  /// The best fit of so many poles; earlier orders are used where they were asked for.
  const FactoredResponse& of_order(int order);

 private:
  void find_delay();
  FactoredResponse from_poles(std::vector<std::complex<double>> poles, double delay, int rounds) const;
  FactoredResponse settled(FactoredResponse model) const;
  std::vector<std::vector<std::complex<double>>> starts(int order) const;
  std::complex<double> worst_place(const FactoredResponse& model) const;

  const ResponseSamples& samples_;
  bool with_delay_;
  double delay_ = 0.0;  ///< where every order begins
  double largest_s_ = 1.0;
  std::vector<FactoredResponse> found_;  ///< by order, order 0 first; cost < 0: not tried yet
};

}  // namespace bodesmith
