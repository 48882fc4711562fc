#pragma once

#include <cstdint>
#include <vector>

#include "fpaa/plan/drawn_board.hpp"
#include "numeric/departure.hpp"
#include "schematic/analysis/response.hpp"
#include "tolerance/yield.hpp"

namespace bodesmith::tolerance {

/// Evaluates blocks of samples. One a thread; allocates in the constructor only (boards apart).
class Kernel {
 public:
  static constexpr int kBlock = 64;

  Kernel(const Design& design, const Options& options);

  /// Samples [first, first + count), count <= kBlock.
  void evaluate(std::uint64_t first, int count);

  /// Deviations of the last block in dB and degrees at frequency i, one a sample.
  const double* decibel(std::size_t i) const { return decibel_.data() + i * kBlock; }
  const double* degrees(std::size_t i) const { return degrees_.data() + i * kBlock; }

 private:
  struct Pair {  ///< two stages of first order (or one of second), multiplied out
    int first = 0, second = -1;
  };

  void draw(std::uint64_t sample);
  void coefficients(int lane);
  /// Every response by itself: a board, a netlist, integrators.
  void evaluate_one_by_one(std::uint64_t first, int count);

  const Design& design_;
  const Options& options_;
  bool quick_ = true;  ///< by pairs
  std::optional<fpaa::DrawnBoard> board_;
  std::optional<schematic::ResponseOfParts> network_;
  std::vector<Complex> drawn_;  ///< one of its responses
  std::vector<Pair> pairs_;
  std::vector<double> values_;
  std::vector<Departure> departure_;  ///< of each part, relative
  std::vector<double> extra_;         ///< what each part has too much, in its own unit
  std::vector<double> ppm_;           ///< temperature coefficient of each part
  bool warm_ = false;
  std::vector<double> b0_, b1_, b2_, a1_, a2_;       ///< a0 = 1; [pair][lane]
  std::vector<double> w_;                            ///< [frequency], rad/s
  std::vector<double> reference_re_, reference_im_;  ///< 1/reference
  std::vector<double> nr_, ni_, dr_, di_;            ///< [lane]
  std::vector<double> decibel_, degrees_;            ///< [frequency][lane]
};

}  // namespace bodesmith::tolerance
