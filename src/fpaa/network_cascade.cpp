#include "fpaa/network_cascade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;
using Stage = NetworkStage;

constexpr double kOneRatio = 220.0;     ///< largest ratio of two capacitors that is designed for
constexpr double kFarZero = 3.0;        ///< radians a clock period: a zero up there is left out
constexpr double kHelpingPole = 2.0;    ///< -D of the pole that makes a pair of a single one
constexpr double kHelpingZero = 0.3;    ///< its D^2 against D
constexpr double kHighQuality = 1.5;    ///< above, the form whose C4 is not small
constexpr double kLeastProduct = 1e-4;  ///< of two poles in one stage, in radians a clock period
constexpr double kBig = 200.0;          ///< units to start with

/// The roots of one stage.
struct StageRoots {
  std::vector<Complex> poles;
  std::vector<Complex> zeros;
  bool second = false;
  double corner() const {
    double product = 1.0;
    for (const Complex& p : poles) product *= std::abs(p);
    return std::pow(product, 1.0 / static_cast<double>(std::max<std::size_t>(1, poles.size())));
  }
  std::size_t free_zeros() const { return (second ? 2 : 1) - zeros.size(); }
};

bool is_complex(Complex root) {
  return std::abs(root.imag()) > 1e-9 * std::abs(root);
}

/// Shares the roots out over stages.
class RootSharing {
 public:
  RootSharing(const NetworkRoots& roots, double lowest, double period) : lowest_(lowest), period_(period) {
    for (const Complex& p : roots.poles) (is_complex(p) ? complex_poles_ : real_poles_).push_back(p);
    for (const Complex& z : roots.zeros) {
      if (is_complex(z)) {
        complex_zeros_.push_back(z);
      } else if (std::abs(z) * period_ < kFarZero) {
        // Zeros that take a two-op-amp stage: right half plane, or too low for one ratio.
        const bool hard = z.real() > 0.0 || (z.real() != 0.0 && -z.real() < lowest_);
        (hard ? hard_zeros_ : real_zeros_).push_back(z.real());
      }
    }
    std::sort(real_poles_.begin(), real_poles_.end(),
              [](Complex a, Complex b) { return std::abs(a) < std::abs(b); });
  }

  std::vector<StageRoots> shared() {
    for (std::size_t i = 0; i + 1 < complex_poles_.size(); i += 2) {
      out_.push_back({{complex_poles_[i], complex_poles_[i + 1]}, {}, true});
    }
    while (!real_poles_.empty() && std::abs(real_poles_.front()) < lowest_) pair_lowest();
    while (second_order_slots() < complex_zeros_.size() / 2 && !real_poles_.empty()) pair_lowest();
    while (second_order_slots() < complex_zeros_.size() / 2 + (hard_zeros_.size() + 1) / 2 &&
           !real_poles_.empty()) {
      pair_lowest();
    }
    for (const Complex& p : real_poles_) out_.push_back({{p}, {}, false});
    for (std::size_t i = 0; i + 1 < complex_zeros_.size(); i += 2) {
      give({complex_zeros_[i], complex_zeros_[i + 1]}, true);
    }
    for (const double z : hard_zeros_) give({z}, true);
    std::sort(real_zeros_.begin(), real_zeros_.end(), [](double a, double b) { return a > b; });
    for (const double z : real_zeros_) give({z}, false);
    return possible_ ? out_ : std::vector<StageRoots>{};
  }

 private:
  std::size_t second_order_slots() const {
    return static_cast<std::size_t>(
        std::count_if(out_.begin(), out_.end(), [](const StageRoots& s) { return s.second; }));
  }

  /// The lowest real pole with the highest; alone with a pole beyond the band where that one is low as well.
  void pair_lowest() {
    StageRoots stage{{real_poles_.front()}, {}, true};
    real_poles_.erase(real_poles_.begin());
    // Both too low together: neither product nor sum would come to whole capacitors.
    const auto in_periods = [&](Complex pole) { return std::abs(pole) * period_; };
    if (!real_poles_.empty() && in_periods(stage.poles[0]) * in_periods(real_poles_.back()) > kLeastProduct) {
      stage.poles.push_back(real_poles_.back());
      real_poles_.pop_back();
    }
    out_.push_back(stage);
  }

  /// To the stage with room whose corner is nearest in ratio (zeros at 0: the lowest corner).
  void give(const std::vector<Complex>& zeros, bool second) {
    const double at = std::log(std::max(std::abs(zeros[0]), 1e-6));
    StageRoots* best = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (StageRoots& stage : out_) {
      if (stage.free_zeros() < zeros.size() || (second && !stage.second)) continue;
      const double distance = std::abs(std::log(stage.corner()) - at);
      if (distance < least) {
        least = distance;
        best = &stage;
      }
    }
    if (best == nullptr) {
      possible_ = false;
      return;
    }
    best->zeros.insert(best->zeros.end(), zeros.begin(), zeros.end());
  }

