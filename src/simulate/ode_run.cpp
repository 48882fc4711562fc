#include "simulate/ode_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/progress.hpp"
#include "chain/linear_kernel.hpp"
#include "simulate/cvode.hpp"

namespace bodesmith::simulate {
namespace {

using chain::CurveKernel;
using chain::LinearKernel;
using chain::MemoryKernel;
using chain::OdeKernel;
using chain::SourceKernel;

template <class T>
T* as(chain::Kernel* kernel) {
  auto* held = std::get_if<std::unique_ptr<T>>(kernel);
  return held == nullptr ? nullptr : held->get();
}

}  // namespace

OdeRun::OdeRun(std::vector<chain::Kernel*> kernels, const DenseSignal& input)
    : input_(input), reader_(input) {
  for (chain::Kernel* kernel : kernels) {
    Part part;
    part.kernel = kernel;
    part.state = order_;
    if (const auto* linear = std::get_if<LinearKernel>(kernel)) {
      part.order = static_cast<int>(linear->order());
    } else if (const auto* ode = as<OdeKernel>(kernel)) {
      part.order = static_cast<int>(ode->linear().order());
    } else if (const auto* curve = as<CurveKernel>(kernel)) {
      part.corners = curve->corners();
      part.events = static_cast<int>(part.corners.size());
    } else if (const auto* memory = as<MemoryKernel>(kernel)) {
      // The slope of its input (or the slew limit's own event) comes behind its corners.
      part.corners = memory->corners();
      part.events = static_cast<int>(part.corners.size()) + 1;
      if (memory->slew_rate() > 0.0) part.order = 1;
      slopes_needed_ = true;
    }
    part.event = events_;
    events_ += part.events;
    order_ += part.order;
    parts_.push_back(std::move(part));
  }
  state_.assign(static_cast<std::size_t>(std::max(order_, 1)), 0.0);
  rates_ = state_;
}

void OdeRun::start(Start how, double& rest) {
  const bool still = how == Start::equilibrium;
  // The chain's value at the first sample, block by block; at rest under it for an equilibrium.
  double u = still ? rest : reader_.value(input_.begin());
  for (Part& part : parts_) {
    double* x = state_.data() + part.state;
    if (const auto* linear = std::get_if<LinearKernel>(part.kernel)) {
      if (still) equilibrium(*linear, u, x);
      u = output(*linear, u, x);
    } else if (const auto* ode = as<OdeKernel>(part.kernel)) {
      if (still) ode->equilibrium(u, x);
      u = output(ode->linear(), u, x);
    } else if (const auto* curve = as<CurveKernel>(part.kernel)) {
      u = curve->value(u);
    } else if (const auto* source = as<SourceKernel>(part.kernel)) {
      u += source->value(input_.begin());
    } else if (auto* memory = as<MemoryKernel>(part.kernel)) {
      part.committed = part.u = u;
      part.direction = u < 0.0 ? -1 : 1;
      u = memory->reset(u, still);
      if (part.order == 1) {
        x[0] = u;
        part.follow = u == part.committed ? Follow::yes : part.committed > u ? Follow::up : Follow::down;
      }
    }
  }
  rest = u;
}

void OdeRun::segment(double begin, double end) {
  begin_ = begin;
  end_ = end;
}

double OdeRun::memory_slope(const Part& part, const MemoryKernel& memory, double u) const {
  const double step = 1e-6 * std::max(std::abs(u), 1e-3) * part.direction;
  return (memory.peek(u + step, 0.0) - memory.peek(u, 0.0)) / step;
}

void OdeRun::memory_output(Part& part, const MemoryKernel& memory, double u) const {
  // A hair on the wrong side of the last turn is rounding, not another turn.
  const bool moved = (u - part.committed) * part.direction > 0.0;
  part.y = moved ? memory.peek(u, 0.0) : memory.departing(part.committed + part.direction);
}

bool OdeRun::close_loop(const PidController& controller, const DenseSignal& reference) {
  std::size_t proper = parts_.size();
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const StateSpace* k = std::get_if<LinearKernel>(parts_[i].kernel);
    if (const OdeKernel* ode = as<OdeKernel>(parts_[i].kernel)) k = &ode->linear();
    if (k != nullptr && k->order() > 0 && k->d == 0.0) proper = i;
  }
  if (proper == parts_.size()) return false;
  // What comes after it must follow from its output alone.
  for (std::size_t i = proper + 1; i < parts_.size(); ++i) {
    if (as<MemoryKernel>(parts_[i].kernel) != nullptr) return false;
  }
  loop_.emplace(
      Loop{controller, DenseSignal::Reader(reference), reference.corners(), proper, SampledPid(controller)});
  state_.resize(static_cast<std::size_t>(order_ + 2), 0.0);
  rates_ = state_;
  return true;
}

