#include "fpaa/section_search.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>

namespace bodesmith::fpaa {
namespace {

/// Slopes this near to a bound, relative, are still looked at.
constexpr double kSlopeRounding = 1e-12;
/// Halvings that take a gain to rounding.
constexpr int kBisections = 60;

/// A capacitor ratio in lowest terms. Its corner sits at w = 1/slope on the axis of tan(w/2fc).
struct CapacitorRatio {
  int c0 = 1;
  int c1 = 1;
  double slope() const { return 1.0 + 2.0 * c1 / c0; }
};

std::vector<CapacitorRatio> all_ratios(int max_capacitor) {
  std::vector<CapacitorRatio> out;
  for (int c0 = 1; c0 <= max_capacitor; ++c0) {
    for (int c1 = 1; c1 <= max_capacitor; ++c1) {
      if (std::gcd(c0, c1) == 1) out.push_back({c0, c1});
    }
  }
  std::sort(out.begin(), out.end(),
            [](const CapacitorRatio& a, const CapacitorRatio& b) { return a.c1 * b.c0 < b.c1 * a.c0; });
  return out;
}

const std::vector<CapacitorRatio>& ratios_to(int max_capacitor) {
  static std::mutex mutex;
  static std::map<int, std::vector<CapacitorRatio>> known;
  const std::lock_guard<std::mutex> lock(mutex);
  auto at = known.find(max_capacitor);
  if (at == known.end()) at = known.emplace(max_capacitor, all_ratios(max_capacitor)).first;
  return at->second;
}

struct SlopeRange {
  double from = 0.0;
  double to = 0.0;
};

/// Branch and bound over the ratios of the pole.
class PoleZeroSearch {
 public:
  PoleZeroSearch(RadPerSecond zero, RadPerSecond pole, Hertz clock, const std::vector<RadPerSecond>& grid,
                 int max_capacitor)
      : ratios_(ratios_to(max_capacitor)) {
    for (const RadPerSecond w : grid) {
      axis_.push_back(std::tan(0.5 * w.value / clock.value));
      const std::complex<double> wanted =
          std::complex<double>(1.0, w.value / zero.value) / std::complex<double>(1.0, w.value / pole.value);
      wanted_.push_back(wanted);
      phase_.push_back(std::arg(wanted));
    }
    best_.sets = static_cast<double>(ratios_.size()) * static_cast<double>(ratios_.size());
    best_.max_complex_error = std::numeric_limits<double>::infinity();
    nominal_pole_ = 1.0 / std::tan(0.5 * pole.value / clock.value);
    nominal_zero_ = 1.0 / std::tan(0.5 * zero.value / clock.value);
  }

  SectionOptimum run() {
    // A good start makes the bounds sharp: the ratios next to both corners.
    const std::size_t p = nearest(nominal_pole_);
    const std::size_t z = nearest(nominal_zero_);
    for (std::size_t i = p > 2 ? p - 2 : 0; i < std::min(ratios_.size(), p + 3); ++i) {
      for (std::size_t k = z > 8 ? z - 8 : 0; k < std::min(ratios_.size(), z + 9); ++k) evaluate(k, i);
    }
    visit(0, ratios_.size());
    return best_;
  }

 private:
  std::size_t nearest(double slope) const {
    const auto at = std::lower_bound(ratios_.begin(), ratios_.end(), slope,
                                     [](const CapacitorRatio& r, double s) { return r.slope() < s; });
    if (at == ratios_.end()) return ratios_.size() - 1;
    return static_cast<std::size_t>(at - ratios_.begin());
  }

  /// Zero slopes that pole slopes in [low, high] leave possible.
  std::optional<SlopeRange> zero_range(double low, double high) const {
    const double slack =
        best_.max_complex_error < 1.0 ? std::asin(best_.max_complex_error) : std::numbers::pi;
    SlopeRange out{0.0, std::numeric_limits<double>::infinity()};
    for (std::size_t k = 0; k < axis_.size(); ++k) {
      const double min_phase = phase_[k] + std::atan(axis_[k] * low) - slack;
      const double max_phase = phase_[k] + std::atan(axis_[k] * high) + slack;
      if (min_phase >= 0.5 * std::numbers::pi || max_phase <= 0.0) return std::nullopt;
      if (min_phase > 0.0) out.from = std::max(out.from, std::tan(min_phase) / axis_[k]);
      if (max_phase < 0.5 * std::numbers::pi) out.to = std::min(out.to, std::tan(max_phase) / axis_[k]);
    }
    if (!(out.from <= out.to)) return std::nullopt;
    return out;
  }