  double lowest_, period_;
  bool possible_ = true;
  std::vector<StageRoots> out_;
  std::vector<Complex> complex_poles_, complex_zeros_, real_poles_;
  std::vector<double> real_zeros_, hard_zeros_;
};

Complex delta_of(Complex root, double period) {
  return 1.0 - std::exp(-root * period);
}

Stage first_order_stage(const StageRoots& roots, double period) {
  Stage out;
  const double pole = -1.0 / delta_of(roots.poles[0], period).real();  // aCout/Cout
  double cin = 1.0;
  double acin = 0.0;
  if (!roots.zeros.empty()) {
    const double zero = roots.zeros[0].real();
    cin = zero == 0.0 ? 0.0 : 1.0;
    acin = zero == 0.0 ? 1.0 : -1.0 / delta_of(zero, period).real();
  }
  const double scale = kBig / std::max(1.0, pole);
  out.c = {cin * scale, acin * scale, scale, pole * scale};
  out.free = {1, 1, 0, 1};
  return out;
}

/// n0 + n1 D + n2 D^2.
struct Quadratic {
  double n0 = 1.0, n1 = 0.0, n2 = 0.0;
};

Quadratic numerator_of(const StageRoots& roots, double period) {
  if (roots.zeros.empty()) return {};
  const Complex a = delta_of(roots.zeros[0], period);
  if (roots.zeros.size() == 1) return a == 0.0 ? Quadratic{0.0, 1.0, 0.0} : Quadratic{-a.real(), 1.0, 0.0};
  const Complex b = delta_of(roots.zeros[1], period);
  return {(a * b).real(), -(a + b).real(), 1.0};
}

/// Nothing when a capacitor would have to be negative.
std::optional<Stage> second_order_cascade_stage(const StageRoots& roots, double period) {
  const Complex a = delta_of(roots.poles[0], period);
  const Complex b = roots.poles.size() > 1 ? delta_of(roots.poles[1], period) : Complex(-kHelpingPole);
  const double mu = (a * b).real();
  const double lambda = -(a + b).real();
  Quadratic n = numerator_of(roots, period);
  if (roots.zeros.empty()) n.n0 = mu;
  // The helping pole's lag is the fit's to take back, by a zero beside it.
  if (roots.poles.size() == 1 && roots.zeros.size() == 1) n.n2 = kHelpingZero * n.n1;
  const double quality = std::sqrt(mu) / std::max(lambda, 1e-12);
  Stage out;
  const bool high = quality > kHighQuality;
  out.kind = high ? Stage::Kind::second_high : Stage::Kind::second_low;
  const double gamma = high ? (lambda + mu) / (1.0 + lambda + mu) : 0.0;
  const double alpha = mu * (1.0 - gamma);
  for (double* v : {&n.n0, &n.n1, &n.n2}) *v *= 1.0 - gamma;
  double beta0 = n.n0;
  double beta1 = n.n1 + n.n0;
  double beta2 = high ? n.n2 + beta1 : n.n2;
  const double tiny = 1e-9 * (std::abs(n.n0) + std::abs(n.n1) + std::abs(n.n2));
  if (std::abs(beta1) < tiny) beta1 = 0.0;
  if (beta1 < 0.0 && beta2 <= 0.0) beta0 = -beta0, beta1 = -beta1, beta2 = -beta2;
  // A little of the wrong sign is what the fit can do without (lag of the numerator against 1/z).
  if (beta1 < 0.0 && -beta1 < 0.6 * std::abs(beta0)) beta1 = 0.0;
  if (beta2 < 0.0 && roots.zeros.size() < 2) beta2 = 0.0;
  if (beta1 < 0.0 || beta2 < 0.0) return std::nullopt;
  const double root = std::sqrt(alpha);
  out.c1_inverting = beta0 >= 0.0;
  const double c4 = high ? gamma / root : lambda + mu;
  const double cp = high ? beta1 / root : beta1;
  out.c = {std::abs(beta0) / root * kBig,
           cp * kBig,
           beta2 * kBig,
           root * kBig,
           root * kBig,
           c4 * kBig,
           kBig,
           kBig};
  for (double& c : out.c) {
    if (c > 0.0 && c < 1e-7 * kBig) c = 0.0;
  }
  out.free = {1, 1, 1, 1, 0, 1, 0, 0};
  return out;
}

