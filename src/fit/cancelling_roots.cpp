#include "fit/cancelling_roots.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

namespace bodesmith {
namespace {

double max_weighted_error_db(const RootModel::Roots& roots, const CurveTarget& target) {
  double worst = 0.0;
  for (std::size_t i = 0; i < target.frequency.size(); ++i) {
    const std::complex<double> s(0.0, target.frequency[i].value);
    double log_gain = std::log(roots.gain);
    for (const auto& z : roots.zeros) log_gain += std::log(std::abs(s - z));
    for (const auto& p : roots.poles) log_gain -= std::log(std::abs(s - p));
    worst = std::max(worst, target.weight[i] * std::abs(log_gain - target.log_gain[i]));
  }
  return kDecibelPerNeper * worst;
}

/// A real zero and a real pole, or the upper ones of two pairs, within a hundredth of each other.
bool nearly_cancel(std::complex<double> zero, std::complex<double> pole) {
  if (zero.imag() < 0.0 || pole.imag() < 0.0 || (zero.imag() == 0.0) != (pole.imag() == 0.0)) return false;
  return std::abs(zero - pole) <= 1e-2 * std::abs(pole);
}

/// Without zero z and pole p, and without their conjugates, which stand right behind them.
RootModel::Roots without(RootModel::Roots roots, std::size_t z, std::size_t p) {
  const std::ptrdiff_t count = roots.zeros[z].imag() == 0.0 ? 1 : 2;
  const auto zero = roots.zeros.begin() + static_cast<std::ptrdiff_t>(z);
  const auto pole = roots.poles.begin() + static_cast<std::ptrdiff_t>(p);
  roots.zeros.erase(zero, zero + count);
  roots.poles.erase(pole, pole + count);
  return roots;
}

/// The roots without the first cancelling ones that do not matter; nothing when there are none.
std::optional<RootModel::Roots> drop_one(const RootModel::Roots& roots, const CurveTarget& target,
                                         double allowed_db) {
  for (std::size_t z = 0; z < roots.zeros.size(); ++z) {
    for (std::size_t p = 0; p < roots.poles.size(); ++p) {
      if (!nearly_cancel(roots.zeros[z], roots.poles[p])) continue;
      RootModel::Roots fewer = without(roots, z, p);
      if (!fewer.poles.empty() && max_weighted_error_db(fewer, target) <= allowed_db) return fewer;
    }
  }
  return std::nullopt;
}

double allowed_error_db(const RootModel::Roots& roots, const CurveTarget& target, double value_db) {
  return std::max(1.001 * std::max(value_db, max_weighted_error_db(roots, target)), 1e-5);
}

/// The roots without the highest zero (or pair), its gain at low frequencies kept.
RootModel::Roots without_highest_zero(RootModel::Roots roots) {
  const auto magnitude = [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); };
  for (int count = std::max_element(roots.zeros.begin(), roots.zeros.end(), magnitude)->imag() == 0.0 ? 1 : 2;
       count > 0; --count) {
    const auto highest = std::max_element(roots.zeros.begin(), roots.zeros.end(), magnitude);
    roots.gain *= std::abs(*highest);
    roots.zeros.erase(highest);
  }
  return roots;
}

}  // namespace

int drop_distant_zeros(RootModel::Roots& roots, const CurveTarget& target, double value_db) {
  const double allowed_db = allowed_error_db(roots, target, value_db);
  const double highest = target.frequency.back().value;
  const std::size_t before = roots.zeros.size();
  while (!roots.zeros.empty()) {
    RootModel::Roots fewer = without_highest_zero(roots);
    const bool distant =
        std::any_of(roots.zeros.begin(), roots.zeros.end(), [&](auto z) { return std::abs(z) > highest; });
    if (!distant || max_weighted_error_db(fewer, target) > allowed_db) break;
    roots = std::move(fewer);
  }
  return static_cast<int>(before - roots.zeros.size());
}

int drop_cancelling(RootModel::Roots& roots, const CurveTarget& target, double value_db) {
  const double allowed_db = allowed_error_db(roots, target, value_db);
  const std::size_t before = roots.poles.size();
  while (auto fewer = drop_one(roots, target, allowed_db)) roots = std::move(*fewer);
  return static_cast<int>(before - roots.poles.size());
}

}  // namespace bodesmith
