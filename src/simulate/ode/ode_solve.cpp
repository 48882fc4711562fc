#include "simulate/ode/ode_solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "base/text.hpp"
#include "simulate/ode/cvode_solver.hpp"

namespace bodesmith::simulate {
namespace {

/// Clock edges of a sampled controller in (first, last). One that is a corner but for rounding is that
/// corner, and left out. `corners` are sorted.
std::vector<double> clock_edges(double first, double last, double period,
                                const std::vector<double>& corners) {
  std::vector<double> out;
  for (double k = 1.0; first + k * period < last; k += 1.0) {
    const double t = first + k * period;
    const auto near = std::lower_bound(corners.begin(), corners.end(), t - 1e-6 * period);
    if (near == corners.end() || *near > t + 1e-6 * period) out.push_back(t);
  }
  return out;
}

/// Times at which to start again, sorted, the end of the input last.
std::vector<double> stop_times(const OdeSystem& system) {
  const double first = system.input().begin();
  const double last = system.input().end();
  std::vector<double> out = system.corners();
  std::erase_if(out, [&](double t) { return t <= first || t >= last; });
  std::ranges::sort(out);
  if (system.sample_period() > 0.0) {
    const auto edges = clock_edges(first, last, system.sample_period(), out);
    out.insert(out.end(), edges.begin(), edges.end());
    std::ranges::sort(out);
  }
  out.erase(std::unique(out.begin(), out.end()), out.end());
  out.push_back(last);
  return out;
}

CvodeSolver make_solver(OdeSystem& system, const Options& options, double typical_stretch,
                        double shortest_detail_s) {
  CvodeProblem problem;
  problem.order = system.state().size();
  problem.rate = [&system](double t, const double* x, double* dx) { system.evaluate(t, x, dx); };
  // A closed loop has no first part: dense, by difference quotients.
  if (!system.in_loop()) {
    problem.newton = [&system](double t, const double* x, double gamma, double* b) {
      system.newton(t, x, gamma, b);
    };
  }
  problem.events = system.events();
  problem.event = [&system](double t, const double* x, double* g) { system.event_values(t, x, g); };
  const bool stiff = system.fastest_rate() * typical_stretch > 300.0;
  CvodeSolver solver(std::move(problem), stiff ? CvodeSolver::Method::bdf : CvodeSolver::Method::adams,
                     options.relative_tolerance, options.absolute_tolerance);
  // Without dynamics nothing else tells the solver how fine the signal is.
  if (!system.has_dynamics()) {
    solver.limit_step(shortest_detail_s);
  } else if (system.events() > 0) {
    solver.limit_step(16.0 * shortest_detail_s);
  }
  return solver;
}

/// Time must go on; a block that jumps when its input turns may turn its own input back in a loop.
class ChatterGuard {
 public:
  ChatterGuard(double begin, double shortest_detail_s) : begin_(begin), detail_s_(shortest_detail_s) {}
  /// Throws SolverFailure when too many events come at nearly one time.
  void event(double t) {
    constexpr std::size_t kEvents = 200;
    if (++count_ % kEvents != 0) return;
    if (t - begin_ < 1e-3 * detail_s_)
      throw SolverFailure(fmt::format("blocks switch to and fro without end at {:.6g} s", t));
    begin_ = t;
  }

 private:
  double begin_;
  double detail_s_;
  std::size_t count_ = 0;
};

/// Takes what is asked for from the solver's steps.
class OutputSampler {
 public:
  OutputSampler(OdeSystem& system, const CvodeSolver& solver, const OdeRequest& request)
      : system_(system), solver_(solver), request_(request), inside_(system.state().size()) {
    if (request.values != nullptr) request.values->resize(request.times.size());
    if (request.drive != nullptr) request.drive->resize(request.times.size());
  }

  void first(double t) {
    if (request_.values == nullptr || request_.times.empty() || request_.times.front() > t) return;
    take(system_.evaluate(t));
  }
  /// The last step; `stop`: where the stretch ends, `final`: nothing comes after it.
  void step(double stop, bool final) {
    if (request_.values != nullptr) values(!request_.right_limits || solver_.time() < stop || final);
    if (request_.dense != nullptr && solver_.time() > solver_.step_begin()) dense();
  }
  void corner(double t) {
    if (request_.dense != nullptr) request_.dense->corner(t);
  }

