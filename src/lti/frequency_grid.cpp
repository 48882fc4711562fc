#include "lti/frequency_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace bodesmith {

std::vector<Hertz> log_grid(Band band, int count) {
  if (!(band.from.value > 0.0) || !(band.to >= band.from) || !std::isfinite(band.to.value)) {
    throw InputError(fmt::format("the band {} to {} Hz is empty, expected 0 < from <= to", band.from.value,
                                 band.to.value));
  }
  if (count < 1 || (count == 1 && band.from != band.to)) {
    throw InputError(fmt::format("a frequency grid of {} points was asked for, expected at least 2", count));
  }
  std::vector<Hertz> out(static_cast<std::size_t>(count));
  const double low = std::log(band.from.value);
  const double high = std::log(band.to.value);
  for (int i = 0; i < count; ++i) {
    const double t = count == 1 ? 0.0 : static_cast<double>(i) / (count - 1);
    out[static_cast<std::size_t>(i)] = Hertz{std::exp(low + t * (high - low))};
  }
  out.front() = band.from;
  out.back() = band.to;
  return out;
}

namespace {

constexpr int kDeepest = 11;

struct GridPoint {
  Hertz f;
  Complex h;
};

void add_between(const std::function<Complex(Hertz)>& response, const GridPoint& a, const GridPoint& b,
                 double floor, double most_change, int depth, std::vector<Hertz>& out) {
  const double size = std::max(std::abs(a.h), std::abs(b.h));
  if (depth == 0 || !(size >= floor) || !(std::abs(b.h - a.h) > most_change * size)) return;
  const Hertz f{std::sqrt(a.f.value) * std::sqrt(b.f.value)};
  if (!(f > a.f) || !(f < b.f)) return;
  const GridPoint middle{f, response(f)};
  add_between(response, a, middle, floor, most_change, depth - 1, out);
  out.push_back(f);
  add_between(response, middle, b, floor, most_change, depth - 1, out);
}

}  // namespace

std::vector<Hertz> judging_grid(const std::function<Complex(Hertz)>& response, Band band, int count,
                                double most_change) {
  std::vector<GridPoint> even;
  double largest = 0.0;
  for (const Hertz f : log_grid(band, count)) {
    even.push_back({f, response(f)});
    largest = std::max(largest, std::abs(even.back().h));
  }
  std::vector<Hertz> out;
  for (std::size_t i = 0; i < even.size(); ++i) {
    if (i > 0)
      add_between(response, even[i - 1], even[i], kJudgedFloor * largest, most_change, kDeepest, out);
    out.push_back(even[i].f);
  }
  return out;
}

}  // namespace bodesmith
