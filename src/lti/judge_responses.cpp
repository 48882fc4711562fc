#include "lti/judge_responses.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lti/frequency_grid.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

double turned_back(double rad) {
  return std::remainder(rad, 2.0 * std::numbers::pi);
}

}  // namespace

FlankedCurve::FlankedCurve(const std::vector<Hertz>& grid, const std::vector<Complex>& wanted) : h_(wanted) {
  double largest = 0.0;
  for (const Complex& h : wanted) largest = std::max(largest, std::abs(h));
  const double least = kJudgedFloor * largest;
  floor_ = std::log(least);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double size = std::abs(wanted[i]);
    judged_.push_back(size >= least);
    log_f_.push_back(std::log(grid[i].value));
    log_h_.emplace_back(std::log(std::max(size, least)), std::arg(wanted[i]));
  }
  // How far each point is from the nearest stretch where moving sideways may pay.
  reach_.assign(grid.size(), INFINITY);
  turn_.assign(grid.size(), 0.0);
  std::vector<double> left(grid.size(), INFINITY);
  std::vector<double> right(grid.size(), INFINITY);
  const auto pays = [&](std::size_t k) {  // between k - 1 and k
    const double way = kFlankRate * (log_f_[k] - log_f_[k - 1]);
    const double level = std::abs(log_h_[k].real() - log_h_[k - 1].real());
    turn_[k] = turned_back(log_h_[k].imag() - log_h_[k - 1].imag());
    has_flanks_ = has_flanks_ || level > way;
    return level > way || std::abs(turn_[k]) > way;
  };
  std::vector<bool> steep(grid.size(), false);
  for (std::size_t k = 1; k < grid.size(); ++k) {
    steep[k] = pays(k);
    left[k] = steep[k] ? 0.0 : left[k - 1] + kFlankRate * (log_f_[k] - log_f_[k - 1]);
  }
  for (std::size_t k = grid.size(); k-- > 1;)
    right[k - 1] = steep[k] ? 0.0 : right[k] + kFlankRate * (log_f_[k] - log_f_[k - 1]);
  for (std::size_t k = 0; k < grid.size(); ++k) reach_[k] = std::min(left[k], right[k]);
}

Complex FlankedCurve::difference(std::size_t k, Complex log_got) const {
  const Complex d = log_got - log_h_[k];
  return {d.real(), turned_back(d.imag())};
}

void FlankedCurve::visit(std::size_t i, int step, Complex log_got, Error& out) const {
  Complex before = difference(i, log_got);
  double way_before = 0.0;
  const std::size_t end = step > 0 ? log_f_.size() - 1 : 0;
  for (std::size_t k = i; k != end && way_before < std::max({out.neper, out.rad, out.relative});) {
    const std::size_t next = step > 0 ? k + 1 : k - 1;
    const double way = kFlankRate * std::abs(log_f_[next] - log_f_[i]);
    const double turn = step > 0 ? turn_[next] : -turn_[k];
    const Complex after{log_got.real() - log_h_[next].real(), before.imag() - turn};
    const auto at = [&](double t) { return way_before + t * (way - way_before); };
    const auto crossing = [&](double from, double to, double& least) {
      least = std::min(least, from * to < 0.0 ? at(from / (from - to)) : way + std::abs(to));
    };
    crossing(before.real(), after.real(), out.neper);
    crossing(before.imag(), after.imag(), out.rad);
    const Complex along = before - after;
    const double across = before.real() * along.real() + before.imag() * along.imag();
    const double t = across > 0.0 ? std::min(across / std::norm(along), 1.0) : 0.0;
    out.relative = std::min(out.relative, std::min(at(t) + std::sqrt(std::norm(before - t * along)),
                                                   way + std::sqrt(std::norm(after))));
    before = after;
    way_before = way;
    k = next;
  }
}

FlankedCurve::Error FlankedCurve::error(std::size_t i, Complex got) const {
  const Complex log_got(std::max(std::log(std::abs(got)), floor_), std::arg(got));
  const Complex here = difference(i, log_got);
  Error out{std::abs(here.real()), std::abs(here.imag()), std::abs(got / h_[i] - 1.0)};
  if (std::max({out.neper, out.rad, out.relative}) <= reach_[i]) return out;
  visit(i, 1, log_got, out);
  visit(i, -1, log_got, out);
  return out;
}

bool has_flanks(const std::function<Complex(Hertz)>& response, Band band) {
  constexpr int kPoints = 121;
  const std::vector<Hertz> grid = judging_grid(response, band, kPoints);
  std::vector<Complex> values;
  for (const Hertz f : grid) values.push_back(response(f));
  return FlankedCurve(grid, values).has_flanks();
}

namespace {

using Complex = std::complex<double>;

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
    const std::vector<Hertz> more = beside_peaks(at.grid, one);
    out.insert(out.end(), more.begin(), more.end());
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// `add` what stands beside the `peaks`, until there is nothing to add.
template <typename Peaks, typename Add>
void refine_at_peaks(const Peaks& peaks, const Add& add) {
  for (int round = 0; round < kPeakRounds; ++round) {
    const std::vector<Hertz> more = peaks();
    if (more.empty()) return;
    add(more);
  }
}

}  // namespace

std::vector<Hertz> beside_peaks(const std::vector<Hertz>& grid, const std::vector<double>& curve) {
  constexpr double kNear = 0.9;
  std::vector<Hertz> out;
  if (grid.size() < 2) return out;
  const double largest = *std::max_element(curve.begin(), curve.end());
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
  refine_at_peaks([&] { return beside_peaks(grid, values); },
                  [&](const std::vector<Hertz>& more) {
                    for (const Hertz f : more) {
                      const auto at = std::upper_bound(grid.begin(), grid.end(), f) - grid.begin();
                      grid.insert(grid.begin() + at, f);
                      values.insert(values.begin() + at, curve(f));
                    }
                  });
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

ResponseDifference judge_responses(const Responses& got, const Responses& wanted, Band band) {
  Sampled at;
  at.add(judging_grid([&](Hertz f) { return wanted({f}).front(); }, band, kJudgedPoints), got, wanted);
  refine_at_peaks([&] { return peaks_of(at); },
                  [&](const std::vector<Hertz>& more) { at.add(more, got, wanted); });
  return compare_responses(at.grid, at.got, at.wanted);
}

}  // namespace bodesmith