 private:
  double output_at(double t) {
    solver_.at(t, inside_.data());
    return system_.output(t, inside_.data());
  }
  void take(double value) {
    if (request_.drive != nullptr) (*request_.drive)[next_] = system_.drive();
    (*request_.values)[next_++] = value;
  }
  void values(bool to_end) {
    const double end = solver_.time();
    while (next_ < request_.times.size() &&
           (to_end ? request_.times[next_] <= end : request_.times[next_] < end))
      take(output_at(std::max(request_.times[next_], solver_.step_begin())));
  }
  /// Two pieces a step.
  void dense() {
    const HoldNodes& nodes = hold_nodes(kMaxDegree);
    const double begin = solver_.step_begin();
    const double end = solver_.time();
    const double middle = begin + 0.5 * (end - begin);
    for (const auto& [from, to] : {std::pair(begin, middle), std::pair(middle, end)}) {
      DenseSignal::Piece piece;
      piece.begin = from;
      piece.end = to;
      piece.degree = kMaxDegree;
      for (std::size_t i = 0; i < kMaxDegree; ++i)
        piece.nodes[i] = output_at(from + nodes.at[i] * (to - from));
      piece.nodes[kMaxDegree] = output_at(to);
      if (to > from) request_.dense->append(piece);
    }
  }

  OdeSystem& system_;
  const CvodeSolver& solver_;
  const OdeRequest& request_;
  std::vector<double> inside_;
  std::size_t next_ = 0;
};

double part_of_record(OdeSystem& system, double time) {
  const double first = system.input().begin();
  return (time - first) / (system.input().end() - first);
}

/// From t to `stop`, through the events between.
void solve_stretch(OdeSystem& system, CvodeSolver& solver, double t, double stop, bool final,
                   OutputSampler& output, ChatterGuard& chatter, Progress& progress, Stats& stats) {
  constexpr std::size_t kLookEvery = 4096;
  while (t < stop) {
    solver.start(t, system.state().data(), stop);
    auto outcome = CvodeSolver::Outcome::stepped;
    while (outcome == CvodeSolver::Outcome::stepped) {
      outcome = solver.step();
      if (solver.steps() % kLookEvery == 0) {
        stop_if_interrupted();
        progress.at(part_of_record(system, solver.time()));
      }
      if (solver.steps() > kMostSolverSteps)
        throw SolverFailure(
            fmt::format("more than {} steps at {} s of the record, where it asks for ever shorter ones",
                        kMostSolverSteps, rounded_text(solver.time())));
      output.step(stop, final);
    }
    t = outcome == CvodeSolver::Outcome::stopped ? stop : solver.time();
    std::copy_n(solver.state(), system.state().size(), system.state().begin());
    system.evaluate(t);
    system.commit();
    if (outcome == CvodeSolver::Outcome::event) {
      ++stats.events;
      chatter.event(t);
      system.restart(t, &solver.crossings());
      output.corner(t);
    }
  }
}

}  // namespace

void solve_ode(OdeSystem& system, const Options& options, const OdeRequest& request, Stats& stats,
               double shortest_detail_s) {
  const double first = system.input().begin();
  const double last = system.input().end();
  const double period = system.sample_period();
  const std::vector<double> stops = stop_times(system);
  CvodeSolver solver =
      make_solver(system, options, (last - first) / static_cast<double>(stops.size()), shortest_detail_s);
  OutputSampler output(system, solver, request);
  ChatterGuard chatter(first, shortest_detail_s);

  system.run_until(stops.front());
  if (period > 0.0) system.sample_controller(first);
  system.restart(first, nullptr);
  output.first(first);
  double t = first;
  Progress progress("simulation");
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const double stop = stops[i];
    if (i % 1024 == 0) {
      stop_if_interrupted();
      progress.at(part_of_record(system, t));
    }
    solve_stretch(system, solver, t, stop, i + 1 == stops.size(), output, chatter, progress, stats);
    t = stop;
    if (i + 1 == stops.size()) break;
    system.run_until(stops[i + 1]);
    const bool sampling = period > 0.0 && std::abs(std::remainder(stop - first, period)) < 1e-6 * period;
    if (sampling) system.sample_controller(stop);
    system.restart(stop, nullptr);
    output.corner(stop);
  }
  stats.steps += solver.steps();
  stats.evaluations += solver.evaluations();
  stats.restarts += solver.restarts();
}

}  // namespace bodesmith::simulate
