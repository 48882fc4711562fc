#include "fpaa/topology_roots.hpp"

#include <algorithm>
#include <cstddef>

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

constexpr double kNearPoles = 1.15;
constexpr double kPairReach = 6.0;

}  // namespace

std::vector<ParallelPath> paths_of(std::vector<Complex> poles, bool pair_near) {
  std::vector<ParallelPath> out;
  std::sort(poles.begin(), poles.end(), [](Complex a, Complex b) {
    return std::abs(a) != std::abs(b) ? std::abs(a) < std::abs(b) : a.imag() < b.imag();
  });
  for (std::size_t i = 0; i < poles.size(); ++i) {
    const bool pair = poles[i].imag() != 0.0;
    const bool near = pair_near && !pair && i + 1 < poles.size() && poles[i + 1].imag() == 0.0 &&
                      std::abs(poles[i + 1]) < kNearPoles * std::abs(poles[i]);
    if (pair) {
      if (poles[i].imag() > 0.0) out.push_back({poles[i], std::conj(poles[i])});
    } else if (near) {
      // Two poles at the same place have no partial fractions of their own.
      out.push_back({poles[i], poles[i + 1]});
      ++i;
    } else {
      out.push_back({poles[i], std::nullopt});
    }
  }
  return out;
}

std::size_t take_lowest_zeros(std::vector<Complex>& zeros, std::size_t taken, std::size_t most) {
  for (std::size_t i = 0; i < zeros.size() && taken < most;) {
    const std::size_t size = zeros[i].imag() == 0.0 ? 1 : 2;
    if (taken + size > most) {
      i += size;
      continue;
    }
    const auto from = zeros.begin() + static_cast<std::ptrdiff_t>(i);
    zeros.erase(from, from + static_cast<std::ptrdiff_t>(size));
    taken += size;
  }
  return taken;
}

SplitRoots split_roots(const NetworkRoots& roots, RadPerSecond lowest) {
  SplitRoots out;
  // A complex pair takes more of the capacitors' range.
  for (const Complex& pole : roots.poles) {
    const double reach = (pole.imag() != 0.0 ? kPairReach : 1.0) * lowest.value;
    (std::abs(pole) < reach ? out.slow : out.fast.poles).push_back(pole);
  }
  out.fast.zeros = roots.zeros;
  std::sort(out.fast.zeros.begin(), out.fast.zeros.end(),
            [](Complex a, Complex b) { return std::abs(a) < std::abs(b); });
  out.taken = take_lowest_zeros(out.fast.zeros, 0, out.slow.size());
  return out;
}

std::optional<RadPerSecond> high_pass_pole(const NetworkRoots& roots, Band band) {
  constexpr double kClockOverBand = 20.0;
  std::optional<RadPerSecond> out;
  for (const Complex& pole : roots.poles) {
    if (pole.imag() != 0.0 || kHighPassReach * -pole.real() < kClockOverBand * band.to.value) continue;
    if (!out || -pole.real() < out->value) out = RadPerSecond{-pole.real()};
  }
  return out;
}

}  // namespace bodesmith::fpaa
