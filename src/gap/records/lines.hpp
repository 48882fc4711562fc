#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gap/model/model.hpp"
#include "gap/records/experiment.hpp"

namespace bodesmith::gap {

/// Sines of known frequencies over the scored samples of one record, sizes and phases free: those of mains hum
/// differ from record to record, and are therefore no unknowns of a fit but taken out of every residual
/// (the frequencies stay unknowns; variable projection, Golub and Pereyra 1973).
class LineBasis {
 public:
  /// Sines at these frequencies over samples `from` … `end` - 1 of a record, t as in its time_s. Above half
  /// the sampling rate they are what sampling makes of them.
  void set(std::span<const double> frequencies_hz, const TimeRecord& record, std::size_t from,
           std::size_t end);
  bool empty() const { return directions_.empty(); }
  /// Takes out what the sines explain, beside the directions over the same samples that are given.
  void take_out(std::span<double> residual, const Directions* beside = nullptr);

 private:
  void make_orthonormal(const Directions* beside);
  std::vector<double> frequencies_hz_;
  std::size_t from_ = 0;
  std::size_t end_ = 0;
  bool orthonormal_ = false;
  Directions directions_;
};

/// A line's size and phase: amplitude sin(2 pi frequency_hz t + phase_deg).
struct FittedLine {
  double amplitude = 0.0;
  double phase_deg = 0.0;
};
/// Least squares of a residual (measured - model) over samples `from` … of the record.
std::vector<FittedLine> fit_lines(std::span<const double> frequencies_hz, const TimeRecord& record,
                                  std::size_t from, std::span<const double> residual);

}  // namespace bodesmith::gap
