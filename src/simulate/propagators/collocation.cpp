#include "simulate/propagators/collocation.hpp"
#include "base/whole_number.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace bodesmith::simulate {
namespace {

/// LU factors of a small matrix without pivoting: it is near 1 wherever the step is short enough to converge.
/// False when a pivot is not.
bool factorise_near_one(double (&matrix)[3][3]) {
  constexpr std::size_t p = 3;
  for (std::size_t k = 0; k < p; ++k) {
    if (!(std::abs(matrix[k][k]) > 1e-3)) return false;
    for (std::size_t i = k + 1; i < p; ++i) {
      const double f = matrix[i][k] / matrix[k][k];
      matrix[i][k] = f;
      for (std::size_t j = k + 1; j < p; ++j) matrix[i][j] -= f * matrix[k][j];
    }
  }
  return true;
}

/// A bound on the fastest rate, in rad/s, from the row sums of A²: those of A itself are 1 + 2 zeta times a resonance.
double fastest_turn(const StateSpace& system) {
  const std::size_t n = system.order();
  double most = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    double row = 0.0;
    for (std::size_t j = 0; j < n; ++j) {
      double entry = 0.0;
      for (std::size_t k = 0; k < n; ++k) entry += system.a[i * n + k] * system.a[k * n + j];
      row += std::abs(entry);
    }
    most = std::max(most, row);
  }
  return std::sqrt(most);
}

}  // namespace

void CollocationPropagator::prepare(const chain::OdeKernel& system, double h, const Limits& limits) {
  limits_ = limits;
  h_ = h;
  order_ = system.linear().order();
  levels_.resize(kFinest + 1);
  for (Level& l : levels_) l.ready = false;
  const double turn = fastest_turn(system.linear()) * h / limits.max_turn_rad;
  const double halvings = std::ceil(std::log2(std::max(std::numeric_limits<double>::min(), turn)));
  first_level_ = whole_number<std::size_t>(std::clamp(halvings, 0.0, static_cast<double>(kFinest)));
  if (parts_.empty()) {
    for (std::size_t index = 1; index <= kTabled; ++index) {
      const std::size_t count = std::size_t{1} << index;
      for (std::size_t k = 0; k < count; ++k)
        parts_.push_back(make_part(index, static_cast<double>(k) / static_cast<double>(count)));
    }
  }
  states_.assign(kWidth * order_, 0.0);
  base_.assign(states_.size(), 0.0);
  force_.assign(kWidth, 0.0);
  gradient_.assign(order_, 0.0);
}

const CollocationPropagator::Level& CollocationPropagator::level(const chain::OdeKernel& system,
                                                                 std::size_t index) {
  Level& l = levels_[index];
  if (l.ready) return l;
  const std::size_t n = order_;
  l.e.resize(kWidth * n * n);
  l.gu.resize(kWidth * n * kWidth);
  l.ge.resize(kWidth * n * kWidth);
  l.k.resize(kWidth * n);
  const std::array<const double*, 2> inputs = {system.linear().b.data(), system.entry().data()};
  const DrivenSystem dynamics = driven(system.linear(), inputs);
  for (std::size_t i = 1; i < kWidth; ++i) {
    solver_.solve(dynamics, std::ldexp(h_, -static_cast<int>(index)), nodes_, nodes_.at[i], response_);
    std::copy(response_.e.begin(), response_.e.end(), l.e.data() + i * n * n);
    std::copy(response_.g[0].begin(), response_.g[0].end(), l.gu.data() + i * n * kWidth);
    std::copy(response_.g[1].begin(), response_.g[1].end(), l.ge.data() + i * n * kWidth);
    std::copy(response_.k.begin(), response_.k.end(), l.k.data() + i * n);
  }
  l.ready = true;
  return l;
}

