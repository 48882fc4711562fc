#include "tracking/continuous.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "numeric/index.hpp"
#include "simulate/cvode_solver.hpp"
#include "simulate/hold_response.hpp"
#include "tracking/switched_system.hpp"
#include "tracking/waveforms.hpp"

namespace bodesmith::tracking {
namespace {

using simulate::CvodeProblem;
using simulate::CvodeSolver;
using simulate::hold_nodes;
using simulate::HoldNodes;
using simulate::HoldResponse;
using simulate::HoldResponseSolver;
using Branch = Disturbance::Branch;
using Inputs = SwitchedSystem::Inputs;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::optional<StateSpace> time_domain_of(const Compensator& c) {
  if (std::holds_alternative<Uncompensated>(c)) return gain_system(0.0);
  if (const auto* constant = std::get_if<ConstantGain>(&c)) return gain_system(constant->gain);
  if (const auto* sections = std::get_if<Sections>(&c)) return state_space(*sections);
  if (const auto* response = std::get_if<ResponseCompensator>(&c)) {
    if (response->approximation) return state_space(*response->approximation);
  }
  return std::nullopt;
}

/// One period of one design, half by half: the reference rises, then falls.
class PeriodRun {
 public:
  PeriodRun(SwitchedSystem system, const Plant& plant, const Options& options, Hertz frequency);
  std::vector<double> run(std::size_t samples);

 private:
  Inputs inputs_at(double theta, bool rising) const;
  void begin_half(bool rising);
  double phase(double t) const;
  /// x at t = 0 in steady state, exactly; with the drive as argument only the states in front of the stage.
  std::vector<double> periodic_state() const;
  CvodeProblem make_problem();
  CvodeSolver make_solver();
  /// y; fills the rates.
  double evaluate(double t, const double* x, double* dx);
  void jacobian(double t, const double* x, double* j);
  double slope_of_drive(double t, const double* x);
  /// Integrates one half from x, writing the samples that lie in it; x is then the state at its end.
  void sample_half(CvodeSolver& solver, bool rising, std::vector<double>& x, std::vector<double>& out);