double OdeRun::output_of(double t, const double* x) const {
  double u = 0.0;
  for (std::size_t i = loop_->proper; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    const StateSpace* k = std::get_if<LinearKernel>(part.kernel);
    if (const OdeKernel* ode = as<OdeKernel>(part.kernel)) k = &ode->linear();
    if (k != nullptr) {
      u = output(*k, u, x + part.state);
    } else if (const auto* curve = as<CurveKernel>(part.kernel)) {
      u = curve->value(u);
    } else if (const auto* source = as<SourceKernel>(part.kernel)) {
      u += source->value(t);
    }
  }
  return u;
}

double OdeRun::control(double error, const double* pid, double* rates) const {
  const PidController& c = loop_->controller;
  const double wd = c.derivative_corner.rad_s().value;
  const double free = c.proportional * error + pid[0] + c.derivative_s * wd * (error - pid[1]);
  const double held = std::clamp(free, c.lower, c.upper);
  rates[0] = c.integral_per_s * error;
  if ((free > c.upper && rates[0] > 0.0) || (free < c.lower && rates[0] < 0.0)) rates[0] = 0.0;
  rates[1] = c.derivative_s == 0.0 ? 0.0 : wd * (error - pid[1]);
  return held;
}

void OdeRun::sample_controller(double t) {
  loop_->held = loop_->sampled.update(loop_->reference.value(t) - output_of(t, state_.data()));
}

void OdeRun::evaluate(double t, const double* x, double* dx, bool restart) {
  const bool left = t >= end_;
  double u = reader_.value(t, left);
  double du = slopes_needed_ || restart ? reader_.slope(t, left) : 0.0;
  if (order_ == 0) dx[0] = 0.0;
  if (!loop_) return walk(t, u, du, x, dx, restart);
  double* pid_rates = dx + order_;
  if (loop_->controller.period_s > 0.0) {
    pid_rates[0] = pid_rates[1] = 0.0;
    return walk(t, u + loop_->held, du, x, dx, restart);
  }
  const double error = loop_->reference.value(t, left) - output_of(t, x);
  u += control(error, x + order_, pid_rates);
  if (slopes_needed_ || restart) {
    // The slope of the error needs the rates of the states, which need no slopes: once through without.
    walk(t, u, 0.0, x, dx, false);
    const double step = 1e-7;
    std::vector<double> ahead(x, x + order_);
    for (int i = 0; i < order_; ++i) ahead[static_cast<std::size_t>(i)] += step * dx[i];
    const double y_slope = (output_of(t + step, ahead.data()) - output_of(t, x)) / step;
    const PidController& c = loop_->controller;
    const double error_slope = loop_->reference.slope(t, left) - y_slope;
    const double wd = c.derivative_corner.rad_s().value;
    du += c.proportional * error_slope + pid_rates[0] + c.derivative_s * wd * (error_slope - pid_rates[1]);
  }
  walk(t, u, du, x, dx, restart);
}

