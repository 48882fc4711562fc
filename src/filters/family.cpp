#include "filters/family.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/units.hpp"

// Every family: one line here, and one file in families/ that defines the function.
namespace bodesmith::filters {

Complex Prototype::response(Complex s) const {
  Complex h = gain;
  for (std::size_t i = 0; i < poles.size(); ++i) {
    if (i < zeros.size()) h *= s - zeros[i];
    h /= s - poles[i];
  }
  return h;
}

double Prototype::attenuation_db(double w) const {
  return -to_decibel(std::abs(response({0.0, w})));
}

Prototype make_prototype(const Family& family, const PrototypeTask& task) {
  if (task.order < 1 || task.order > family.highest_order()) {
    throw InputError(fmt::format("order {} of the family {}, expected 1 to {}", task.order, family.name(),
                                 family.highest_order()));
  }
  if (family.only_even() && task.order % 2 != 0) {
    throw InputError(
        fmt::format("order {} of the family {}, expected an even one", task.order, family.name()));
  }
  // Powers of gains have to be doubles that differ from 1 and from 0.
  constexpr double kLeastDb = 1e-9, kMostDb = 1000.0;
  const auto in_range = [](double db) { return db >= kLeastDb && db <= kMostDb; };
  if (family.has_ripple() && !in_range(task.ripple_db)) {
    throw InputError(fmt::format("a ripple of {} dB, expected {} to {}", task.ripple_db, kLeastDb, kMostDb));
  }
  if (family.has_stop() && !in_range(task.stop_db)) {
    throw InputError(
        fmt::format("a stop band {} dB down, expected {} to {}", task.stop_db, kLeastDb, kMostDb));
  }
  if (family.has_ripple() && family.has_stop() && task.stop_db <= task.ripple_db) {
    throw InputError(
        fmt::format("a stop band {} dB down with a ripple of {} dB, expected more than the ripple",
                    task.stop_db, task.ripple_db));
  }
  return family.prototype(task);
}

BODESMITH_REGISTRY(Family, family_registry, "filter family", butterworth_family, chebyshev1_family,
                   chebyshev2_family, elliptic_family, bessel_family, linkwitz_riley_family, gaussian_family)

}  // namespace bodesmith::filters
