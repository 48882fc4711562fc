#pragma once

#include <functional>
#include <vector>

#include "lti/frequency_grid.hpp"

namespace bodesmith {

/// Nepers (and radians) that a neper of frequency is worth to a judge: 1 dB (6.6 degrees) a percent.
inline constexpr double kFlankRate = 0.11512925464970229 / 0.01;

/// A response on a grid, as a judge of others sees it. Near a zero on the axis or a sharp resonance a response changes by
/// tens of decibels within a percent of frequency, and preferred values miss frequencies by a part of a percent: an error in
/// decibels at one frequency says nothing there. The curve may therefore be moved sideways before it is compared, and a
/// percent of that counts as a decibel (6.6 degrees, the same change of a complex number). An error is
///   min over f' of  |L(f) - L_wanted(f')| + kFlankRate |ln(f'/f)|,
/// which is the difference at f itself wherever the curve changes by less than a decibel a percent. Levels end at
/// kJudgedFloor of the largest; between the grid's points ln H is taken as straight in ln f.
class FlankedCurve {
 public:
  FlankedCurve(const std::vector<Hertz>& grid, const std::vector<Complex>& wanted);

  /// Above kJudgedFloor of the largest.
  bool is_judged(std::size_t i) const { return judged_[i]; }
  /// Somewhere the level changes by more than a decibel a percent.
  bool has_flanks() const { return has_flanks_; }
  /// No error at point i that is smaller than this, in nepers or radians, is told as less than the difference there.
  double as_it_is_below(std::size_t i) const { return reach_[i]; }

  struct Error {
    double neper = 0.0;
    double rad = 0.0;
    double relative = 0.0;  ///< |got/wanted - 1|; of what is moved, |ln(got/wanted)| and the shift
  };
  /// Which of its figures stay at or below those of `enough` is all that is told of them.
  Error error(std::size_t i, Complex got, const Error& enough) const;
  Error error(std::size_t i, Complex got) const { return error(i, got, Error{}); }

 private:
  /// Level and angle of `got` against the curve's at point k.
  Complex difference(std::size_t k, Complex log_got) const;
  void visit(std::size_t i, int step, Complex log_got, const Error& enough, Error& out) const;

  std::vector<double> log_f_;
  std::vector<Complex> log_h_;
  std::vector<Complex> h_;
  std::vector<bool> judged_;
  std::vector<double> turn_;  ///< of the angle since the point before
  std::vector<double> reach_;
  double floor_ = 0.0;  ///< ln of it
  bool has_flanks_ = false;
};

bool has_flanks(const std::function<Complex(Hertz)>& response, Band band);

/// What summaries say of a response with flanks.
inline constexpr const char* kFlanksText =
    "where a percent of frequency is more than 1 dB, errors are told as shifts: a percent counts as 1 dB";

}  // namespace bodesmith
