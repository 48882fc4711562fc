#include "lti/judge_responses.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith {
namespace {

/// Both responses at more frequencies.
struct Sampled {
  std::vector<Hertz> grid;
  std::vector<Complex> got;
  std::vector<Complex> wanted;

  void add(const std::vector<Hertz>& more, const Responses& got_at, const Responses& wanted_at) {
    const std::vector<Complex> got_there = got_at(more);
    const std::vector<Complex> wanted_there = wanted_at(more);
    Sampled merged;
    std::size_t old = 0;
    for (std::size_t i = 0; i <= more.size(); ++i) {
      for (; old < grid.size() && (i == more.size() || grid[old] < more[i]); ++old)
        merged.push(grid[old], got[old], wanted[old]);
      if (i < more.size()) merged.push(more[i], got_there[i], wanted_there[i]);
    }
    *this = std::move(merged);
  }

 private:
  void push(Hertz f, Complex g, Complex w) {
    grid.push_back(f);
    got.push_back(g);
    wanted.push_back(w);
  }
};

std::vector<Hertz> peaks_of(const Sampled& at) {
  const FlankedCurve curve(at.grid, at.wanted);
  std::vector<double> level(at.grid.size()), angle(at.grid.size()), relative(at.grid.size());
  for (std::size_t i = 0; i < at.grid.size(); ++i) {
    if (!curve.is_judged(i)) continue;
    const FlankedCurve::Error error = curve.error(i, at.got[i]);
    level[i] = error.neper;
    angle[i] = error.rad;
    relative[i] = error.relative;
  }
  std::vector<Hertz> out;
  for (const std::vector<double>& one : {level, angle, relative}) {
    const std::vector<Hertz> more = around_peaks(at.grid, one);
    out.insert(out.end(), more.begin(), more.end());
  }
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// `add` what stands near the `peaks`, until there is nothing to add.
template <typename Peaks, typename Add>
void refine_at_peaks(const Peaks& peaks, const Add& add) {
  for (int round = 0; round < kPeakRounds; ++round) {
    const std::vector<Hertz> more = peaks();
    if (more.empty()) return;
    add(more);
  }
}

Sampled judged(const Responses& got, const Responses& wanted, Band band) {
  Sampled at;
  at.add(judging_grid([&](Hertz f) { return wanted({f}).front(); }, band, kJudgedPoints), got, wanted);
  refine_at_peaks([&] { return peaks_of(at); },
                  [&](const std::vector<Hertz>& more) { at.add(more, got, wanted); });
  return at;
}

}  // namespace

Responses at_each(std::function<Complex(RadPerSecond)> response) {
  return [response = std::move(response)](const std::vector<Hertz>& grid) {
    std::vector<Complex> out;
    for (const Hertz f : grid) out.push_back(response(f.rad_s()));
    return out;
  };
}

std::vector<Hertz> around_peaks(const std::vector<Hertz>& grid, const std::vector<double>& curve) {
  constexpr double kNear = 0.9;
  std::vector<Hertz> out;
  if (grid.size() < 2) return out;
  const double largest = *std::ranges::max_element(curve);
  const auto between = [&](std::size_t a, std::size_t b) {
    const Hertz f{std::sqrt(grid[a].value) * std::sqrt(grid[b].value)};
    if (grid[a] < f && f < grid[b] && (out.empty() || out.back() < f)) out.push_back(f);
  };
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!(curve[i] >= kNear * largest) || !(largest > 0.0)) continue;
    if ((i > 0 && curve[i - 1] > curve[i]) || (i + 1 < grid.size() && curve[i + 1] > curve[i])) continue;
    if (i > 0) between(i - 1, i);
    if (i + 1 < grid.size()) between(i, i + 1);
  }
  return out;
}

double refined_maximum(std::vector<Hertz> grid, const std::function<double(Hertz)>& curve) {
  std::vector<double> values;
  for (const Hertz f : grid) values.push_back(curve(f));
  refine_at_peaks([&] { return around_peaks(grid, values); },
                  [&](const std::vector<Hertz>& more) {
                    for (const Hertz f : more) {
                      const auto at = std::upper_bound(grid.begin(), grid.end(), f) - grid.begin();
                      grid.insert(grid.begin() + at, f);
                      values.insert(values.begin() + at, curve(f));
                    }
                  });
  return values.empty() ? 0.0 : *std::ranges::max_element(values);
}

std::vector<Hertz> judged_frequencies(const Responses& got, const Responses& wanted, Band band) {
  return judged(got, wanted, band).grid;
}

ResponseDifference judge_responses(const Responses& got, const Responses& wanted, Band band) {
  const Sampled at = judged(got, wanted, band);
  return compare_responses(at.grid, at.got, at.wanted);
}

}  // namespace bodesmith