  SwitchedSystem system_;
  const Options& options_;
  Waveforms generator_;
  Waveforms own_;
  std::array<double, 2> gains_;
  bool before_switch_;
  bool on_drive_;
  double period_;
  std::size_t order_;
  std::array<SwitchedSystem::Matrices, 2> halves_;  ///< while x rises, while it falls
  bool rising_ = true;                              ///< of the reference
  bool drive_rising_ = true;
  std::vector<double> rates_;
};

PeriodRun::PeriodRun(SwitchedSystem system, const Plant& plant, const Options& options, Hertz frequency)
    : system_(std::move(system)),
      options_(options),
      generator_(plant.generated(), options, options.place == Options::Place::behind_switch),
      own_(plant.disturbance, options),
      gains_{plant.disturbance.rate_gain(Branch::ascending, frequency),
             plant.disturbance.rate_gain(Branch::descending, frequency)},
      before_switch_(options.place == Options::Place::before_switch),
      on_drive_(options.argument == Options::Argument::drive),
      period_(1.0 / frequency.value),
      order_(system_.order()),
      rates_(std::max<std::size_t>(order_, 1)) {
  for (const bool rising : {true, false}) {
    begin_half(rising);
    halves_[rising ? 0 : 1] = system_.matrices();
  }
}

Inputs PeriodRun::inputs_at(double theta, bool rising) const {
  const auto g = generator_.at(theta, rising);
  Inputs in{g.x, g.ascending, g.descending, 0.0};
  if (!on_drive_) {
    const auto s = own_.at(theta, rising);
    in.stage = gains_[0] * s.ascending + gains_[1] * s.descending;
  }
  return in;
}

void PeriodRun::begin_half(bool rising) {
  rising_ = rising;
  if (before_switch_) system_.switch_to(rising);
}

double PeriodRun::phase(double t) const {
  return std::clamp(t / period_, rising_ ? 0.0 : 0.5, rising_ ? 0.5 : 1.0);
}

std::vector<double> PeriodRun::periodic_state() const {
  std::vector<double> x(std::max<std::size_t>(order_, 1), 0.0);
  const std::size_t known = on_drive_ ? system_.front() : order_;
  if (known == 0) return x;
  // Over a half period a triangle's waveforms are cubics, a sine's are taken in 32 parts.
  const bool triangle = options_.reference == Options::Reference::triangle;
  const int parts = triangle ? 1 : 32;
  const HoldNodes& nodes = hold_nodes(triangle ? 3 : 4);
  const std::size_t width = nodes.size();
  const Eigen::Index n = eigen_index(order_);
  HoldResponse part;
  Eigen::VectorXd forced = Eigen::VectorXd::Zero(n);
  RowMatrix all = RowMatrix::Identity(n, n);
  for (std::size_t half = 0; half < 2; ++half) {
    const auto& [a, b] = halves_[half];
    const std::array<const double*, SwitchedSystem::kInputs> inputs = {b[0].data(), b[1].data(), b[2].data(),
                                                                       b[3].data()};
    HoldResponseSolver().solve({order_, a.data(), inputs}, 0.5 * period_ / parts, nodes, 1.0, part);
    const Eigen::Map<const RowMatrix> e(part.e.data(), n, n);
    for (int i = 0; i < parts; ++i) {
      Eigen::VectorXd next = e * forced;
      for (std::size_t j = 0; j < width; ++j) {
        const double theta = 0.5 * static_cast<double>(half) + 0.5 * (i + nodes.at[j]) / parts;
        const Inputs in = inputs_at(theta, half == 0);
        const double values[] = {in.x, in.ascending, in.descending, in.stage};
        for (std::size_t q = 0; q < SwitchedSystem::kInputs; ++q) {
          for (std::size_t r = 0; r < order_; ++r) {
            next(eigen_index(r)) += part.g[q][r * width + j] * values[q];
          }
        }
      }
      forced = next;
      all = e * all;
    }
  }
  const Eigen::Index k = eigen_index(known);
  as_eigen(x).head(k) =
      (Eigen::MatrixXd::Identity(k, k) - all.topLeftCorner(k, k)).partialPivLu().solve(forced.head(k));
  return x;
}

double PeriodRun::evaluate(double t, const double* x, double* dx) {
  Inputs in = inputs_at(phase(t), rising_);
  // The drive does not depend on what the stage adds: work it out, then add.
  auto out = system_.evaluate(in, x, dx);
  if (on_drive_) {
    const Branch branch = drive_rising_ ? Branch::ascending : Branch::descending;
    in.stage = gains_[drive_rising_ ? 0 : 1] * own_.branch(branch, out.drive);
    out = system_.evaluate(in, x, dx);
  }
  return out.displacement;
}

void PeriodRun::jacobian(double t, const double* x, double* j) {
  const std::vector<double>& now = halves_[rising_ ? 0 : 1].a;
  std::copy(now.begin(), now.end(), j);
  if (!on_drive_) return;
  // The stage's disturbance answers to v, whose gradient is in the stage's rates already: times 1 + d'.
  const double v = system_.evaluate(inputs_at(phase(t), rising_), x, rates_.data()).drive;
  const double more = gains_[drive_rising_ ? 0 : 1] *
                      own_.branch_slope(drive_rising_ ? Branch::ascending : Branch::descending, v);
  const std::size_t front = system_.front();
  for (std::size_t r = front; r < order_; ++r) {
    for (std::size_t c = 0; c < front; ++c) j[r * order_ + c] *= 1.0 + more;
  }
}

double PeriodRun::slope_of_drive(double t, const double* x) {
  system_.evaluate(inputs_at(phase(t), rising_), x, rates_.data());
  const auto s = generator_.slopes(phase(t), rising_);
  return system_.drive_slope({s.x / period_, s.ascending / period_, s.descending / period_, 0.0},
                             rates_.data());
}

CvodeProblem PeriodRun::make_problem() {
  CvodeProblem problem;
  problem.order = std::max<std::size_t>(order_, 1);
  problem.rate = [this](double t, const double* x, double* dx) {
    if (order_ == 0) dx[0] = 0.0;
    evaluate(t, x, order_ == 0 ? rates_.data() : dx);
  };
  problem.jacobian = [this](double t, const double* x, double* j) {
    if (order_ > 0) jacobian(t, x, j);
  };
  if (on_drive_) {
    problem.events = 1;
    problem.event = [this](double t, const double* x, double* g) { g[0] = slope_of_drive(t, x); };
  }
  return problem;
}

CvodeSolver PeriodRun::make_solver() {
  double norm = 0.0;
  const Eigen::Map<const RowMatrix> a(halves_[0].a.data(), eigen_index(order_), eigen_index(order_));
  for (Eigen::Index i = 0; i < a.rows(); ++i) norm = std::max(norm, a.row(i).lpNorm<1>());
  const auto method = norm * 0.5 * period_ > 300.0 ? CvodeSolver::Method::bdf : CvodeSolver::Method::adams;
  const double tolerance = options_.relative_tolerance;
  return CvodeSolver(make_problem(), method, tolerance, 1e-2 * tolerance);
}

void PeriodRun::sample_half(CvodeSolver& solver, bool rising, std::vector<double>& x,
                            std::vector<double>& out) {
  const std::size_t samples = out.size();
  std::size_t sample = rising ? 0 : samples / 2;
  std::vector<double> inside(x.size());
  double t = rising ? 0.0 : 0.5 * period_;
  const double stop = rising ? 0.5 * period_ : period_;
  if (on_drive_) drive_rising_ = slope_of_drive(t, x.data()) >= 0.0;
  while (t < stop) {
    solver.start(t, x.data(), stop);
    auto outcome = CvodeSolver::Outcome::stepped;
    while (outcome == CvodeSolver::Outcome::stepped) {
      outcome = solver.step();
      for (; sample < samples; ++sample) {
        const double when = period_ * static_cast<double>(sample) / static_cast<double>(samples);
        if (when > solver.time() || (when == stop && rising)) break;
        solver.at(std::max(when, solver.step_begin()), inside.data());
        out[sample] = evaluate(when, inside.data(), rates_.data());
      }
    }
    t = outcome == CvodeSolver::Outcome::stopped ? stop : solver.time();
    std::copy_n(solver.state(), x.size(), x.begin());
    if (outcome == CvodeSolver::Outcome::event) drive_rising_ = solver.crossings()[0] > 0;
  }
}

std::vector<double> PeriodRun::run(std::size_t samples) {
  std::vector<double> out(samples);
  std::vector<double> x = periodic_state();
  CvodeSolver solver = make_solver();
  // One period; two for a stage that has yet to settle (its modes are far faster than the period).
  const int rounds = on_drive_ && order_ > system_.front() ? 2 : 1;
  for (int round = 0; round < rounds; ++round) {
    for (const bool rising : {true, false}) {
      begin_half(rising);
      sample_half(solver, rising, x, out);
    }
  }
  return out;
}

}  // namespace

std::optional<std::vector<double>> track_continuous(const Plant& plant, const Design& design,
                                                    const Options& options, Hertz frequency,
                                                    std::size_t samples) {
  auto ascending = time_domain_of(design.ascending);
  auto descending = time_domain_of(design.descending);
  if (!ascending || !descending) return std::nullopt;
  return PeriodRun({std::move(*ascending), std::move(*descending), state_space(plant.drive_path),
                    state_space(plant.stage_path)},
                   plant, options, frequency)
      .run(samples);
}

}  // namespace bodesmith::tracking
