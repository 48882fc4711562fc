#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tolerance/yield.hpp"

namespace bodesmith::tolerance {

/// Everything that samples are counted into: one histogram of dB and one of degrees a frequency, one each of
/// the worst (dB, degrees, complex percent) over the grid, and how many stayed within the limits.
class Counts {
 public:
  static constexpr int kBins = 8192;

  /// Ranges are those of `shape`.
  explicit Counts(const Result& shape);

  /// Adds one sample's deviations.
  void add(std::size_t i, double decibel, double degrees) {
    count(2 * i, decibel);
    count(2 * i + 1, degrees);
  }
  void add_worst(double decibel, double degrees, double percent, bool within) {
    count(histograms_ - 3, decibel);
    count(histograms_ - 2, degrees);
    count(histograms_ - 1, percent);
    within_ += within ? 1 : 0;
    ++samples_;
  }
  void merge(const Counts& other);
  /// Sums over the team, on the leader.
  void gather(const Team& team);
  void put_into(Result& result) const;

  std::uint64_t samples() const { return samples_; }
  /// Bytes of a checkpoint, with their hash, and back; false when they do not fit or are damaged.
  std::string bytes() const;
  bool from_bytes(std::string_view bytes);

 private:
  void count(std::size_t h, double value) {
    min_[h] = value < min_[h] ? value : min_[h];
    max_[h] = value > max_[h] ? value : max_[h];
    double place = (value - low_[h]) * per_bin_[h];
    place = place < 0.0 ? 0.0 : (place > kBins - 1 ? kBins - 1 : place);
    ++counts_[h * kBins + static_cast<std::size_t>(place)];
  }

  std::size_t histograms_ = 0;
  std::vector<double> low_, per_bin_;
  std::vector<std::uint64_t> counts_;
  std::vector<double> min_, max_;
  std::uint64_t samples_ = 0;
  std::uint64_t within_ = 0;
};

}  // namespace bodesmith::tolerance