/// Multiplies a stage's numerator.
void scale_gain(Stage& stage, double factor) {
  if (stage.kind != Stage::Kind::first) {
    for (const int i : {Stage::kC1, Stage::kCp, Stage::kCpp}) stage.c[static_cast<std::size_t>(i)] *= factor;
    return;
  }
  for (std::size_t i = 0; i < 2 * stage.from.size(); ++i) stage.c[i] *= factor;
}

/// Stage after stage, each the one that keeps the node's magnitude over the band most even; gains so that the
/// peaks of the nodes climb evenly to the peak of the output.
void order_and_scale(std::vector<Stage>& stages, const NetworkResponse& response) {
  const NetworkTarget& target = response.target();
  const std::size_t points = target.grid.size();
  std::vector<double> node(points, 0.0);  // ln
  const auto logs = [&](const Stage& stage) {
    const std::vector<Complex>& d = response.d_of(stage.divisor);
    std::vector<double> out(points);
    for (std::size_t k = 0; k < points; ++k) out[k] = std::log(std::abs(stage.response(0, d[k])) + 1e-300);
    return out;
  };
  double end = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < points; ++k) {
    if (target.weight[k] >= 1.0) end = std::max(end, std::log(std::abs(target.wanted[k]) + 1e-300));
  }
  std::vector<Stage> ordered;
  const std::size_t count = stages.size();
  while (!stages.empty()) {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    double peak = 0.0;
    for (std::size_t s = 0; s < stages.size(); ++s) {
      const std::vector<double> own = logs(stages[s]);
      double high = -1e300, low = 1e300;
      for (std::size_t k = 0; k < points; ++k) {
        if (target.weight[k] < 1.0) continue;
        high = std::max(high, node[k] + own[k]);
        low = std::min(low, std::max(node[k] + own[k], -30.0));
      }
      if (high - low < least) {
        least = high - low;
        best = s;
        peak = high;
      }
    }
    const double wanted = end * static_cast<double>(ordered.size() + 1) / static_cast<double>(count);
    const std::vector<double> own = logs(stages[best]);
    for (std::size_t k = 0; k < points; ++k) node[k] += own[k] + wanted - peak;
    scale_gain(stages[best], std::exp(wanted - peak));
    ordered.push_back(std::move(stages[best]));
    stages.erase(stages.begin() + static_cast<std::ptrdiff_t>(best));
  }
  stages = std::move(ordered);
}

Stage lead_stage() {
  Stage out;
  out.c = {100.0, 75.0, 100.0, 25.0};
  out.free = {1, 1, 0, 0};
  return out;
}

}  // namespace

NetworkRoots roots_of(const Sections& sections) {
  NetworkRoots out;
  for (const Section& section : sections.sections) {
    out.zeros.insert(out.zeros.end(), section.zeros.begin(), section.zeros.end());
    out.poles.insert(out.poles.end(), section.poles.begin(), section.poles.end());
  }
  return out;
}

double lowest_one_ratio_corner(std::int64_t divisor, const NetworkTarget& target) {
  return target.master_hz / static_cast<double>(divisor) / kOneRatio;
}

std::optional<Network> cascade_network(const NetworkRoots& roots, const NetworkResponse& response,
                                       const CascadeOptions& options) {
  const NetworkTarget& target = response.target();
  const double period = static_cast<double>(options.divisor) / target.master_hz;
  const double lowest = lowest_one_ratio_corner(options.divisor, target);
  std::vector<Stage> stages;
  for (const StageRoots& own : RootSharing(roots, lowest, period).shared()) {
    if (own.second) {
      auto stage = second_order_cascade_stage(own, period);
      if (!stage) return std::nullopt;
      stages.push_back(*std::move(stage));
    } else {
      stages.push_back(first_order_stage(own, period));
    }
    stages.back().divisor = options.divisor;
    stages.back().from = {Stage::kBoardInput};
  }
  if (stages.empty()) return std::nullopt;
  order_and_scale(stages, response);
  for (int lead = 0; lead < options.leads; ++lead) stages.push_back(lead_stage());
  Network out;
  for (std::size_t s = 0; s < stages.size(); ++s) {
    Stage& stage = stages[s];
    stage.divisor = options.divisor;
    stage.from = {s == 0 ? Stage::kBoardInput : static_cast<int>(s) - 1};
    stage.name = fmt::format(
        "{}{}", s + static_cast<std::size_t>(options.leads) >= stages.size() ? "Gain" : "Stage", s + 1);
    out.stages.push_back(std::move(stage));
  }
  return out;
}

}  // namespace bodesmith::fpaa
