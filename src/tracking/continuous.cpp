#include "tracking/continuous.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/whole_number.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "simulate/ode/cvode_solver.hpp"
#include "tracking/driven_stage.hpp"
#include "tracking/settled_path.hpp"

namespace bodesmith::tracking {
namespace {

using simulate::CvodeProblem;
using simulate::CvodeSolver;
/// One repeat of one design, piece by piece between the reference's turning points.
class RepeatRun {
 public:
  RepeatRun(DrivenStage stage, const PeriodicTracking& periodic, const Options& options)
      : stage_(std::move(stage)),
        periodic_(periodic),
        options_(options),
        rates_(std::max<std::size_t>(stage_.order(), 1)) {
    for (const StateSpace& block : stage_.blocks())
      forgotten_.push_back(block.order() > 0 ? forgotten(block, stage_.repeat_s()) : Eigen::MatrixXd());
  }

  ContinuousRun run(const PeriodicState& begin, std::size_t samples);

 private:
  std::vector<double> first_states(const PeriodicState& begin) const;
  CvodeSolver make_solver();
  DrivenStage::Outputs evaluate(double t, const double* x, double* dx) const;
  double piece_end(std::size_t piece) const;
  /// Integrates one piece from x, writing the samples that lie in it; x is then the state at its end.
  void sample_piece(CvodeSolver& solver, std::size_t piece, std::vector<double>& x, ContinuousRun& out);
  void add_nodes(CvodeSolver& solver, double from, ContinuousRun& out);
  /// Moves x to where a repeat that ends at `end` should have begun, by the linear blocks alone; the largest move, of states larger than 1 relative.
  double correct(std::vector<double>& x, const std::vector<double>& end) const;

