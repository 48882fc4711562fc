#include "simulate/ode_propagator.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::simulate {

void OdePropagator::prepare(const chain::OdeKernel& system, double h, const HoldNodes& nodes) {
  h_ = h;
  order_ = static_cast<int>(system.linear().order());
  degree_ = nodes.degree;
  nodes_ = &nodes;
  levels_.resize(kFinest + 1);
  for (Level& l : levels_) l.ready = false;
  const double norm = max_row_sum(system.linear());
  first_level_ =
      std::clamp(static_cast<int>(std::ceil(std::log2(std::max(1e-300, norm * h / turn)))), 0, kFinest);
  if (parts_degree_ != degree_) {
    parts_degree_ = degree_;
    parts_.clear();
    for (int index = 1; index <= kTabled; ++index) {
      for (int k = 0; k < (1 << index); ++k) parts_.push_back(make_part(index, std::ldexp(k, -index)));
    }
  }
  states_.assign(static_cast<size_t>((degree_ + 1) * order_), 0.0);
  base_.assign(states_.size(), 0.0);
  force_.assign(static_cast<size_t>(degree_ + 1), 0.0);
  gradient_.assign(static_cast<size_t>(order_), 0.0);
  failures_ = 0;
}

const OdePropagator::Level& OdePropagator::level(const chain::OdeKernel& system, int index) {
  Level& l = levels_[static_cast<size_t>(index)];
  if (l.ready) return l;
  const auto n = static_cast<size_t>(order_);
  const auto width = static_cast<size_t>(degree_ + 1);
  l.e.resize(width * n * n);
  l.gu.resize(width * n * width);
  l.ge.resize(width * n * width);
  l.k.resize(width * n);
  const std::vector<const double*> inputs = {system.linear().b.data(), system.entry().data()};
  for (size_t i = 1; i < width; ++i) {
    solver_.solve(system.linear(), inputs, std::ldexp(h_, -index), *nodes_, nodes_->at[i], response_);
    std::copy(response_.e.begin(), response_.e.end(), l.e.begin() + static_cast<std::ptrdiff_t>(i * n * n));
    std::copy(response_.g[0].begin(), response_.g[0].end(),
              l.gu.begin() + static_cast<std::ptrdiff_t>(i * n * width));
    std::copy(response_.g[1].begin(), response_.g[1].end(),
              l.ge.begin() + static_cast<std::ptrdiff_t>(i * n * width));
    std::copy(response_.k.begin(), response_.k.end(), l.k.begin() + static_cast<std::ptrdiff_t>(i * n));
  }
  l.ready = true;
  return l;
}

OdePropagator::Part OdePropagator::make_part(int index, double from) const {
  const int width = degree_ + 1;
  const double size = std::ldexp(1.0, -index);
  Part p;
  p.first = width;
  for (int i = 0; i < width; ++i) {
    nodes_->weights(from + size * nodes_->at[static_cast<size_t>(i)], p.inward + i * width);
    const double s = (nodes_->at[static_cast<size_t>(i)] - from) / size;
    const bool mine = i == 0 ? from == 0.0 : s > 0.0 && s <= 1.0;
    if (!mine) continue;
    p.first = std::min(p.first, i);
    p.last = i;
    nodes_->weights(s, p.outward + i * width);
  }
  return p;
}

const OdePropagator::Part& OdePropagator::part(int index, double from, Part& made) const {
  if (index <= kTabled) {
    // Levels 1, 2, … have 2, 4, … parts: level `index` begins at 2^index - 2.
    return parts_[static_cast<size_t>((1 << index) - 2 + static_cast<int>(std::ldexp(from, index)))];
  }
  return made = make_part(index, from);
}

bool OdePropagator::step(const chain::OdeKernel& system, const Level& m, const double* u, const double* x) {
  if (order_ == 2 && degree_ == 3) return step_sized<2, 3>(system, m, u, x);
  if (order_ == 1 && degree_ == 3) return step_sized<1, 3>(system, m, u, x);
  return step_sized<0, 0>(system, m, u, x);
}