CollocationPropagator::Part CollocationPropagator::make_part(std::size_t index, double from) const {
  const double size = std::ldexp(1.0, -static_cast<int>(index));
  Part p;
  p.first = kWidth;
  for (std::size_t i = 0; i < kWidth; ++i) {
    nodes_.weights(from + size * nodes_.at[i], p.inward + i * kWidth);
    const double s = (nodes_.at[i] - from) / size;
    const bool mine = i == 0 ? from == 0.0 : s > 0.0 && s <= 1.0;
    if (!mine) continue;
    p.first = std::min(p.first, i);
    p.end = i + 1;
    nodes_.weights(s, p.outward + i * kWidth);
  }
  return p;
}

const CollocationPropagator::Part& CollocationPropagator::part(std::size_t index, double from,
                                                               Part& made) const {
  if (index > kTabled) return made = make_part(index, from);
  // Levels 1, 2, … have 2, 4, … parts: level `index` begins at 2^index - 2.
  const std::size_t count = std::size_t{1} << index;
  return parts_[count - 2 + static_cast<std::size_t>(from * static_cast<double>(count))];
}

bool CollocationPropagator::step(const chain::OdeKernel& system, const Level& m, const double* u,
                                 const double* x) {
  return order_ == 2 ? step_sized<2>(system, m, u, x) : step_sized<1>(system, m, u, x);
}

// One numerical kernel, kept whole: its steps share local arrays of sizes known to the compiler.
template <std::size_t Order>
bool CollocationPropagator::step_sized(const chain::OdeKernel& system, const Level& m, const double* u,
                                       const double* x) {
  constexpr std::size_t n = Order, p = kDegree, width = kWidth;
  double* state = states_.data();
  double* base = base_.data();
  double* force = force_.data();
  // What the states at the nodes are without the forces there.
  for (std::size_t a = 0; a < n; ++a) state[a] = x[a];
  force[0] = system.nonlinear(x, u[0]);
  for (std::size_t i = 1; i < width; ++i) {
    force[i] = force[0];
    for (std::size_t a = 0; a < n; ++a) {
      double sum = m.k[i * n + a];
      const double* e = m.e.data() + (i * n + a) * n;
      const double* gu = m.gu.data() + (i * n + a) * width;
      const double* ge = m.ge.data() + (i * n + a) * width;
      for (std::size_t b = 0; b < n; ++b) sum += e[b] * x[b];
      for (std::size_t j = 0; j < width; ++j) sum += gu[j] * u[j];
      sum += ge[0] * force[0];
      base[i * n + a] = sum;
    }
  }
  const auto states_from_forces = [&] {
    double size = 0.0;
    for (std::size_t i = 1; i < width; ++i) {
      for (std::size_t a = 0; a < n; ++a) {
        double sum = base[i * n + a];
        const double* ge = m.ge.data() + (i * n + a) * width;
        for (std::size_t j = 1; j < width; ++j) sum += ge[j] * force[j];
        size = std::max(size, std::abs(sum));
        state[i * n + a] = sum;
      }
    }
    return size;
  };
  if (!std::isfinite(states_from_forces())) return false;
  // Newton's method on the forces at nodes 1...p, with the slopes of n where a constant force would lead. Its
  // matrix is 1 - dn/dx dx/df, factored once a step.
  double matrix[p][p];
  double* slopes = gradient_.data();
  for (std::size_t i = 1; i < width; ++i) {
    system.nonlinear_gradient(state + i * n, u[i], slopes);
    for (std::size_t j = 1; j < width; ++j) {
      double sum = i == j ? 1.0 : 0.0;
      for (std::size_t a = 0; a < n; ++a) sum -= slopes[a] * m.ge[(i * n + a) * width + j];
      matrix[i - 1][j - 1] = sum;
    }
  }
  if (!factorise_near_one(matrix)) return false;
  double force_size = std::abs(force[0]);
  double last = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < 30; ++iteration) {
    double change[p];
    double max_change = 0.0;
    for (std::size_t i = 0; i < p; ++i) {
      const double f = system.nonlinear(state + (i + 1) * n, u[i + 1]);
      force_size = std::max(force_size, std::abs(f));
      change[i] = f - force[i + 1];
      for (std::size_t j = 0; j < i; ++j) change[i] -= matrix[i][j] * change[j];
    }
    for (std::size_t i = p; i-- > 0;) {
      for (std::size_t j = i + 1; j < p; ++j) change[i] -= matrix[i][j] * change[j];
      change[i] /= matrix[i][i];
      max_change = std::max(max_change, std::abs(change[i]));
    }
    if (!std::isfinite(max_change)) return false;
    for (std::size_t i = 0; i < p; ++i) force[i + 1] += change[i];
    states_from_forces();
    // Linear convergence at the rate seen: what is left after this change is max_change * rate.
    const double rate = last > 0.0 && std::isfinite(last) ? max_change / last : 1.0;
    const double tolerance = limits_.tolerance * force_size;
    if (max_change * std::min(rate, 1.0) <= tolerance + 1e-300) return true;
    if (iteration > 1 && rate > 0.6) return max_change <= 100.0 * tolerance;
    last = max_change;
  }
  return false;
}

