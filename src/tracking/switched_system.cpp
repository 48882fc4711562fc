#include "tracking/switched_system.hpp"

namespace bodesmith::tracking {
namespace {

/// Rates into dx; returns the output.
double pass_through(const StateSpace& system, double u, const double* x, double* dx) {
  derivative(system, u, x, dx);
  return output(system, u, x);
}

}  // namespace

SwitchedSystem::SwitchedSystem(StateSpace ascending, StateSpace descending, StateSpace drive, StateSpace path)
    : ascending_(std::move(ascending)),
      descending_(std::move(descending)),
      drive_(std::move(drive)),
      path_(std::move(path)) {}

SwitchedSystem::Outputs SwitchedSystem::evaluate(const Inputs& in, const double* x, double* dx) const {
  const std::size_t second = ascending_.order();
  const std::size_t third = second + descending_.order();
  const double up = pass_through(ascending_, in.ascending, x, dx);
  const double down = pass_through(descending_, in.descending, x + second, dx + second);
  const double c = (open_[0] ? up : 0.0) + (open_[1] ? down : 0.0);
  const double v = pass_through(drive_, in.x - c, x + third, dx + third);
  return {v, pass_through(path_, v + in.stage, x + front(), dx + front())};
}

double SwitchedSystem::drive_slope(const Inputs& slopes, const double* dx) const {
  const std::size_t second = ascending_.order();
  const double c = (open_[0] ? output_slope(ascending_, slopes.ascending, dx) : 0.0) +
                   (open_[1] ? output_slope(descending_, slopes.descending, dx + second) : 0.0);
  return output_slope(drive_, slopes.x - c, dx + second + descending_.order());
}

SwitchedSystem::Matrices SwitchedSystem::matrices() const {
  // From the system itself, which is linear: one unit after the other.
  const std::size_t n = order();
  Matrices out;
  out.a.assign(n * n, 0.0);
  std::vector<double> x(n, 0.0);
  std::vector<double> column(n);
  for (std::size_t j = 0; j < n; ++j) {
    x[j] = 1.0;
    evaluate({}, x.data(), column.data());
    for (std::size_t i = 0; i < n; ++i) out.a[i * n + j] = column[i];
    x[j] = 0.0;
  }
  const std::array<Inputs, kInputs> units = {Inputs{1, 0, 0, 0}, Inputs{0, 1, 0, 0}, Inputs{0, 0, 1, 0},
                                             Inputs{0, 0, 0, 1}};
  for (std::size_t q = 0; q < kInputs; ++q) {
    out.b[q].resize(n);
    evaluate(units[q], x.data(), out.b[q].data());
  }
  return out;
}

}  // namespace bodesmith::tracking