void OdeRun::walk(double t, double u, double du, const double* x, double* dx, bool restart) {
  for (Part& part : parts_) {
    part.u = u;
    part.du = du;
    const double* xs = x + part.state;
    double* ds = dx + part.state;
    const int n = part.order;
    if (const auto* linear = std::get_if<LinearKernel>(part.kernel)) {
      double y = linear->d * u + linear->offset;
      double dy = linear->d * du;
      for (int i = 0; i < n; ++i) {
        double sum = linear->b[static_cast<std::size_t>(i)] * u;
        if (!linear->constant.empty()) sum += linear->constant[static_cast<std::size_t>(i)];
        const double* a = linear->a.data() + i * n;
        for (int j = 0; j < n; ++j) sum += a[j] * xs[j];
        ds[i] = sum;
        y += linear->c[static_cast<std::size_t>(i)] * xs[i];
        dy += linear->c[static_cast<std::size_t>(i)] * sum;
      }
      u = y;
      du = dy;
    } else if (const auto* ode = as<OdeKernel>(part.kernel)) {
      const StateSpace& k = ode->linear();
      const double extra = ode->nonlinear(xs, u);
      double y = k.d * u + k.offset;
      double dy = k.d * du;
      for (int i = 0; i < n; ++i) {
        double sum = k.b[static_cast<std::size_t>(i)] * u + ode->entry()[static_cast<std::size_t>(i)] * extra;
        if (!k.constant.empty()) sum += k.constant[static_cast<std::size_t>(i)];
        const double* a = k.a.data() + i * n;
        for (int j = 0; j < n; ++j) sum += a[j] * xs[j];
        ds[i] = sum;
        y += k.c[static_cast<std::size_t>(i)] * xs[i];
        dy += k.c[static_cast<std::size_t>(i)] * sum;
      }
      u = y;
      du = dy;
    } else if (const auto* curve = as<CurveKernel>(part.kernel)) {
      if (du != 0.0) du *= curve->slope(u);
      u = curve->value(u);
    } else if (const auto* source = as<SourceKernel>(part.kernel)) {
      u += source->value(t);
      if (slopes_needed_ || restart) du += source->rate(t);
    } else if (const auto* memory = as<MemoryKernel>(part.kernel)) {
      if (n == 1) {
        const double rate = memory->slew_rate();
        if (restart && part.follow == Follow::yes && std::abs(du) > rate)
          part.follow = du > 0.0 ? Follow::up : Follow::down;
        if (part.follow == Follow::yes) {
          ds[0] = du;
        } else {
          du = ds[0] = part.follow == Follow::up ? rate : -rate;
          u = xs[0];
        }
      } else {
        if (restart && du != 0.0) part.direction = du > 0.0 ? 1 : -1;
        memory_output(part, *memory, u);
        if (du != 0.0) du *= memory_slope(part, *memory, u);
        u = part.y;
      }
    }
    part.y = u;
  }
  last_ = u;
}

void OdeRun::newton(double t, const double* x, double gamma, double* b) {
  evaluate(t, x, rates_.data(), false);
  double du = 0.0;  // what the states in front change of this part's input
  std::vector<double> by_x;
  for (Part& part : parts_) {
    const int n = part.order;
    double* z = b + part.state;
    const StateSpace* k = std::get_if<LinearKernel>(part.kernel);
    const OdeKernel* ode = as<OdeKernel>(part.kernel);
    if (ode != nullptr) k = &ode->linear();
    if (k != nullptr) {
      const auto entry = [&](int i) {
        return ode == nullptr ? 0.0 : ode->entry()[static_cast<std::size_t>(i)];
      };
      by_x.assign(static_cast<std::size_t>(n), 0.0);
      const double by_u = ode == nullptr ? 0.0 : ode->nonlinear_gradient(x + part.state, part.u, by_x.data());
      for (int i = 0; i < n; ++i) z[i] += gamma * (k->b[static_cast<std::size_t>(i)] + entry(i) * by_u) * du;
      if (n == 1) {
        z[0] /= 1.0 - gamma * (k->a[0] + entry(0) * by_x[0]);
      } else if (n > 1) {
        if (ode != nullptr || part.factored_gamma != gamma) {
          Eigen::MatrixXd m = Eigen::MatrixXd::Identity(n, n);
          for (int i = 0; i < n; ++i) {
            for (int c = 0; c < n; ++c) {
              m(i, c) -= gamma * (k->a[static_cast<std::size_t>(i * n + c)] +
                                  entry(i) * by_x[static_cast<std::size_t>(c)]);
            }
          }
          part.factored.compute(m);
          part.factored_gamma = gamma;
        }
        Eigen::Map<Eigen::VectorXd> states(z, n);
        states = part.factored.solve(states).eval();
      }
      du *= k->d;
      for (int i = 0; i < n; ++i) du += k->c[static_cast<std::size_t>(i)] * z[i];
    } else if (const auto* curve = as<CurveKernel>(part.kernel)) {
      du *= curve->slope(part.u);
    } else if (const auto* memory = as<MemoryKernel>(part.kernel)) {
      if (n == 0) {
        du *= memory_slope(part, *memory, part.u);
      } else if (part.follow != Follow::yes) {
        du = z[0];  // following, the state only shadows the input: Newton may take its rate as given
      }
    }
  }
}

void OdeRun::events(double t, const double* x, double* g) {
  evaluate(t, x, rates_.data(), false);
  for (const Part& part : parts_) {
    for (int i = 0; i < static_cast<int>(part.corners.size()); ++i) {
      g[part.event + i] = part.u - part.corners[static_cast<std::size_t>(i)];
    }
    if (const auto* memory = as<MemoryKernel>(part.kernel)) {
      if (part.order == 0) {
        g[part.turn_event()] = part.du;
      } else if (part.follow == Follow::yes) {
        const double rate = memory->slew_rate();
        g[part.turn_event()] = (rate - part.du) * (rate + part.du);
      } else {
        g[part.turn_event()] = x[part.state] - part.u;
      }
    }
  }
}

