#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "filters/design.hpp"

namespace bodesmith::filters {
namespace {

/// |prototype frequency| of a band edge when the pass band's edges lie at 1.
double selectivity_at(const Band& pass, Hertz edge) {
  const double square = pass.from.value * pass.to.value;
  const double w = edge.value;
  return std::abs(w * w - square) / ((pass.to.value - pass.from.value) * w);
}

/// How far the stop band's nearer edge lies from the pass band's, as a ratio of prototype frequencies.
double selectivity(const Mask& mask) {
  switch (mask.kind) {
    case Kind::lowpass:
      return mask.stop.from.value / mask.pass.from.value;
    case Kind::highpass:
      return mask.pass.from.value / mask.stop.from.value;
    case Kind::bandpass:
      return std::min(selectivity_at(mask.pass, mask.stop.from), selectivity_at(mask.pass, mask.stop.to));
    case Kind::bandstop:
      return 1.0 /
             std::max(selectivity_at(mask.pass, mask.stop.from), selectivity_at(mask.pass, mask.stop.to));
  }
  return 0.0;
}

void check_mask(const Mask& mask) {
  const auto above_zero = [](double value) { return std::isfinite(value) && value > 0.0; };
  const bool band = mask.kind == Kind::bandpass || mask.kind == Kind::bandstop;
  bool fine = above_zero(mask.pass.from.value) && above_zero(mask.stop.from.value);
  if (band) {
    const Band& outer = mask.kind == Kind::bandpass ? mask.stop : mask.pass;
    const Band& inner = mask.kind == Kind::bandpass ? mask.pass : mask.stop;
    fine = fine && outer.from < inner.from && inner.from < inner.to && inner.to < outer.to;
  } else {
    fine = fine &&
           (mask.kind == Kind::lowpass ? mask.pass.from < mask.stop.from : mask.stop.from < mask.pass.from);
  }
  if (!fine) {
    throw InputError(fmt::format(
        "pass and stop band of this {} lie the wrong way round or overlap, expected every edge above 0 Hz and the {}",
        to_string(mask.kind),
        mask.kind == Kind::lowpass    ? "stop band above the pass band"
        : mask.kind == Kind::highpass ? "stop band below the pass band"
        : mask.kind == Kind::bandpass ? "pass band inside the stop edges"
                                      : "stop band inside the pass edges"));
  }
  if (!above_zero(mask.ripple_db) || !above_zero(mask.stop_db) || mask.stop_db <= mask.ripple_db) {
    throw InputError(
        fmt::format("a mask of {} dB in the pass band and {} dB in the stop band, expected both above 0 "
                    "and the second larger",
                    mask.ripple_db, mask.stop_db));
  }
}

/// The frequency at which a monotone prototype has fallen by so much.
double frequency_of_attenuation(const Prototype& prototype, double db) {
  double low = 1e-6;
  double high = 1e6;
  for (int i = 0; i < 200; ++i) {
    const double middle = std::sqrt(low * high);
    (prototype.attenuation_db(middle) < db ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

/// The edge of the pass band in the prototype's frequency.
double pass_edge(const Family& family, const Prototype& prototype, const Mask& mask) {
  if (family.corner() == Family::Corner::ripple_edge) return 1.0;
  return frequency_of_attenuation(prototype, mask.ripple_db);
}

/// Places the prototype so that the pass band's edges get the attenuation of `edge`.
Placing placing_of(const Mask& mask, double edge) {
  Placing out{mask.kind, mask.pass};
  switch (mask.kind) {
    case Kind::lowpass:
      out.corner.from.value /= edge;
      break;
    case Kind::highpass:
      out.corner.from.value *= edge;
      break;
    case Kind::bandpass:
    case Kind::bandstop: {
      // The same centre, another width: f2 - f1 = width, f1 f2 = centre^2.
      const double square = mask.pass.from.value * mask.pass.to.value;
      double width = mask.pass.to.value - mask.pass.from.value;
      width = mask.kind == Kind::bandpass ? width / edge : width * edge;
      const double from = std::sqrt(square + 0.25 * width * width) - 0.5 * width;
      out.corner = {Hertz{square / (from + width)}, Hertz{from + width}};
      break;
    }
  }
  return out;
}

}  // namespace

MaskedDesign least_order(const Family& family, const Mask& mask) {
  check_mask(mask);
  const double ratio = selectivity(mask);
  const int step = family.only_even() ? 2 : 1;
  for (int order = step; order <= family.highest_order(); order += step) {
    MaskedDesign out;
    out.order = order;
    out.prototype = make_prototype(family, {order, mask.ripple_db, mask.stop_db});
    const double edge = pass_edge(family, out.prototype, mask);
    out.ripple_db = mask.ripple_db;
    out.stop_db = out.prototype.attenuation_db(edge * ratio);
    const bool from_stop_edge = family.corner() == Family::Corner::stop_edge;
    const bool kept = from_stop_edge ? edge * ratio >= 1.0 : out.stop_db >= mask.stop_db * (1.0 - 1e-12);
    if (!kept) continue;
    out.placing = placing_of(mask, edge);
    return out;
  }
  throw DesignError(
      fmt::format("no {} filter up to order {} keeps this mask: expected a wider gap between the bands "
                  "than {:.6g} to 1, less attenuation or another family",
                  family.name(), family.highest_order(), ratio));
}

}  // namespace bodesmith::filters
