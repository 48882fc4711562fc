#include "fpaa/section_search.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <numeric>

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

/// A capacitor ratio in lowest terms. Its corner sits at w = 1/slope on the axis of tan(w/2fc).
struct Ratio {
  int c0 = 1;
  int c1 = 1;
  double slope() const { return 1.0 + 2.0 * c1 / c0; }
};

std::vector<Ratio> all_ratios(int largest) {
  std::vector<Ratio> out;
  for (int c0 = 1; c0 <= largest; ++c0) {
    for (int c1 = 1; c1 <= largest; ++c1) {
      if (std::gcd(c0, c1) == 1) out.push_back({c0, c1});
    }
  }
  std::sort(out.begin(), out.end(), [](const Ratio& a, const Ratio& b) { return a.c1 * b.c0 < b.c1 * a.c0; });
  return out;
}

const std::vector<Ratio>& ratios_to(int largest) {
  static std::mutex mutex;
  static std::map<int, std::vector<Ratio>> known;
  const std::lock_guard<std::mutex> lock(mutex);
  auto at = known.find(largest);
  if (at == known.end()) at = known.emplace(largest, all_ratios(largest)).first;
  return at->second;
}

class Search {
 public:
  Search(RadPerSecond zero, RadPerSecond pole, Hertz clock, const std::vector<RadPerSecond>& grid,
         int largest)
      : ratios_(ratios_to(largest)) {
    for (const RadPerSecond w : grid) {
      axis_.push_back(std::tan(0.5 * w.value / clock.value));
      const Complex wanted = Complex(1.0, w.value / zero.value) / Complex(1.0, w.value / pole.value);
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
    const size_t p = nearest(nominal_pole_);
    const size_t z = nearest(nominal_zero_);
    for (size_t i = p > 2 ? p - 2 : 0; i < std::min(ratios_.size(), p + 3); ++i) {
      for (size_t k = z > 8 ? z - 8 : 0; k < std::min(ratios_.size(), z + 9); ++k) evaluate(k, i);
    }
    visit(0, ratios_.size());
    return best_;
  }

 private:
  size_t nearest(double slope) const {
    const auto at = std::lower_bound(ratios_.begin(), ratios_.end(), slope,
                                     [](const Ratio& r, double s) { return r.slope() < s; });
    if (at == ratios_.end()) return ratios_.size() - 1;
    return static_cast<size_t>(at - ratios_.begin());
  }

  /// Zero slopes that pole slopes in [low, high] leave possible; false: none.
  bool zero_interval(double low, double high, double& from, double& to) const {
    const double slack =
        best_.max_complex_error < 1.0 ? std::asin(best_.max_complex_error) : std::numbers::pi;
    from = 0.0;
    to = std::numeric_limits<double>::infinity();
    for (size_t k = 0; k < axis_.size(); ++k) {
      const double least = phase_[k] + std::atan(axis_[k] * low) - slack;
      const double most = phase_[k] + std::atan(axis_[k] * high) + slack;
      if (least >= 0.5 * std::numbers::pi || most <= 0.0) return false;
      if (least > 0.0) from = std::max(from, std::tan(least) / axis_[k]);
      if (most < 0.5 * std::numbers::pi) to = std::min(to, std::tan(most) / axis_[k]);
    }
    return from <= to;
  }

  /// Pole ratios [first, last).
  void visit(size_t first, size_t last) {
    if (first >= last) return;
    double from = 0.0;
    double to = 0.0;
    if (!zero_interval(ratios_[first].slope(), ratios_[last - 1].slope(), from, to)) return;
    if (last - first > 1) {
      const size_t middle = first + (last - first) / 2;
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
    const auto less = [](const Ratio& r, double s) { return r.slope() < s; };
    const auto begin = std::lower_bound(ratios_.begin(), ratios_.end(), from * (1.0 - 1e-12), less);
    for (auto at = begin; at != ratios_.end() && at->slope() <= to * (1.0 + 1e-12); ++at) {
      evaluate(static_cast<size_t>(at - ratios_.begin()), first);
    }
  }

  void evaluate(size_t zero, size_t pole) {
    ++best_.evaluated;
    const double a = ratios_[zero].slope();
    const double b = ratios_[pole].slope();
    // Cheapest first: the spread of the magnitudes alone bounds the error from below.
    double low = std::numeric_limits<double>::infinity();
    double high = 0.0;
    q_.resize(axis_.size());
    for (size_t k = 0; k < axis_.size(); ++k) {
      q_[k] = Complex(1.0, axis_[k] * a) / Complex(1.0, axis_[k] * b) / wanted_[k];
      const double magnitude = std::norm(q_[k]);
      low = std::min(low, magnitude);
      high = std::max(high, magnitude);
    }
    low = std::sqrt(low);
    high = std::sqrt(high);
    if ((high - low) / (high + low) >= best_.max_complex_error) return;
    double gain = 1.0;
    const double error = best_free_gain_error(q_, gain);
    if (error < best_.max_complex_error) {
      best_.max_complex_error = error;
      best_.capacitors = {ratios_[zero].c0, ratios_[zero].c1, ratios_[pole].c0, ratios_[pole].c1};
      // q was taken with unit DC gain; the capacitors have theirs.
      best_.free_gain = gain / best_.capacitors.dc_gain();
    }
  }

  const std::vector<Ratio>& ratios_;
  std::vector<double> axis_, phase_;
  std::vector<Complex> wanted_, q_;
  double nominal_pole_ = 1.0;
  double nominal_zero_ = 1.0;
  SectionOptimum best_;
};

}  // namespace

double best_free_gain_error(const std::vector<Complex>& q, double& gain) {
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  for (const Complex& value : q) {
    low = std::min(low, std::abs(value));
    high = std::max(high, std::abs(value));
  }
  // max |g q - 1| is convex in g: bisect on its slope. The minimum lies where the largest and the smallest
  // |q| bracket.
  double from = 0.0;
  double to = 2.0 / low;
  double error = 0.0;
  for (int step = 0; step < 60; ++step) {
    gain = 0.5 * (from + to);
    double worst = -1.0;
    double slope = 0.0;
    for (const Complex& value : q) {
      const double e = std::norm(gain * value - 1.0);
      if (e > worst) {
        worst = e;
        slope = gain * std::norm(value) - value.real();
      }
    }
    error = std::sqrt(worst);
    if (slope > 0.0) {
      to = gain;
    } else {
      from = gain;
    }
  }
  return error;
}

SectionOptimum best_pole_zero(RadPerSecond zero, RadPerSecond pole, Hertz clock,
                              const std::vector<RadPerSecond>& grid, int largest) {
  return Search(zero, pole, clock, grid, largest).run();
}

}  // namespace bodesmith::fpaa
