#include "tolerance/judge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lti/judging_grid.hpp"

namespace bodesmith::yield {
namespace {

std::vector<Hertz> with_judged(const Design& design, const std::vector<Hertz>& grid) {
  std::vector<Hertz> out = grid;
  if (grid.size() < 2) return out;
  constexpr double kBeyond = 1.1;  // the first or last points may be left out ones
  // Between points the curve is taken as straight, which is out by an eighth of the square of the change: a fortieth here
  // stays below a thousandth of a decibel, as near as judge_responses() comes.
  constexpr double kChange = 0.025;
  const std::vector<Hertz> judged =
      judging_grid(design.wanted, {Hertz{grid.front().value / kBeyond}, Hertz{grid.back().value * kBeyond}},
                   kJudgedPoints, kChange);
  out.insert(out.end(), judged.begin(), judged.end());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::vector<std::complex<double>> wanted_at(const Design& design, const std::vector<Hertz>& grid) {
  std::vector<std::complex<double>> out;
  for (const Hertz f : grid) out.push_back(design.wanted(f));
  return out;
}

}  // namespace

Judge::Judge(const Design& design, const std::vector<Hertz>& grid)
    : Judge(design, grid, with_judged(design, grid)) {}

Judge::Judge(const Design& design, const std::vector<Hertz>& grid, const std::vector<Hertz>& dense)
    : wanted_(wanted_at(design, dense)), curve_(dense, wanted_) {
  for (const Hertz f : grid)
    place_.push_back(
        static_cast<std::size_t>(std::lower_bound(dense.begin(), dense.end(), f) - dense.begin()));
}

Judge::Worst Judge::operator()(std::size_t i, double db, double deg, const Worst& least) const {
  // |r e^{ja} - 1|^2 = (r - 1)^2 + 4 r sin^2(a/2)
  const double r = std::exp(db / kDecibelPerNeper), half = std::sin(deg * std::numbers::pi / 360.0);
  const Worst out{std::abs(db), std::abs(deg),
                  100.0 * std::sqrt((r - 1.0) * (r - 1.0) + 4.0 * r * half * half)};
  if (out.db <= least.db && out.deg <= least.deg && out.percent <= least.percent) return out;
  const double most = std::max({out.db / kDecibelPerNeper, out.deg / to_degrees(1.0), out.percent / 100.0});
  const std::size_t at = place_[i];
  if (most <= curve_.as_it_is_below(at)) return out;
  const FlankedCurve::Error error = curve_.error(at, wanted_[at] * std::polar(r, deg / to_degrees(1.0)));
  return {kDecibelPerNeper * error.neper, to_degrees(error.rad), 100.0 * error.relative};
}

}  // namespace bodesmith::yield
