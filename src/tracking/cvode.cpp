#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lti/state_space.hpp"
#include "simulate/cvode.hpp"
#include "simulate/hold_response.hpp"
#include "tracking/time.hpp"

namespace bodesmith::tracking {
namespace {

using Branch = Disturbance::Branch;
using simulate::Cvode;
using simulate::hold_nodes;
using simulate::HoldNodes;
using simulate::HoldResponse;
using simulate::HoldResponseSolver;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::optional<StateSpace> kernel_of(const Compensator& c) {
  if (std::holds_alternative<Uncompensated>(c)) return gain_system(0.0);
  if (const auto* constant = std::get_if<ConstantGain>(&c)) return gain_system(constant->gain);
  if (const auto* sections = std::get_if<Sections>(&c)) return state_space(*sections);
  if (const auto* response = std::get_if<ResponseCompensator>(&c)) {
    if (response->approximation) return state_space(*response->approximation);
  }
  return std::nullopt;
}

/// What goes in: reference, both generator waveforms, and what the stage adds.
struct Inputs {
  double x = 0.0;
  double ascending = 0.0;
  double descending = 0.0;
  double stage = 0.0;
};

/// Compensators, drive path and stage path, one behind the other.
class System {
 public:
  System(StateSpace ascending, StateSpace descending, StateSpace drive, StateSpace path)
      : ascending_(std::move(ascending)),
        descending_(std::move(descending)),
        drive_(std::move(drive)),
        path_(std::move(path)) {}

  std::size_t order() const { return front() + path_.order(); }
  std::size_t front() const { return ascending_.order() + descending_.order() + drive_.order(); }

  /// Rates of all states; also v and y.
  void evaluate(const Inputs& in, const double* x, double* dx) {
    const double* x_drive = x + ascending_.order() + descending_.order();
    const double up = through(ascending_, in.ascending, x, dx);
    const double down = through(descending_, in.descending, x + ascending_.order(), dx + ascending_.order());
    const double c = (open[0] ? up : 0.0) + (open[1] ? down : 0.0);
    v = through(drive_, in.x - c, x_drive, dx + (x_drive - x));
    y = through(path_, v + in.stage, x_drive + drive_.order(), dx + front());
  }
  /// dv/dt, after evaluate() filled dx.
  double drive_slope(const Inputs& slopes, const double* dx) const {
    const double c = (open[0] ? output_slope(ascending_, slopes.ascending, dx) : 0.0) +
                     (open[1] ? output_slope(descending_, slopes.descending, dx + ascending_.order()) : 0.0);
    return output_slope(drive_, slopes.x - c, dx + ascending_.order() + descending_.order());
  }

  double v = 0.0;
  double y = 0.0;
  /// Whether the switch lets the branch's compensator through; both always when it stands in front of them.
  bool open[2] = {true, true};

