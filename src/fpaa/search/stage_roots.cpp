#include "fpaa/search/stage_roots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace bodesmith::fpaa {
namespace {

using Stage = DesignStage;

constexpr double kOneRatio = 230.0;   ///< largest ratio of two capacitors that is designed for
constexpr double kHelpingPole = 2.0;  ///< -D of the pole that makes a pair of a single one
constexpr double kHelpingZero = 0.3;  ///< its D^2 against D
constexpr double kHighQuality = 1.5;  ///< above, the form whose C4 is not small
constexpr double kBig = 200.0;        ///< units to start with
/// Static capacitor over switched one of a gain that the fit begins with, and by what with each stage before it: of gains that begin alike
/// nothing but rounding decides in which direction they part.
constexpr double kGainStatic = 0.5;
constexpr double kNextGain = 0.5;

bool is_complex(Complex root) {
  return std::abs(root.imag()) > 1e-9 * std::abs(root);
}

/// Shares the roots out over stages.
class RootSharing {
 public:
  RootSharing(const Sections& sections, const SharingOptions& options) : options_(options) {
    for (const Section& section : sections.sections) {
      for (const Complex& p : section.poles) (is_complex(p) ? complex_poles_ : real_poles_).push_back(p);
      for (const Complex& z : section.zeros) {
        if (is_complex(z)) {
          complex_zeros_.push_back(z);
        } else if (std::abs(z) < options.far_zero) {
          real_zeros_.push_back(std::abs(z) < options.low_zero ? 0.0 : z.real());
        }
      }
    }
    std::ranges::sort(real_poles_, [](Complex a, Complex b) { return std::abs(a) < std::abs(b); });
  }

  std::vector<StageRoots> shared() {
    for (std::size_t i = 0; i + 1 < complex_poles_.size(); i += 2) {
      out_.push_back({{complex_poles_[i], complex_poles_[i + 1]}, {}, true});
    }
    while (!real_poles_.empty() && std::abs(real_poles_.front()) < lowest() * (1.0 - kSame)) pair_lowest();
    for (std::size_t i = 0; i + 1 < complex_zeros_.size(); i += 2) {
      give_complex({complex_zeros_[i], complex_zeros_[i + 1]});
    }
    for (const Complex& p : real_poles_) out_.push_back({{p}, {}, false});
    give_real();
    if (!possible_) return {};
    for (StageRoots& stage : out_) {
      stage.subtract = std::ranges::any_of(stage.zeros, [](Complex z) { return z.real() > 0.0; });
    }
    return out_;
  }

 private:
  double lowest() const { return options_.lowest_clock_hz / kOneRatio; }

  /// The lowest real pole with the lowest that two ratios reach together with it; alone with a pole beyond the band where there is
  /// no other.
  void pair_lowest() {
    StageRoots stage{{real_poles_.front()}, {}, true};
    real_poles_.erase(real_poles_.begin());
    if (!real_poles_.empty()) {
      auto at = std::ranges::find_if(real_poles_, [&](Complex p) {
        return std::sqrt(std::abs(p * stage.poles[0])) >= lowest() * (1.0 - kSame);
      });
      if (at == real_poles_.end()) --at;
      stage.poles.push_back(*at);
      real_poles_.erase(at);
    }
    out_.push_back(stage);
  }

  /// A complex pair to the nearest of the second-order stages and of the real poles two and two.
  void give_complex(const std::vector<Complex>& zeros) {
    const double at = std::log(std::abs(zeros[0]));
    const auto distance = [&](double corner) { return std::abs(std::log(corner) - at); };
    double least = std::numeric_limits<double>::infinity();
    for (const StageRoots& stage : out_) {
      if (stage.second && stage.zeros.empty()) least = std::min(least, distance(stage.corner()));
    }
    std::size_t pair = real_poles_.size();
    for (std::size_t i = 0; i + 1 < real_poles_.size(); ++i) {
      const double apart = distance(std::sqrt(std::abs(real_poles_[i] * real_poles_[i + 1])));
      if (apart < least * (1.0 - kSame)) {
        least = apart;
        pair = i;
      }
    }
    if (pair < real_poles_.size()) {
      out_.push_back({{real_poles_[pair], real_poles_[pair + 1]}, {}, true});
      const auto from = real_poles_.begin() + static_cast<std::ptrdiff_t>(pair);
      real_poles_.erase(from, from + 2);
    }
    give(zeros, true);
  }

