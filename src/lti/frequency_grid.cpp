#include "lti/frequency_grid.hpp"

#include <fmt/format.h>

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

}  // namespace bodesmith
