#include "fpaa/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/whole_number.hpp"
#include "numeric/log_ratio.hpp"

namespace bodesmith::fpaa {
namespace {

/// Corners farther off than this (nepers) are not considered even when the gain asks for them.
constexpr double kMaxCornerError = 1.0;
/// How many C1 on either side of the nearest are looked at: this over C0, between the two limits. (A coarse
/// branch, which few multiples reach, needs its farther neighbours more than a fine one does.)
constexpr double kReachTimesC0 = 12.0;
constexpr int kMinReach = 1;
constexpr int kMaxReach = 6;

/// A pair of capacitors and how far its corner is off, in nepers.
struct NearRatio {
  double off;
  BranchValue value;
};

}  // namespace

CandidateLists::CandidateLists(const ChainProblem& problem, std::size_t count) : problem_(problem) {
  for (const RadPerSecond w : problem.grid) {
    one_minus_z_.push_back(1.0 - std::polar(1.0, -w.value / problem.clock.value));
  }
  for (const Branch& branch : problem.branches) {
    std::vector<std::complex<double>> target;
    for (const RadPerSecond w : problem.grid) target.push_back(branch.imitated(w));
    std::vector<Candidate> list;
    for (const BranchValue& value : values_of(branch, count)) {
      list.push_back(evaluate(branch, value, target));
    }
    lists_.push_back(std::move(list));
  }
  finest_first_.resize(lists_.size());
  std::iota(finest_first_.begin(), finest_first_.end(), std::size_t{0});
  std::stable_sort(finest_first_.begin(), finest_first_.end(), [&](std::size_t a, std::size_t b) {
    return multiples(problem.branches[a]) > multiples(problem.branches[b]);
  });
}

std::vector<std::size_t> CandidateLists::unreachable() const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < lists_.size(); ++i) {
    if (lists_[i].empty()) out.push_back(i);
  }
  return out;
}

std::vector<BranchValue> CandidateLists::values_of(const Branch& branch, std::size_t count) const {
  std::vector<BranchValue> out;
  switch (branch.kind) {
    case Branch::Kind::constant:
      for (int c = 1; c <= problem_.max_capacitor; ++c) out.push_back({c, 0});
      break;
    case Branch::Kind::differentiating:
      for (int c = 1; c <= problem_.max_capacitor; ++c) out.push_back({0, c});
      break;
    case Branch::Kind::corner:
      if (is_reachable(branch, problem_.clock, problem_.max_capacitor)) out = near_ratio(branch, count);
      break;
  }
  return out;
}

/// The capacitor pairs whose ratio is nearest to the corner's, counted by ratio.
std::vector<BranchValue> CandidateLists::near_ratio(const Branch& branch, std::size_t count) const {
  const int max = problem_.max_capacitor;
  const double ratio = branch_ratio(branch.corner.hz(), problem_.clock);
  // The frequency goes as 1/(1 + 2 C1/C0).
  const double wanted = 1.0 + 2.0 * ratio;
  const auto off = [&](int c0, int c1) {
    return std::abs(std::log((1.0 + 2.0 * c1 / static_cast<double>(c0)) / wanted));
  };
  std::vector<NearRatio> near;
  for (int c0 = 1; c0 <= max; ++c0) {
    // Beyond the largest capacitor the corner strays: still worth having where the gain needs that C0.
    const int middle = nearest_whole<int>(std::clamp(ratio * c0, 1.0, static_cast<double>(max)));
    if (ratio * c0 > max && off(c0, middle) > kMaxCornerError) break;
    const int reach = std::clamp(whole_number<int>(kReachTimesC0 / c0), kMinReach, kMaxReach);
    for (int c1 = std::max(1, middle - reach); c1 <= std::min(max, middle + reach); ++c1) {
      near.push_back({off(c0, c1), {c0, c1}});
    }
  }
  const auto nearer = [](const NearRatio& a, const NearRatio& b) {
    if (a.off != b.off) return a.off < b.off;
    return a.value.c0 < b.value.c0;
  };
  const std::size_t keep = std::min(near.size(), count);
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(keep), near.end(), nearer);
  std::vector<BranchValue> out;
  for (std::size_t i = 0; i < keep; ++i) out.push_back(near[i].value);
  std::sort(out.begin(), out.end(), [](const BranchValue& a, const BranchValue& b) {
    const int left = a.c1 * b.c0;
    const int right = b.c1 * a.c0;
    return left != right ? left < right : a.c0 < b.c0;
  });
  return out;
}

Candidate CandidateLists::evaluate(const Branch& branch, const BranchValue& value,
                                   const std::vector<std::complex<double>>& target) const {
  Candidate c;
  c.value = value;
  const double sign = branch.above ? 1.0 : -1.0;
  for (std::size_t k = 0; k < points(); ++k) {
    const std::complex<double> got =
        static_cast<double>(value.c0) + static_cast<double>(value.c1) * one_minus_z_[k];
    const std::complex<double> u = sign * log_ratio(got, target[k]);
    c.re.push_back(u.real());
    c.im.push_back(u.imag());
  }
  c.log_gain =
      sign * (branch.kind == Branch::Kind::differentiating ? std::log(value.c1 / problem_.clock.value)
                                                           : std::log(static_cast<double>(value.c0)));
  return c;
}

/// How many multiples of its smallest capacitors reach a branch's corner: how finely it can be set.
double CandidateLists::multiples(const Branch& branch) const {
  if (branch.kind != Branch::Kind::corner) return std::numeric_limits<double>::infinity();
  const double ratio = branch_ratio(branch.corner.hz(), problem_.clock);
  return problem_.max_capacitor / std::max({ratio, 1.0 / ratio, 1.0});
}

std::size_t CandidateLists::nearest_by_gain(std::size_t branch, double missing) const {
  const std::vector<Candidate>& list = lists_[branch];
  std::size_t best = 0;
  for (std::size_t c = 1; c < list.size(); ++c) {
    if (std::abs(missing + list[c].log_gain) < std::abs(missing + list[best].log_gain)) best = c;
  }
  return best;
}

}  // namespace bodesmith::fpaa