 private:
  static double through(const StateSpace& system, double u, const double* x, double* dx) {
    derivative(system, u, x, dx);
    return output(system, u, x);
  }
  StateSpace ascending_, descending_, drive_, path_;
};

}  // namespace

bool is_clocked(const Compensator& compensator) {
  const auto* clocked = std::get_if<ClockedCompensator>(&compensator);
  return clocked != nullptr && clocked->hold_and_delays;
}

std::optional<TimeTracking> track_in_cvode(const TrackingPlant& plant, const TrackingDesign& design,
                                           const TrackingOptions& options, Hertz frequency, int per_period) {
  auto ascending = kernel_of(design.ascending);
  auto descending = kernel_of(design.descending);
  if (!ascending || !descending) return std::nullopt;
  System system(std::move(*ascending), std::move(*descending), state_space(plant.drive_path),
                state_space(plant.stage_path));
  const int n = static_cast<int>(system.order());
  const int front = static_cast<int>(system.front());
  const bool before_switch = options.place == TrackingOptions::Place::before_switch;
  const TrackingWaveforms generator(plant.generator ? *plant.generator : plant.disturbance, options,
                                    !before_switch);
  const TrackingWaveforms own(plant.disturbance, options);
  const double gains[2] = {plant.disturbance.rate_gain(Branch::ascending, frequency),
                           plant.disturbance.rate_gain(Branch::descending, frequency)};
  const bool on_drive = options.argument == TrackingOptions::Argument::drive;
  const double period = 1.0 / frequency.value;

  const auto inputs_at = [&](double theta, bool rising) {
    const auto g = generator.at(theta, rising);
    Inputs in{g.x, g.ascending, g.descending, 0.0};
    if (!on_drive) {
      const auto s = own.at(theta, rising);
      in.stage = gains[0] * s.ascending + gains[1] * s.descending;
    }
    return in;
  };

  const auto turn_switch = [&](bool to_rising) {
    if (!before_switch) return;
    system.open[0] = to_rising;
    system.open[1] = !to_rising;
  };

  // df/dx and the columns of the inputs, from the system itself: it is linear, while x rises and while it
  // falls.
  RowMatrix a[2];
  std::vector<std::vector<double>> b[2];
  for (int half = 0; half < 2; ++half) {
    turn_switch(half == 0);
    a[half] = RowMatrix::Zero(n, n);
    b[half].assign(4, std::vector<double>(static_cast<size_t>(n)));
    std::vector<double> zero(static_cast<size_t>(n), 0.0);
    std::vector<double> column(static_cast<size_t>(n));
    for (int j = 0; j < n; ++j) {
      zero[static_cast<size_t>(j)] = 1.0;
      system.evaluate({}, zero.data(), column.data());
      for (int i = 0; i < n; ++i) a[half](i, j) = column[static_cast<size_t>(i)];
      zero[static_cast<size_t>(j)] = 0.0;
    }
    system.evaluate({1, 0, 0, 0}, zero.data(), b[half][0].data());
    system.evaluate({0, 1, 0, 0}, zero.data(), b[half][1].data());
    system.evaluate({0, 0, 1, 0}, zero.data(), b[half][2].data());
    system.evaluate({0, 0, 0, 1}, zero.data(), b[half][3].data());
  }

  // The periodic state, exactly: over a half period a triangle's waveforms are cubics, a sine's are taken in
  // 32 parts.
  std::vector<double> x(static_cast<size_t>(n), 0.0);
  if (n > 0) {
    const bool triangle = options.reference == TrackingOptions::Reference::triangle;
    const int parts = triangle ? 1 : 32;
    const HoldNodes& nodes = hold_nodes(triangle ? 3 : 4);
    HoldResponseSolver solver;
    Eigen::VectorXd forced = Eigen::VectorXd::Zero(n);
    RowMatrix all = RowMatrix::Identity(n, n);
    const int width = nodes.degree + 1;
    for (int half = 0; half < 2; ++half) {
      StateSpace whole;
      whole.b.assign(static_cast<size_t>(n), 0.0);
      whole.a.assign(a[half].data(), a[half].data() + a[half].size());
      HoldResponse part;
      solver.solve(whole, {b[half][0].data(), b[half][1].data(), b[half][2].data(), b[half][3].data()},
                   0.5 * period / parts, nodes, 1.0, part);
      const Eigen::Map<const RowMatrix> e(part.e.data(), n, n);
      for (int i = 0; i < parts; ++i) {
        Eigen::VectorXd next = e * forced;
        for (int j = 0; j < width; ++j) {
          const double theta = 0.5 * half + 0.5 * (i + nodes.at[static_cast<size_t>(j)]) / parts;
          const Inputs in = inputs_at(theta, half == 0);
          const double values[4] = {in.x, in.ascending, in.descending, in.stage};
          for (size_t q = 0; q < 4; ++q) {
            for (int r = 0; r < n; ++r) next(r) += part.g[q][static_cast<size_t>(r * width + j)] * values[q];
          }
        }
        forced = next;
        all = e * all;
      }
    }
    // With the drive as argument only the states in front of the stage are known so; the stage settles below.
    const int known = on_drive ? front : n;
    if (known > 0) {
      const Eigen::VectorXd start =
          (Eigen::MatrixXd::Identity(known, known) - all.topLeftCorner(known, known))
              .partialPivLu()
              .solve(forced.head(known));
      std::copy(start.begin(), start.end(), x.begin());
    }
  }

  bool rising = true;  // of the reference
  bool drive_rising = true;
  const auto phase = [&](double t) { return std::clamp(t / period, rising ? 0.0 : 0.5, rising ? 0.5 : 1.0); };
  std::vector<double> dx(static_cast<size_t>(std::max(n, 1)));
  const auto with_drive = [&](Inputs in, const double* state, double* rates) {
    // The drive does not depend on what the stage adds: work it out, then add.
    system.evaluate(in, state, rates);
    if (on_drive) {
      const Branch branch = drive_rising ? Branch::ascending : Branch::descending;
      in.stage = gains[drive_rising ? 0 : 1] * own.branch(branch, system.v);
      system.evaluate(in, state, rates);
    }
    return system.y;
  };
  const auto slope_of_drive = [&](double t, const double* state) {
    system.evaluate(inputs_at(phase(t), rising), state, dx.data());
    const auto s = generator.slopes(phase(t), rising);
    return system.drive_slope({s.x / period, s.ascending / period, s.descending / period, 0.0}, dx.data());
  };

  TimeTracking out;
  out.per_period = per_period;
  out.displacement.resize(static_cast<size_t>(per_period));
  Cvode::Problem problem;
  problem.order = std::max(n, 1);
  problem.rate = [&](double t, const double* state, double* rates) {
    if (n == 0) rates[0] = 0.0;
    with_drive(inputs_at(phase(t), rising), state, n == 0 ? dx.data() : rates);
  };
  problem.jacobian = [&](double t, const double* state, double* j) {
    if (n == 0) return;
    const RowMatrix& now = a[rising ? 0 : 1];
    std::copy(now.data(), now.data() + now.size(), j);
    if (!on_drive) return;
    // The stage's disturbance answers to v, whose gradient is in the stage's rates already: times 1 + d'.
    system.evaluate(inputs_at(phase(t), rising), state, dx.data());
    const double more = gains[drive_rising ? 0 : 1] *
                        own.branch_slope(drive_rising ? Branch::ascending : Branch::descending, system.v);
    for (int r = front; r < n; ++r) {
      for (int c = 0; c < front; ++c) j[r * n + c] *= 1.0 + more;
    }
  };
  if (on_drive) {
    problem.events = 1;
    problem.event = [&](double t, const double* state, double* g) { g[0] = slope_of_drive(t, state); };
  }
  double norm = 0.0;
  for (int i = 0; i < n; ++i) norm = std::max(norm, a[0].row(i).lpNorm<1>());
  const auto method = norm * 0.5 * period > 300.0 ? Cvode::Method::bdf : Cvode::Method::adams;
  Cvode solver(problem, method, options.relative_tolerance, 1e-2 * options.relative_tolerance);
  if (x.empty()) x.push_back(0.0);
  std::vector<double> inside(x.size());
  // One period; two for a stage that has yet to settle (its modes are far faster than the period).
  const int rounds = on_drive && n > front ? 2 : 1;
  for (int round = 0; round < rounds; ++round) {
    std::size_t sample = 0;
    for (int half = 0; half < 2; ++half) {
      rising = half == 0;
      turn_switch(rising);
      double t = 0.5 * half * period;
      const double stop = 0.5 * (half + 1) * period;
      if (on_drive) drive_rising = slope_of_drive(t, x.data()) >= 0.0;
      while (t < stop) {
        solver.start(t, x.data(), stop);
        Cvode::Outcome outcome = Cvode::Outcome::stepped;
        while (outcome == Cvode::Outcome::stepped) {
          outcome = solver.step();
          while (sample < out.displacement.size()) {
            const double when = period * static_cast<double>(sample) / per_period;
            if (when > solver.time() || (when == stop && half == 0)) break;
            solver.at(std::max(when, solver.step_begin()), inside.data());
            out.displacement[sample++] = with_drive(inputs_at(phase(when), rising), inside.data(), dx.data());
          }
        }
        t = outcome == Cvode::Outcome::stopped ? stop : solver.time();
        std::copy_n(solver.state(), x.size(), x.begin());
        if (outcome == Cvode::Outcome::event) drive_rising = solver.crossings()[0] > 0;
      }
    }
  }
  return out;
}

}  // namespace bodesmith::tracking