  /// Pole ratios [first, last).
  void visit(std::size_t first, std::size_t last) {
    if (first >= last) return;
    const auto zeros = zero_range(ratios_[first].slope(), ratios_[last - 1].slope());
    if (!zeros) return;
    if (last - first > 1) {
      const std::size_t middle = first + (last - first) / 2;
      // The half nearer to the wanted pole first.
      if (nominal_pole_ < ratios_[middle].slope()) {
        visit(first, middle);
        visit(middle, last);
      } else {
        visit(middle, last);
        visit(first, middle);
      }
      return;
    }
    const auto less = [](const CapacitorRatio& r, double s) { return r.slope() < s; };
    const auto begin =
        std::lower_bound(ratios_.begin(), ratios_.end(), zeros->from * (1.0 - kSlopeRounding), less);
    for (auto at = begin; at != ratios_.end() && at->slope() <= zeros->to * (1.0 + kSlopeRounding); ++at) {
      evaluate(static_cast<std::size_t>(at - ratios_.begin()), first);
    }
  }

  void evaluate(std::size_t zero, std::size_t pole) {
    ++best_.evaluated;
    const double a = ratios_[zero].slope();
    const double b = ratios_[pole].slope();
    // Cheapest first: the spread of the magnitudes alone bounds the error from below.
    double low = std::numeric_limits<double>::infinity();
    double high = 0.0;
    q_.resize(axis_.size());
    for (std::size_t k = 0; k < axis_.size(); ++k) {
      q_[k] = std::complex<double>(1.0, axis_[k] * a) / std::complex<double>(1.0, axis_[k] * b) / wanted_[k];
      const double magnitude = std::norm(q_[k]);
      low = std::min(low, magnitude);
      high = std::max(high, magnitude);
    }
    low = std::sqrt(low);
    high = std::sqrt(high);
    if ((high - low) / (high + low) >= best_.max_complex_error) return;
    const FreeGain free = best_free_gain(q_);
    if (free.error < best_.max_complex_error) {
      best_.max_complex_error = free.error;
      best_.capacitors = {ratios_[zero].c0, ratios_[zero].c1, ratios_[pole].c0, ratios_[pole].c1};
      // q was taken with unit DC gain; the capacitors have theirs.
      best_.free_gain = free.gain / best_.capacitors.dc_gain();
    }
  }

  const std::vector<CapacitorRatio>& ratios_;
  std::vector<double> axis_, phase_;
  std::vector<std::complex<double>> wanted_, q_;
  double nominal_pole_ = 1.0;
  double nominal_zero_ = 1.0;
  SectionOptimum best_;
};

}  // namespace

FreeGain best_free_gain(const std::vector<std::complex<double>>& q) {
  double low = std::numeric_limits<double>::infinity();
  for (const std::complex<double>& value : q) low = std::min(low, std::abs(value));
  // max |g q - 1| is convex in g: bisect on its slope. The minimum lies where the largest and the smallest
  // |q| bracket.
  double from = 0.0;
  double to = 2.0 / low;
  FreeGain out;
  for (int step = 0; step < kBisections; ++step) {
    out.gain = 0.5 * (from + to);
    double worst = -1.0;
    double slope = 0.0;
    for (const std::complex<double>& value : q) {
      const double e = std::norm(out.gain * value - 1.0);
      if (e > worst) {
        worst = e;
        slope = out.gain * std::norm(value) - value.real();
      }
    }
    out.error = std::sqrt(worst);
    if (slope > 0.0) {
      to = out.gain;
    } else {
      from = out.gain;
    }
  }
  return out;
}

SectionOptimum best_pole_zero(RadPerSecond zero, RadPerSecond pole, Hertz clock,
                              const std::vector<RadPerSecond>& grid, int max_capacitor) {
  return PoleZeroSearch(zero, pole, clock, grid, max_capacitor).run();
}

}  // namespace bodesmith::fpaa