template <int Order, int Degree>
bool OdePropagator::step_sized(const chain::OdeKernel& system, const Level& m, const double* u,
                               const double* x) {
  const int n = Order > 0 ? Order : order_;
  const int p = Degree > 0 ? Degree : degree_;
  const int width = p + 1;
  double* state = states_.data();
  double* base = base_.data();
  double* force = force_.data();
  for (int a = 0; a < n; ++a) state[a] = x[a];
  force[0] = system.nonlinear(x, u[0]);
  for (int i = 1; i < width; ++i) {
    force[i] = force[0];
    for (int a = 0; a < n; ++a) {
      double sum = m.k[static_cast<size_t>(i * n + a)];
      const double* e = m.e.data() + (i * n + a) * n;
      const double* gu = m.gu.data() + (i * n + a) * width;
      const double* ge = m.ge.data() + (i * n + a) * width;
      for (int b = 0; b < n; ++b) sum += e[b] * x[b];
      for (int j = 0; j < width; ++j) sum += gu[j] * u[j];
      sum += ge[0] * force[0];
      base[i * n + a] = sum;
    }
  }
  // Newton's method on the forces at nodes 1...p, with the slopes of n where a constant force would lead. Its
  // matrix is 1 - dn/dx dx/df, factored once a step.
  double matrix[kMaxDegree][kMaxDegree];
  const auto states_from_forces = [&] {
    double size = 0.0;
    for (int i = 1; i < width; ++i) {
      for (int a = 0; a < n; ++a) {
        double sum = base[i * n + a];
        const double* ge = m.ge.data() + (i * n + a) * width;
        for (int j = 1; j < width; ++j) sum += ge[j] * force[j];
        size = std::max(size, std::abs(sum));
        state[i * n + a] = sum;
      }
    }
    return size;
  };
  double size = states_from_forces();
  if (!std::isfinite(size)) return false;
  double* slopes = gradient_.data();
  for (int i = 1; i < width; ++i) {
    system.nonlinear_gradient(state + i * n, u[i], slopes);
    for (int j = 1; j < width; ++j) {
      double sum = i == j ? 1.0 : 0.0;
      for (int a = 0; a < n; ++a) sum -= slopes[a] * m.ge[static_cast<size_t>((i * n + a) * width + j)];
      matrix[i - 1][j - 1] = sum;
    }
  }
  for (int k = 0; k < p;
       ++k) {  // no pivoting: the matrix is near 1 wherever the step is short enough to converge
    if (!(std::abs(matrix[k][k]) > 1e-3)) return false;
    for (int i = k + 1; i < p; ++i) {
      const double f = matrix[i][k] / matrix[k][k];
      matrix[i][k] = f;
      for (int j = k + 1; j < p; ++j) matrix[i][j] -= f * matrix[k][j];
    }
  }
  double force_size = std::abs(force[0]);
  double last = INFINITY;
  for (int iteration = 0; iteration < 30; ++iteration) {
    double change[kMaxDegree];
    double most = 0.0;
    for (int i = 0; i < p; ++i) {
      const double f = system.nonlinear(state + (i + 1) * n, u[i + 1]);
      force_size = std::max(force_size, std::abs(f));
      change[i] = f - force[i + 1];
      for (int j = 0; j < i; ++j) change[i] -= matrix[i][j] * change[j];
    }
    for (int i = p - 1; i >= 0; --i) {
      for (int j = i + 1; j < p; ++j) change[i] -= matrix[i][j] * change[j];
      change[i] /= matrix[i][i];
      most = std::max(most, std::abs(change[i]));
    }
    if (!std::isfinite(most)) return false;
    for (int i = 0; i < p; ++i) force[i + 1] += change[i];
    size = states_from_forces();
    // Linear convergence at the rate seen: what is left after this change is most * rate.
    const double rate = last > 0.0 && std::isfinite(last) ? most / last : 1.0;
    if (most * std::min(rate, 1.0) <= tolerance * force_size + 1e-300) return true;
    if (iteration > 1 && rate > 0.6) return most <= 100.0 * tolerance * force_size;
    last = most;
  }
  return false;
}

void OdePropagator::cover(const chain::OdeKernel& system, int index, double from, const double* u, double* x,
                          double* y) {
  if (failures_ > 0) return;
  if (--steps_left_ < 0.0) {
    ++failures_;
    return;
  }
  const int n = order_;
  const int width = degree_ + 1;
  const auto halves = [&] {
    cover(system, index + 1, from, u, x, y);
    cover(system, index + 1, from + std::ldexp(0.5, -index), u, x, y);
  };
  if (index < first_level_) return halves();
  Part made;
  const Part* p = index == 0 ? nullptr : &part(index, from, made);
  double inner[kMaxDegree + 1];
  if (p != nullptr) {
    for (int i = 0; i < width; ++i) {
      double sum = 0.0;
      for (int j = 0; j < width; ++j) sum += p->inward[i * width + j] * u[j];
      inner[i] = sum;
    }
  }
  if (!step(system, level(system, index), p == nullptr ? u : inner, x)) {
    if (index < kFinest) return halves();
    // The finest level's last iterate is what there is.
    if (!std::isfinite(states_[static_cast<size_t>((width - 1) * n)])) {
      ++failures_;
      std::fill(states_.begin(), states_.end(), 0.0);
    }
  }
  const auto& linear = system.linear();
  for (int i = p == nullptr ? 0 : p->first; i <= (p == nullptr ? width - 1 : p->last); ++i) {
    double sum = linear.offset + linear.d * u[i];
    for (int a = 0; a < n; ++a) {
      double value = 0.0;
      if (p == nullptr) {
        value = states_[static_cast<size_t>(i * n + a)];
      } else {
        for (int j = 0; j < width; ++j)
          value += p->outward[i * width + j] * states_[static_cast<size_t>(j * n + a)];
      }
      sum += linear.c[static_cast<size_t>(a)] * value;
    }
    y[i] = sum;
  }
  for (int a = 0; a < n; ++a) x[a] = states_[static_cast<size_t>((width - 1) * n + a)];
}

void OdePropagator::run(const chain::OdeKernel& system, const double* u, double* y, std::size_t holds,
                        double* x) {
  const int width = degree_ + 1;
  steps_left_ = effort * std::ldexp(1.0, first_level_) * static_cast<double>(holds) + 1e4;
  for (std::size_t hold = 0; hold < holds; ++hold) {
    // A state that ran away would cost the finest steps in every hold that follows, for numbers nobody can
    // use.
    if (failures_ > 0) {
      std::fill(y, y + width, 0.0);
    } else {
      cover(system, 0, 0.0, u, x, y);
    }
    u += width;
    y += width;
  }
}

}  // namespace bodesmith::simulate