void OdeRun::commit() {
  for (Part& part : parts_) {
    auto* memory = as<MemoryKernel>(part.kernel);
    if (memory == nullptr || part.order == 1) continue;
    memory->step(part.u, 0.0);
    part.committed = part.u;
  }
}

void OdeRun::restart_at(double t, const std::vector<int>* crossings) {
  for (Part& part : parts_) {
    auto* memory = as<MemoryKernel>(part.kernel);
    if (memory == nullptr) continue;
    const int crossed = crossings == nullptr ? 0 : (*crossings)[static_cast<std::size_t>(part.turn_event())];
    if (part.order == 0) {
      if (crossed != 0) part.direction = crossed;
      continue;
    }
    double& y = state_[static_cast<std::size_t>(part.state)];
    if (part.follow == Follow::yes) {
      y = part.u;
      if (crossed != 0)
        part.follow = part.du > 0.0 ? Follow::up : Follow::down;  // the input has just become too fast
    } else if (crossed != 0) {
      y = part.u;
      part.follow = Follow::yes;
    }
  }
  // Directions after a corner of the input; a turn found by its event keeps the direction found, its slope is
  // about 0.
  std::vector<int> kept;
  for (Part& part : parts_) kept.push_back(part.direction);
  evaluate(t, state_.data(), rates_.data(), true);
  if (crossings != nullptr) {
    bool changed = false;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      Part& part = parts_[i];
      if (as<MemoryKernel>(part.kernel) != nullptr && part.order == 0 &&
          (*crossings)[static_cast<std::size_t>(part.turn_event())] != 0) {
        changed = changed || part.direction != kept[i];
        part.direction = kept[i];
      }
    }
    if (changed) evaluate(t, state_.data(), rates_.data(), false);
  }
  // A jump of the input of a slew limit leaves the output behind.
  for (Part& part : parts_) {
    if (part.order != 1 || as<MemoryKernel>(part.kernel) == nullptr) continue;
    double& y = state_[static_cast<std::size_t>(part.state)];
    if (part.follow == Follow::yes && y != part.u &&
        std::abs(y - part.u) > 1e-9 * std::max(std::abs(y), std::abs(part.u))) {
      part.follow = part.u > y ? Follow::up : Follow::down;
    }
  }
}

double OdeRun::stiffness() const {
  double norm = 0.0;
  for (const Part& part : parts_) {
    const StateSpace* k = std::get_if<LinearKernel>(part.kernel);
    if (const OdeKernel* ode = as<OdeKernel>(part.kernel)) k = &ode->linear();
    if (k != nullptr) norm = std::max(norm, max_row_sum(*k));
  }
  return norm;
}

