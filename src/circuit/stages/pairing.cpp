#include "circuit/stages/pairing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bodesmith::circuit {
namespace {

using Complex = std::complex<double>;

bool all_real(const Section& section) {
  const auto real = [](Complex r) { return r.imag() == 0.0; };
  return std::all_of(section.zeros.begin(), section.zeros.end(), real) &&
         std::all_of(section.poles.begin(), section.poles.end(), real);
}

double distance(Complex zero, Complex pole) {
  // A zero at the origin is infinitely far from every pole: the lowest pole takes it.
  if (std::abs(zero) == 0.0) return 0.0;
  // A pole there takes the lowest zero: R and C in series round an op-amp.
  if (std::abs(pole) == 0.0) return 0.0;
  return std::abs(std::log(std::abs(zero) / std::abs(pole)));
}

/// zeros.size() <= poles.size(), both sorted. Pole of each zero.
std::vector<size_t> pair_sorted(const std::vector<Complex>& zeros, const std::vector<Complex>& poles) {
  struct Cost {
    double worst = std::numeric_limits<double>::infinity();
    double sum = std::numeric_limits<double>::infinity();
    bool operator<(const Cost& other) const {
      if (worst != other.worst) return worst < other.worst;
      return sum < other.sum;
    }
  };
  const size_t n = zeros.size(), m = poles.size();
  // best[i][j]: the first i zeros among the first j poles.
  std::vector<std::vector<Cost>> best(n + 1, std::vector<Cost>(m + 1));
  std::vector<std::vector<char>> taken(n + 1, std::vector<char>(m + 1, 0));
  for (size_t j = 0; j <= m; ++j) best[0][j] = {0.0, 0.0};
  for (size_t i = 1; i <= n; ++i) {
    for (size_t j = i; j <= m; ++j) {
      const double d = distance(zeros[i - 1], poles[j - 1]);
      const Cost with = {std::max(best[i - 1][j - 1].worst, d), best[i - 1][j - 1].sum + d};
      best[i][j] = with;
      taken[i][j] = 1;
      if (j > i && best[i][j - 1] < with) {
        best[i][j] = best[i][j - 1];
        taken[i][j] = 0;
      }
    }
  }
  std::vector<size_t> out(n);
  size_t j = m;
  for (size_t i = n; i > 0; --j) {
    if (taken[i][j] != 0) {
      out[i - 1] = j - 1;
      --i;
    }
  }
  return out;
}

}  // namespace

Split split_into_stages(const Sections& sections) {
  Split out;
  out.leading_gain = sections.gain;
  std::vector<Complex> zeros, poles;
  for (const Section& section : sections.sections) {
    out.leading_gain *= section.gain;
    if (all_real(section)) {
      zeros.insert(zeros.end(), section.zeros.begin(), section.zeros.end());
      poles.insert(poles.end(), section.poles.begin(), section.poles.end());
    } else {
      Section stage = section;
      stage.gain = 1.0;
      out.stages.push_back(std::move(stage));
    }
  }
  const auto rising = [](Complex a, Complex b) { return std::abs(a) < std::abs(b); };
  std::stable_sort(zeros.begin(), zeros.end(), rising);
  std::stable_sort(poles.begin(), poles.end(), rising);
  const std::vector<size_t> pole_of = pair_sorted(zeros, poles);
  std::vector<Section> pairs(poles.size());
  for (size_t i = 0; i < poles.size(); ++i) pairs[i].poles = {poles[i]};
  for (size_t i = 0; i < zeros.size(); ++i) pairs[pole_of[i]].zeros = {zeros[i]};
  out.stages.insert(out.stages.begin(), pairs.begin(), pairs.end());
  return out;
}

Split split_into_two_pole_stages(const Sections& sections) {
  Split out = split_into_stages(sections);
  std::vector<Section> joined;
  Section open;
  for (Section& stage : out.stages) {
    if (stage.poles.size() == 2) {
      joined.push_back(std::move(stage));
    } else if (open.poles.empty()) {
      open = std::move(stage);
    } else {
      open.poles.push_back(stage.poles[0]);
      open.zeros.insert(open.zeros.end(), stage.zeros.begin(), stage.zeros.end());
      joined.push_back(std::move(open));
      open = {};
    }
  }
  if (!open.poles.empty()) joined.push_back(std::move(open));
  out.stages = std::move(joined);
  return out;
}

}  // namespace bodesmith::circuit
