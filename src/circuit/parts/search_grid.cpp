#include "circuit/parts/search_grid.hpp"

#include <algorithm>
#include <cmath>

#include "lti/judged_floor.hpp"
#include "lti/judging_grid.hpp"
#include "lti/steep_flanks.hpp"

namespace bodesmith::circuit {
namespace {

/// |d ln H / d ln f|, each root's share by itself.
double slope(const Sections& wanted, Hertz f) {
  const std::complex<double> s(0.0, f.rad_s().value);
  std::complex<double> out = 0.0;
  for (const Section& section : wanted.sections) {
    for (const std::complex<double>& zero : section.zeros) out += s / (s - zero);
    for (const std::complex<double>& pole : section.poles) out -= s / (s - pole);
  }
  return std::abs(out);
}

}  // namespace

SearchGrid::SearchGrid(const Sections& wanted, Band band, int count) {
  /// Between points of a flank; parts are told apart by less than it takes to state an error.
  constexpr double kMostChange = 0.5;
  const auto response = [&](Hertz f) { return wanted.response(f.rad_s()); };
  const std::vector<Hertz> grid =
      has_flanks(response, band) ? judging_grid(response, band, count, kMostChange) : log_grid(band, count);
  double largest = 0.0;
  for (const Hertz f : grid) largest = std::max(largest, std::abs(response(f)));
  for (const Hertz f : grid) {
    if (!(std::abs(response(f)) >= kJudgedFloor * largest)) continue;
    at.push_back(f);
    weight.push_back(std::min(1.0, kFlankRate / slope(wanted, f)));
  }
}

}  // namespace bodesmith::circuit
