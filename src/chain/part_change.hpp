#pragma once

#include <string>
#include <vector>

namespace bodesmith::chain {

/// What a part's departure from its value does to the parameters of the block that it belongs to.
struct PartChange {
  std::string part;        ///< "Rd3"; "M2, offset of X"
  std::string unit;        ///< of the departure: "percent" of the value, or "v"
  double tolerance = 0.0;  ///< a good part is within so much of its value
  /// p(t) = p + slope t/(1 + bend t): any voltage of a resistive network depends on one of its resistors so
  /// (bilinear: Bode, Network Analysis and Feedback Amplifier Design, 1945, 10).
  struct Entry {
    std::string parameter;  ///< "descending[2]"
    double slope = 0.0;
    double bend = 0.0;
    double of(double departure) const { return slope * departure / (1.0 + bend * departure); }
  };
  std::vector<Entry> entries;

  /// From the values of the parameters at `departure` to both sides, less those at none.
  void add(std::string parameter, double departure, double above, double below);
};

}  // namespace bodesmith::chain