  /// Zeros that need a second-order stage first; of the others the lowest to the lowest pole: what runs slowly follows its input then,
  /// and only the fastest stages are without one. Or each to the nearest pole, the highest first.
  void give_real() {
    std::ranges::sort(real_zeros_, [](double a, double b) { return std::abs(a) < std::abs(b); });
    std::vector<double> easy;
    for (const double z : real_zeros_) {
      if (z != 0.0 && std::abs(z) < lowest() * (1.0 - kSame)) {
        give({z}, true);
      } else {
        easy.push_back(z);
      }
    }
    if (options_.nearest_zeros) std::ranges::reverse(easy);
    for (const double z : easy) {
      if (options_.nearest_zeros) {
        give({z}, false);
      } else {
        give_lowest(z);
      }
    }
  }

  void give_lowest(double zero) {
    StageRoots* best = nullptr;
    for (StageRoots& stage : out_) {
      if (stage.zeros.size() >= (stage.second ? 2u : 1u)) continue;
      if (best == nullptr || stage.corner() < best->corner() * (1.0 - kSame)) best = &stage;
    }
    if (best == nullptr) {
      possible_ = false;
      return;
    }
    best->zeros.emplace_back(zero);
  }

  /// To the stage with room whose corner is nearest in ratio (zeros at 0: the lowest corner).
  void give(const std::vector<Complex>& zeros, bool second) {
    const double at = std::log(std::max(std::abs(zeros[0]), 1e-6));
    StageRoots* best = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (StageRoots& stage : out_) {
      const std::size_t room = (stage.second ? 2 : 1) - stage.zeros.size();
      if (room < zeros.size() || (second && !stage.second)) continue;
      const double distance = std::abs(std::log(stage.corner()) - at);
      if (distance < least - kSame) {
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

  SharingOptions options_;
  bool possible_ = true;
  std::vector<StageRoots> out_;
  std::vector<Complex> complex_poles_, complex_zeros_, real_poles_;
  std::vector<double> real_zeros_;
};

/// 1 - 1/z of a root.
Complex delta_of(Complex root, double period) {
  return 1.0 - std::exp(-root * period);
}

/// The capacitor ratio Cx/C that puts a real root: 1/(exp(pT) - 1).
double ratio_of(double root, double period) {
  return -1.0 / delta_of(root, period).real();
}

Stage first_order_stage(const StageRoots& roots, double period) {
  Stage out;
  out.from = {Stage::kBoardInput};
  const double pole = ratio_of(roots.poles[0].real(), period);  // aCout/Cout
  double cin = 1.0;
  double acin = 0.0;
  if (!roots.zeros.empty()) {
    const double zero = roots.zeros[0].real();
    cin = zero == 0.0 ? 0.0 : 1.0;
    acin = zero == 0.0 ? 1.0 : ratio_of(zero, period);
  }
  const double scale = kBig / std::max({1.0, pole, acin});
  out.c = {cin * scale, acin * scale, scale, pole * scale};
  return out;
}

/// n0 + n1 D + n2 D^2.
struct Quadratic {
  double n0 = 1.0, n1 = 0.0, n2 = 0.0;
};

Quadratic in_delta(const std::vector<Complex>& zeros, double period) {
  if (zeros.empty()) return {};
  const Complex a = delta_of(zeros[0], period);
  if (zeros.size() == 1) return a == 0.0 ? Quadratic{0.0, 1.0, 0.0} : Quadratic{-a.real(), 1.0, 0.0};
  const Complex b = delta_of(zeros[1], period);
  return {(a * b).real(), -(a + b).real(), 1.0};
}

/// Feedback of a second-order stage and what the numerator is worth in it.
struct Resonance {
  bool high = false;
  double root = 0.0;   ///< C2/CA and C3/CB
  double gamma = 0.0;  ///< high Q: what C4 takes of D^2
  double mu = 0.0, lambda = 0.0;
};

Resonance resonance_of(const StageRoots& roots, double period) {
  const Complex a = delta_of(roots.poles[0], period);
  const Complex b = roots.poles.size() > 1 ? delta_of(roots.poles[1], period) : Complex(-kHelpingPole);
  Resonance out;
  out.mu = (a * b).real();
  out.lambda = -(a + b).real();
  out.high = std::sqrt(out.mu) / std::max(out.lambda, 1e-12) > kHighQuality * (1.0 + kSame);
  if (out.high) out.gamma = (out.lambda + out.mu) / (1.0 + out.lambda + out.mu);
  out.root = std::sqrt(out.mu * (1.0 - out.gamma));
  return out;
}

/// C1 C3, Cp and Cpp over CA CB (numerator beta0/z + beta1 D [/z at high Q] + beta2 D^2).
std::optional<Stage> second_order_stage(const Resonance& own, double beta0, double beta1, double beta2) {
  const double tiny = 1e-9 * (std::abs(beta0) + std::abs(beta1) + std::abs(beta2));
  if (std::abs(beta1) < tiny) beta1 = 0.0;
  if (beta1 < 0.0 || beta2 < 0.0) return std::nullopt;
  Stage out;
  out.kind = own.high ? Stage::Kind::second_high : Stage::Kind::second_low;
  out.from = {Stage::kBoardInput};
  out.c1_inverting = beta0 >= 0.0;
  const double c4 = own.high ? own.gamma / own.root : own.lambda + own.mu;
  const double cp = own.high ? beta1 / own.root : beta1;
  out.c = {std::abs(beta0) / own.root * kBig,
           cp * kBig,
           beta2 * kBig,
           own.root * kBig,
           own.root * kBig,
           c4 * kBig,
           kBig,
           kBig};
  for (double& c : out.c) {
    if (c > 0.0 && c < 1e-7 * kBig) c = 0.0;
  }
  return out;
}

/// The vendor's low, band and high pass where the zeros allow, else all three inputs.
std::optional<Stage> second_order_stage(const StageRoots& roots, double period) {
  const Resonance own = resonance_of(roots, period);
  const double left = 1.0 - own.gamma;
  const auto at_zero = static_cast<std::size_t>(std::ranges::count(roots.zeros, Complex(0.0)));
  if (roots.poles.size() == 2 && at_zero == roots.zeros.size()) {
    if (at_zero == 0) return second_order_stage(own, own.mu * left, 0.0, 0.0);
    if (at_zero == 1) return second_order_stage(own, 0.0, (own.lambda + own.mu) * left, 0.0);
    return second_order_stage(own, 0.0, 0.0, left);
  }
  Quadratic n = in_delta(roots.zeros, period);
  if (roots.zeros.empty()) n.n0 = own.mu;
  // The helping pole's lag is the fit's to take back, by a zero next to it.
  if (roots.poles.size() == 1 && roots.zeros.size() == 1) n.n2 = kHelpingZero * n.n1;
  for (double* v : {&n.n0, &n.n1, &n.n2}) *v *= left;
  double beta0 = n.n0;
  double beta1 = n.n1 + n.n0;
  double beta2 = own.high ? n.n2 + beta1 : n.n2;
  if (beta1 < 0.0 && beta2 <= 0.0) beta0 = -beta0, beta1 = -beta1, beta2 = -beta2;
  // A little of the wrong sign is what the fit can do without (lag of the numerator against 1/z).
  if (beta1 < 0.0 && -beta1 < 0.6 * std::abs(beta0)) beta1 = 0.0;
  return second_order_stage(own, beta0, beta1, beta2);
}

/// x - stage(x), every path inverted once more: the sum's input 1 is the stage, input 2 the stage's own input.
Stage difference_stage() {
  Stage out;
  out.from = {0, Stage::kBoardInput};
  const double cout = 0.5 * kBig;
  out.c = {cout, 0.5 * cout, cout, 0.5 * cout, cout, 0.5 * cout};
  return out;
}

/// prod(s - z)/prod(s - p) = 1 - stage: the stage is -(beta s + gamma)/prod(s - p).
std::vector<Stage> difference_stages(const StageRoots& roots, double period) {
  if (!roots.second) {
    // (s - z)/(s + p) = 1 - (z + p)/(s + p); without a zero there is nothing to subtract.
    const double z = roots.zeros[0].real();
    const double p = -roots.poles[0].real();
    Stage low = first_order_stage({{roots.poles[0]}, {}, false}, period);
    low.c[0] *= (z + p) / p;
    return {low, difference_stage()};
  }
  const Resonance own = resonance_of(roots, period);
  const double d1 = -(roots.poles[0] + roots.poles[1]).real();
  const double d0 = (roots.poles[0] * roots.poles[1]).real();
  if (roots.zeros.size() != 2) return {};  // falls towards high frequencies: nothing constant to take it from
  const double beta = d1 + (roots.zeros[0] + roots.zeros[1]).real();  // of D/T, against d1
  const double gamma = d0 - (roots.zeros[0] * roots.zeros[1]).real();
  if (!(beta > 0.0)) return {};
  const double left = 1.0 - own.gamma;
  auto stage =
      second_order_stage(own, own.mu * left * gamma / d0, (own.lambda + own.mu) * left * beta / d1, 0.0);
  if (!stage) return {};
  return {*std::move(stage), difference_stage()};
}

}  // namespace

double StageRoots::corner() const {
  double product = 1.0;
  for (const Complex& p : poles) product *= std::abs(p);
  return std::pow(product, 1.0 / static_cast<double>(std::max<std::size_t>(1, poles.size())));
}

double StageRoots::width() const {
  if (second || subtract || zeros.size() != 1 || poles.size() != 1 || zeros[0] == 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  return snapped(std::abs(std::log(std::abs(zeros[0] / poles[0]))));
}

double StageRoots::magnitude(RadPerSecond w) const {
  const Complex s(0.0, w.value);
  double out = 1.0;
  for (const Complex& z : zeros) out *= std::abs(s - z);
  for (const Complex& p : poles) out /= std::abs(s - p);
  return out;
}

double StageRoots::highest_clock_hz() const {
  double lowest = std::numeric_limits<double>::infinity();
  if (second && poles.size() == 2) {
    const double sum = -(poles[0] + poles[1]).real();
    const double quality = corner() / sum;
    lowest = std::min(corner(), quality > kHighQuality * (1.0 + kSame) ? corner() : sum);
    if (!is_complex(poles[0])) lowest = corner();
  } else if (second) {
    lowest = kOneRatio * std::abs(poles[0]);
  } else {
    for (const auto* roots : {&poles, &zeros}) {
      for (const Complex& root : *roots) {
        if (root != 0.0 && !subtract) lowest = std::min(lowest, std::abs(root));
        if (root.real() < 0.0 && subtract) lowest = std::min(lowest, std::abs(root));
      }
    }
  }
  return lowest * kOneRatio;
}

namespace {

bool join_lowest_and_highest(std::vector<StageRoots>& stages) {
  std::optional<std::size_t> lowest, highest;
  for (std::size_t s = 0; s < stages.size(); ++s) {
    if (stages[s].second || stages[s].subtract || stages[s].poles.empty()) continue;
    const double corner = snapped(stages[s].corner());
    if (!lowest || corner < snapped(stages[*lowest].corner())) lowest = s;
    if (!highest || corner > snapped(stages[*highest].corner())) highest = s;
  }
  if (!lowest || *lowest == *highest) return false;
  StageRoots& joined = stages[*lowest];
  const StageRoots& other = stages[*highest];
  joined.second = true;
  joined.poles.push_back(other.poles[0]);
  joined.zeros.insert(joined.zeros.end(), other.zeros.begin(), other.zeros.end());
  stages.erase(stages.begin() + static_cast<std::ptrdiff_t>(*highest));
  return true;
}

}  // namespace

std::vector<StageRoots> shared_roots(const Sections& sections, const SharingOptions& options) {
  std::vector<StageRoots> out = RootSharing(sections, options).shared();
  for (std::size_t n = 0; n < options.left_out; ++n) {
    const auto closest = std::ranges::min_element(
        out, [](const StageRoots& a, const StageRoots& b) { return a.width() < b.width(); });
    if (out.size() < 2 || !std::isfinite(closest->width())) return {};
    out.erase(closest);
  }
  for (std::size_t n = 0; n < options.joined; ++n) {
    if (!join_lowest_and_highest(out)) return {};
  }
  return out;
}

Stage gain_stage(std::size_t before) {
  Stage out;
  out.from = {Stage::kBoardInput};
  const double switched = 0.5 * kBig;
  const double fixed = switched * kGainStatic * std::pow(kNextGain, static_cast<double>(before));
  out.c = {switched, fixed, switched, fixed};
  return out;
}

std::vector<Stage> initial_stages(const StageRoots& roots, double clock_hz) {
  const double period = 1.0 / clock_hz;
  if (roots.subtract) return difference_stages(roots, period);
  if (!roots.second) return {first_order_stage(roots, period)};
  auto stage = second_order_stage(roots, period);
  if (!stage) return {};
  return {*std::move(stage)};
}

}  // namespace bodesmith::fpaa
