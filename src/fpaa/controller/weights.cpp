#include "fpaa/controller/branches.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "base/whole_number.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

/// Units of each input over units of Cout.
struct WeightUnits {
  std::vector<int> in;
  int out = 1;
};

double weighed_error(const std::vector<double>& off, const std::vector<double>& products) {
  const std::size_t n = off.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const double product = products.empty() ? (i == j ? 1.0 : 0.0) : products[i * n + j];
      sum += off[i] * off[j] * product;
    }
  }
  return sum;
}

/// The best units over one Cout: of each input the whole number below or above, all combinations.
double best_over(const std::vector<double>& gains, const std::vector<double>& products, int cout,
                 std::vector<int>& best) {
  const std::size_t n = gains.size();
  double min_error = std::numeric_limits<double>::infinity();
  for (std::size_t choice = 0; choice < (std::size_t{1} << n); ++choice) {
    std::vector<int> units(n);
    std::vector<double> off(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double wanted = std::abs(gains[i]) * cout;
      const double whole = std::floor(wanted) + static_cast<double>((choice >> i) & 1U);
      units[i] = gains[i] == 0.0 ? 0 : whole_number<int>(whole, 1, kMostUnits);
      off[i] = std::copysign(units[i] / static_cast<double>(cout), gains[i]) - gains[i];
    }
    const double error = weighed_error(off, products);
    if (error < min_error) {
      min_error = error;
      best = units;
    }
  }
  return min_error;
}

WeightUnits best_units(const std::vector<double>& gains, const std::vector<double>& products) {
  WeightUnits out;
  double min_error = std::numeric_limits<double>::infinity();
  // From the largest: among equals the capacitors whose mismatch is the least.
  for (int cout = kMostUnits; cout >= 1; --cout) {
    std::vector<int> units;
    const double error = best_over(gains, products, cout, units);
    if (error < min_error) {
      min_error = error;
      out = {units, cout};
    }
  }
  return out;
}

/// Capacitors, transfer and late inputs from the units.
void take_units(ControllerCam& cam, const std::vector<double>& gains, const WeightUnits& units) {
  const bool single = cam.cam == &gain_hold_cam();
  cam.capacitors.clear();
  cam.requested = {};
  cam.realised = {};
  cam.late.assign(gains.size(), false);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    const double realised = std::copysign(static_cast<double>(units.in[i]), gains[i]) / units.out;
    const std::string key = single ? "gain" : fmt::format("gain_{}", i + 1);
    cam.requested.set(key, single ? -gains[i] : gains[i]);
    cam.realised.set(key, single ? -realised : realised);
    cam.capacitors.push_back({single ? "Cin" : fmt::format("Cin{}", i + 1), units.in[i]});
    if (!single) cam.late[i] = gains[i] > 0.0;
  }
  cam.capacitors.push_back({"Cout", units.out});
  cam.z.numerators.resize(gains.size());
  cam.find_z();
  if (single) cam.capacitors.push_back({"Chold", kHoldUnits});
}

}  // namespace

void set_weights(ControllerCam& cam, double rate_gain) {
  std::vector<double> gains = cam.weights;
  for (double& g : gains) g *= rate_gain;
  take_units(cam, gains, best_units(gains, cam.products));
}

void set_weights_first_exact(ControllerCam& cam) {
  WeightUnits best;
  double min_error = std::numeric_limits<double>::infinity();
  for (int cout = kMostUnits; cout >= 1; --cout) {
    std::vector<double> rest = cam.weights;
    rest[0] = 0.0;
    std::vector<int> units;
    const double error = best_over(rest, {}, cout, units);
    if (error >= min_error) continue;
    min_error = error;
    units[0] = cout;
    best = {units, cout};
  }
  take_units(cam, cam.weights, best);
}

}  // namespace bodesmith::fpaa