  DrivenStage stage_;
  const PeriodicTracking& periodic_;
  const Options& options_;
  std::vector<double> rates_;
  std::vector<Eigen::MatrixXd> forgotten_;  ///< of each block
  std::size_t piece_ = 0;
  std::size_t sample_ = 0;
};

double RepeatRun::piece_end(std::size_t piece) const {
  const std::vector<double>& turns = stage_.reference().turns();
  return piece + 1 < turns.size() ? turns[piece + 1] : 1.0;
}

std::vector<double> RepeatRun::first_states(const PeriodicState& begin) const {
  const double repeat = stage_.repeat_s();
  std::vector<std::vector<double>> inputs;
  for (std::size_t branch = 0; branch < 2; ++branch) {
    const SlopeGain* detector = stage_.detector(branch);
    if (detector == nullptr) continue;
    // Their states are their outputs.
    const MeasuredSlope measured =
        measure_slope(*detector, stage_.reference(), periodic_.frequency(), begin.drive.size());
    inputs.push_back(measured.slope);
    inputs.push_back(measured.smoothed);
  }
  const std::size_t detectors = inputs.size();
  for (const std::vector<double>& heard : begin.heard) {
    for (std::size_t branch = 0; branch < 2; ++branch)
      inputs.push_back(periodic_.branch_waveform(branch, heard));
  }
  inputs.push_back(begin.drive);
  const StateSpace& path = stage_.blocks()[stage_.blocks().size() - 2];
  std::vector<double> q = begin.drive;
  if (path.order() > 0 && options_.argument == Options::Argument::drive) {
    // Far faster than a period: a shift by its lag at most, which the first corrections take care of.
    const double at_rest = response(path, 0.0).real();
    for (double& value : q) value *= at_rest;
  }
  const std::vector<double> added = periodic_.stage_disturbance(q);
  for (std::size_t i = 0; i < q.size(); ++i) q[i] += added[i];
  inputs.push_back(std::move(q));

  std::vector<double> x;
  for (std::size_t i = 0; i < stage_.blocks().size(); ++i) {
    const StateSpace& block = stage_.blocks()[i];
    if (block.order() == 0) continue;
    if (i < detectors) {
      x.push_back(inputs[i].front());
      continue;
    }
    const std::vector<double> states =
        settled_path(block, inputs[i], repeat / static_cast<double>(inputs[i].size())).states;
    x.insert(x.end(), states.begin(), states.end());
  }
  x.resize(std::max<std::size_t>(stage_.order(), 1), 0.0);
  return x;
}

DrivenStage::Outputs RepeatRun::evaluate(double t, const double* x, double* dx) const {
  const std::vector<double>& turns = stage_.reference().turns();
  return stage_.evaluate(std::clamp(t / stage_.repeat_s(), turns[piece_], piece_end(piece_)), x, dx);
}

CvodeSolver RepeatRun::make_solver() {
  CvodeProblem problem;
  problem.order = std::max<std::size_t>(stage_.order(), 1);
  problem.rate = [this](double t, const double* x, double* dx) {
    if (stage_.order() == 0) dx[0] = 0.0;
    evaluate(t, x, stage_.order() == 0 ? rates_.data() : dx);
  };
  if (stage_.reads_drive()) {
    problem.events = 1;
    problem.event = [this](double t, const double* x, double* g) {
      g[0] = evaluate(t, x, rates_.data()).drive_slope;
    };
  }
  double fastest = 0.0;
  for (const StateSpace& block : stage_.blocks()) fastest = std::max(fastest, max_row_sum(block));
  const double piece = stage_.repeat_s() / static_cast<double>(stage_.reference().turns().size());
  const auto method = fastest * piece > 300.0 ? CvodeSolver::Method::bdf : CvodeSolver::Method::adams;
  const double tolerance = options_.relative_tolerance;
  CvodeSolver solver(std::move(problem), method, tolerance, 1e-2 * tolerance);
  // A resonance with little damping lies where the formulas of order 4 and 5 are unstable unless steps are short against it:
  // those of order 3 are stable up to 4 degrees from the imaginary axis, and need a third of the steps.
  if (method == CvodeSolver::Method::bdf) solver.limit_order(3);
  return solver;
}

void RepeatRun::add_nodes(CvodeSolver& solver, double from, ContinuousRun& out) {
  constexpr double kLongest = 1.0 / 1024.0;  // of a repeat: a step may be long where y is smooth and x is not
  const double repeat = stage_.repeat_s(), span = solver.time() - from;
  const auto parts = whole_number<std::size_t>(std::ceil(span / (kLongest * repeat)), 1);
  const double part = span / static_cast<double>(parts);
  std::vector<double> inside(rates_.size());
  for (std::size_t i = 0; i < parts; ++i) {
    for (const double place : {0.5 - std::sqrt(1.0 / 12.0), 0.5 + std::sqrt(1.0 / 12.0)}) {
      const double t = from + (static_cast<double>(i) + place) * part;
      solver.at(t, inside.data());
      out.nodes.push_back({t, evaluate(t, inside.data(), rates_.data()).displacement, 0.5 * part / repeat});
    }
  }
}

void RepeatRun::sample_piece(CvodeSolver& solver, std::size_t piece, std::vector<double>& x,
                             ContinuousRun& out) {
  piece_ = piece;
  stage_.enter_piece(piece);
  const double repeat = stage_.repeat_s();
  const double stop = repeat * piece_end(piece);
  const bool last = piece + 1 == stage_.reference().turns().size();
  std::vector<double> inside(x.size());
  double t = repeat * stage_.reference().turns()[piece];
  if (stage_.reads_drive()) stage_.turn_drive(evaluate(t, x.data(), rates_.data()).drive_slope >= 0.0);
  while (t < stop) {
    solver.start(t, x.data(), stop);
    auto outcome = CvodeSolver::Outcome::stepped;
    bool turned = false;
    while (outcome == CvodeSolver::Outcome::stepped && !turned) {
      outcome = solver.step();
      add_nodes(solver, std::exchange(t, solver.time()), out);
      // Two crossings within a step are none to the solver: just behind an event the drive may turn again.
      if (stage_.reads_drive() && outcome == CvodeSolver::Outcome::stepped) {
        const double slope = evaluate(solver.time(), solver.state(), rates_.data()).drive_slope;
        turned = slope != 0.0 && (slope > 0.0) != stage_.drive_rises();
        if (turned) stage_.turn_drive(slope > 0.0);
      }
      for (; sample_ < out.samples.size(); ++sample_) {
        const double when = repeat * static_cast<double>(sample_) / static_cast<double>(out.samples.size());
        if (when > solver.time() || (when >= stop && !last)) break;
        solver.at(std::max(when, solver.step_begin()), inside.data());
        out.samples[sample_] = evaluate(when, inside.data(), rates_.data()).displacement;
      }
    }
    t = outcome == CvodeSolver::Outcome::stopped ? stop : solver.time();
    std::copy_n(solver.state(), x.size(), x.begin());
    if (outcome == CvodeSolver::Outcome::event) stage_.turn_drive(solver.crossings()[0] > 0);
  }
}

double RepeatRun::correct(std::vector<double>& x, const std::vector<double>& end) const {
  double most = 0.0;
  std::size_t at = 0;
  for (std::size_t b = 0; b < stage_.blocks().size(); ++b) {
    const StateSpace& block = stage_.blocks()[b];
    const Eigen::Index n = eigen_index(block.order());
    if (n == 0) continue;
    Eigen::VectorXd defect(n);
    for (Eigen::Index i = 0; i < n; ++i)
      defect(i) = end[at + static_cast<std::size_t>(i)] - x[at + static_cast<std::size_t>(i)];
    const Eigen::VectorXd move = solve_lu(forgotten_[b], defect);
    for (Eigen::Index i = 0; i < n; ++i) {
      double& state = x[at + static_cast<std::size_t>(i)];
      most = std::max(most, std::abs(move(i)) / std::max(1.0, std::abs(state)));
      state += move(i);
    }
    at += block.order();
  }
  return most;
}

ContinuousRun RepeatRun::run(const PeriodicState& begin, std::size_t samples) {
  constexpr int kMaxRounds = 12;
  constexpr double kSettled = 2e-5;  // of the stroke; the next round leaves less than half of it
  ContinuousRun out{std::vector<double>(samples), {}};
  std::vector<double> x = first_states(begin);
  CvodeSolver solver = make_solver();
  for (int round = 0; round < kMaxRounds; ++round) {
    std::vector<double> end = x;
    sample_ = 0;
    out.nodes.clear();
    for (std::size_t piece = 0; piece < stage_.reference().turns().size(); ++piece)
      sample_piece(solver, piece, end, out);
    if (correct(x, end) < kSettled) break;
  }
  return out;
}

}  // namespace

double ContinuousRun::rms(const Reference& reference, double repeat_s, double lag_s) const {
  double sum = 0.0;
  for (const Node& node : nodes) {
    const double turns = (node.time_s - lag_s) / repeat_s;
    sum += node.share * std::pow(node.y - reference.value(turns - std::floor(turns)), 2);
  }
  return std::sqrt(sum);
}

std::optional<ContinuousRun> track_continuous(const Plant& plant, const Design& design,
                                              const Options& options, const PeriodicTracking& periodic,
                                              const PeriodicState& begin, std::size_t samples) {
  auto stage = DrivenStage::of(plant, design, options, periodic.frequency());
  if (!stage) return std::nullopt;
  return RepeatRun(std::move(*stage), periodic, options).run(begin, samples);
}

}  // namespace bodesmith::tracking