void OdeRun::solve(const Options& options, const Wanted& wanted, Stats& stats, double shortest_detail_s) {
  const double first = input_.begin();
  const double last = input_.end();
  std::vector<double> stops = input_.corners();
  if (loop_) stops.insert(stops.end(), loop_->corners.begin(), loop_->corners.end());
  std::erase_if(stops, [&](double t) { return t <= first || t >= last; });
  const double period = loop_ ? loop_->controller.period_s : 0.0;
  const auto sampling = [&](double t) { return std::abs(std::remainder(t - first, period)) < 1e-6 * period; };
  if (period > 0.0) {
    // A clock edge that is a corner but for rounding is that corner.
    std::sort(stops.begin(), stops.end());
    std::vector<double> edges;
    for (double k = 1.0; first + k * period < last; k += 1.0) {
      const double t = first + k * period;
      const auto near = std::lower_bound(stops.begin(), stops.end(), t - 1e-6 * period);
      if (near == stops.end() || *near > t + 1e-6 * period) edges.push_back(t);
    }
    stops.insert(stops.end(), edges.begin(), edges.end());
  }
  std::sort(stops.begin(), stops.end());
  stops.erase(std::unique(stops.begin(), stops.end()), stops.end());
  stops.push_back(last);

  Cvode::Problem problem;
  problem.order = static_cast<int>(state_.size());
  problem.rate = [this](double t, const double* x, double* dx) { evaluate(t, x, dx, false); };
  // A closed loop has no first part: dense, by difference quotients.
  if (!loop_) problem.newton = [this](double t, const double* x, double g, double* b) { newton(t, x, g, b); };
  problem.events = events_;
  problem.event = [this](double t, const double* x, double* g) { events(t, x, g); };
  const double typical = (last - first) / static_cast<double>(stops.size());
  const bool stiff = stiffness() * typical > 300.0;
  Cvode solver(problem, stiff ? Cvode::Method::bdf : Cvode::Method::adams, options.relative_tolerance,
               options.absolute_tolerance);
  // Without dynamics nothing else tells the solver how fine the signal is.
  if (order_ == 0 || events_ > 0)
    solver.limit_step(order_ == 0 ? shortest_detail_s : 16.0 * shortest_detail_s);

  std::size_t next_time = 0;
  if (wanted.values != nullptr) wanted.values->resize(wanted.times.size());
  if (wanted.drive != nullptr) wanted.drive->resize(wanted.times.size());
  std::vector<double> inside(state_.size());
  const auto output_at = [&](double t) {
    solver.at(t, inside.data());
    evaluate(t, inside.data(), rates_.data(), false);
    return last_;
  };
  segment(first, stops.front());
  if (period > 0.0) sample_controller(first);
  restart_at(first, nullptr);
  if (wanted.values != nullptr && !wanted.times.empty() && wanted.times.front() <= first) {
    evaluate(first, state_.data(), rates_.data(), false);
    if (wanted.drive != nullptr) (*wanted.drive)[next_time] = parts_.front().u;
    (*wanted.values)[next_time++] = last_;
  }
  double t = first;
  constexpr std::size_t kCrowd = 200;
  std::size_t crowded = 0;
  double crowd_begin = first;
  std::size_t since_look = 0;
  for (const double stop : stops) {
    segment(t, stop);
    while (t < stop) {
      solver.start(t, state_.data(), stop);
      Cvode::Outcome outcome = Cvode::Outcome::stepped;
      while (outcome == Cvode::Outcome::stepped) {
        outcome = solver.step();
        if (++since_look >= 4096) {
          since_look = 0;
          stop_if_interrupted();
        }
        const double begin = solver.step_begin();
        const double end = solver.time();
        if (wanted.values != nullptr) {
          const bool to_end = !wanted.right_limits || end < stop || stop == last;
          while (next_time < wanted.times.size() &&
                 (to_end ? wanted.times[next_time] <= end : wanted.times[next_time] < end)) {
            (*wanted.values)[next_time] = output_at(std::max(wanted.times[next_time], begin));
            if (wanted.drive != nullptr) (*wanted.drive)[next_time] = parts_.front().u;
            ++next_time;
          }
        }
        if (wanted.dense != nullptr && end > begin) {
          const HoldNodes& nodes = hold_nodes(kMaxDegree);
          for (int half = 0; half < 2; ++half) {
            DenseSignal::Piece piece;
            piece.begin = half == 0 ? begin : begin + 0.5 * (end - begin);
            piece.end = half == 0 ? begin + 0.5 * (end - begin) : end;
            piece.degree = kMaxDegree;
            for (int i = 0; i <= kMaxDegree; ++i) {
              const double at = i == kMaxDegree ? piece.end
                                                : piece.begin + nodes.at[static_cast<std::size_t>(i)] *
                                                                    (piece.end - piece.begin);
              piece.nodes[i] = output_at(at);
            }
            if (piece.end > piece.begin) wanted.dense->append(piece);
          }
        }
      }
      t = outcome == Cvode::Outcome::stopped ? stop : solver.time();
      std::copy_n(solver.state(), state_.size(), state_.begin());
      evaluate(t, state_.data(), rates_.data(), false);
      commit();
      if (outcome == Cvode::Outcome::event) {
        ++stats.events;
        if (++crowded % kCrowd == 0) {
          // Time must go on; a block that jumps when its input turns may turn its own input back in a loop.
          if (t - crowd_begin < 1e-3 * shortest_detail_s) {
            throw std::runtime_error(fmt::format("blocks switch to and fro without end at {:.6g} s", t));
          }
          crowd_begin = t;
        }
        restart_at(t, &solver.crossings());
        if (wanted.dense != nullptr) wanted.dense->corner(t);
      }
    }
    if (stop >= last) break;
    const auto next = std::upper_bound(stops.begin(), stops.end(), stop);
    segment(stop, *next);
    if (period > 0.0 && sampling(stop)) sample_controller(stop);
    // A jump of the input is a monotone move of its own for the memories.
    evaluate(stop, state_.data(), rates_.data(), false);
    commit();
    restart_at(stop, nullptr);
    if (wanted.dense != nullptr) wanted.dense->corner(stop);
  }
  stats.steps += solver.steps();
  stats.evaluations += solver.evaluations();
  stats.restarts += solver.restarts();
}

}  // namespace bodesmith::simulate