void CollocationPropagator::write_outputs(const StateSpace& linear, const Part* part, const double* u,
                                          double* y) const {
  const std::size_t n = order_;
  const std::size_t first = part == nullptr ? 0 : part->first;
  const std::size_t end = part == nullptr ? kWidth : part->end;
  for (std::size_t i = first; i < end; ++i) {
    double sum = linear.offset + linear.d * u[i];
    for (std::size_t a = 0; a < n; ++a) {
      double value = 0.0;
      if (part == nullptr) {
        value = states_[i * n + a];
      } else {
        for (std::size_t j = 0; j < kWidth; ++j) value += part->outward[i * kWidth + j] * states_[j * n + a];
      }
      sum += linear.c[a] * value;
    }
    y[i] = sum;
  }
}

void CollocationPropagator::cover(const chain::OdeKernel& system, std::size_t index, double from,
                                  const double* u, double* x, double* y) {
  if (outcome_ != Outcome::finished) return;
  if (--steps_left_ < 0.0) {
    outcome_ = Outcome::too_many_parts;
    return;
  }
  const auto halves = [&] {
    cover(system, index + 1, from, u, x, y);
    cover(system, index + 1, from + std::ldexp(0.5, -static_cast<int>(index)), u, x, y);
  };
  if (index < first_level_) return halves();
  Part made;
  const Part* p = index == 0 ? nullptr : &part(index, from, made);
  double inner[kWidth];
  if (p != nullptr) {
    for (std::size_t i = 0; i < kWidth; ++i) {
      double sum = 0.0;
      for (std::size_t j = 0; j < kWidth; ++j) sum += p->inward[i * kWidth + j] * u[j];
      inner[i] = sum;
    }
  }
  const double* last_state = states_.data() + (kWidth - 1) * order_;
  if (!step(system, level(system, index), p == nullptr ? u : inner, x)) {
    if (index < kFinest) return halves();
    // The finest level's last iterate is what there is.
    if (!std::isfinite(*last_state)) {
      outcome_ = Outcome::not_finite;
      std::ranges::fill(states_, 0.0);
    }
  }
  write_outputs(system.linear(), p, u, y);
  std::copy_n(last_state, order_, x);
}

CollocationPropagator::Outcome CollocationPropagator::run(const chain::OdeKernel& system, const double* u,
                                                          double* y, std::size_t holds, double* x) {
  outcome_ = Outcome::finished;
  steps_left_ =
      limits_.max_parts * std::ldexp(1.0, static_cast<int>(first_level_)) * static_cast<double>(holds) + 1e4;
  for (std::size_t hold = 0; hold < holds; ++hold, u += kWidth, y += kWidth) {
    // A state that ran away would cost the finest steps in every hold that follows, for numbers nobody can
    // use.
    if (outcome_ == Outcome::finished) {
      cover(system, 0, 0.0, u, x, y);
    } else {
      std::fill(y, y + kWidth, 0.0);
    }
  }
  return outcome_;
}

}  // namespace bodesmith::simulate
