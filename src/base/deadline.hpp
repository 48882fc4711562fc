#pragma once

#include <chrono>
#include <optional>

namespace bodesmith {

/// A time after which a long search begins nothing new and keeps the best so far; by default there is none.
class Deadline {
 public:
  Deadline() = default;
  /// So many seconds from now.
  explicit Deadline(double seconds)
      : end_(std::chrono::steady_clock::now() +
             std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                 std::chrono::duration<double>(seconds < kLongest_s ? seconds : kLongest_s))) {}

  bool passed() const { return end_ && std::chrono::steady_clock::now() >= *end_; }

 private:
  static constexpr double kLongest_s = 1e9;  ///< what the clock's counter holds

  std::optional<std::chrono::steady_clock::time_point> end_;
};

}  // namespace bodesmith
