#include "report/thin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace bodesmith::report {
namespace {

/// Which stretch a sample belongs to; nothing for one that cannot be drawn along x.
class Stretches {
 public:
  Stretches(const std::vector<double>& x, std::size_t count, bool logarithmic)
      : x_(x), count_(static_cast<double>(count)), logarithmic_(logarithmic) {
    std::optional<double> last;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::optional<double> place = place_of(i);
      if (!place) continue;
      if (!last) from_ = *place;
      if (last && *place < *last) sorted_ = false;
      last = place;
    }
    if (last) to_ = *last;
  }

  std::optional<double> number_of(std::size_t i) const {
    const std::optional<double> place = place_of(i);
    if (!place) return std::nullopt;
    if (!sorted_ || !(to_ > from_))
      return std::floor(count_ * static_cast<double>(i) / static_cast<double>(x_.size()));
    return std::min(count_ - 1.0, std::floor(count_ * (*place - from_) / (to_ - from_)));
  }

 private:
  const std::vector<double>& x_;
  double count_;
  bool logarithmic_;
  bool sorted_ = true;
  double from_ = 0.0;
  double to_ = 0.0;

  std::optional<double> place_of(std::size_t i) const {
    if (!std::isfinite(x_[i]) || (logarithmic_ && x_[i] <= 0.0)) return std::nullopt;
    return logarithmic_ ? std::log(x_[i]) : x_[i];
  }
};

/// Of one stretch: where y is lowest, where it is highest, and where it has no value.
struct Kept {
  std::optional<std::size_t> lowest, highest, gap;

  void add(std::size_t i, const std::vector<double>& y) {
    if (!std::isfinite(y[i])) {
      gap = i;
      return;
    }
    if (!lowest || y[i] < y[*lowest]) lowest = i;
    if (!highest || y[i] > y[*highest]) highest = i;
  }
};

}  // namespace

Series thinned(Series series, std::size_t most, bool logarithmic) {
  const std::size_t n = std::min(series.x.size(), series.y.size());
  if (n <= most) return series;
  series.x.resize(n);
  const Stretches stretches(series.x, std::max<std::size_t>(1, most / 2), logarithmic);
  std::vector<double> x;
  std::vector<double> y;
  const auto put = [&](const Kept& kept) {
    std::array<std::optional<std::size_t>, 3> at{kept.lowest, kept.highest, kept.gap};
    std::sort(at.begin(), at.end());
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (!at[k] || (k > 0 && at[k] == at[k - 1])) continue;
      x.push_back(series.x[*at[k]]);
      y.push_back(series.y[*at[k]]);
    }
  };
  Kept kept;
  std::optional<double> now;
  for (std::size_t i = 0; i < n; ++i) {
    const std::optional<double> stretch = stretches.number_of(i);
    if (!stretch) continue;
    if (now && *stretch != *now) {
      put(kept);
      kept = {};
    }
    now = stretch;
    kept.add(i, series.y);
  }
  put(kept);
  series.x = std::move(x);
  series.y = std::move(y);
  return series;
}

}  // namespace bodesmith::report
