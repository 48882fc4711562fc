#include "schematic/analysis/in_time.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "simulate/cvode_solver.hpp"

namespace bodesmith::schematic {
namespace {

constexpr double kLeastFarad = 1e-15, kLeastOhm = 1.0;
constexpr Hertz kFastest{1e7};

/// Op-amps with an output resistance, however small; ideal ones no faster than leaves the equations regular (some 1e-4 of what
/// they do below a kilohertz).
Netlist with_states(Netlist netlist) {
  for (OpAmpModel* model : {&netlist.opamp, &netlist.fast_opamp}) {
    model->output_resistance_ohm = std::max(model->output_resistance_ohm, kLeastOhm);
    if (!model->is_ideal) continue;
    model->gain_bandwidth = kFastest;
    model->output_resistance_ohm = 50.0;
  }
  return netlist;
}

}  // namespace

struct InTime::Implementation {
  Implementation(const Netlist& given, Input input_of_time, const Assumptions& assumptions)
      : netlist(with_states(given)), equations(netlist, assumptions), input(std::move(input_of_time)) {
    const auto n = static_cast<std::size_t>(equations.unknowns());
    f.resize(n);
    q.resize(n);
    int branch = static_cast<int>(equations.nodes() + static_cast<Eigen::Index>(netlist.opamps.size()));
    const auto hold = [&](const std::string& node) { held.push_back({equations.node(node), branch++}); };
    for (const Multiplier& one : netlist.multipliers) hold(one.out);
    for (const Source& one : netlist.sources) {
      if (one.node != assumptions.input) hold(one.node);
    }
    simulate::CvodeProblem problem;
    problem.order = n;
    problem.rate = [this](double t, const double* x, double* dx) { rate(t, x, dx); };
    problem.jacobian = [this](double t, const double* x, double* j) { jacobian(t, x, j); };
    solver = std::make_unique<simulate::CvodeSolver>(problem, simulate::CvodeSolver::Method::bdf, 1e-7, 1e-9);
  }

  /// M x' = r at (t, x): M with what makes it regular.
  void assemble(double t, const double* x, Eigen::MatrixXd* g) {
    const auto n = equations.unknowns();
    equations.evaluate({{x, static_cast<std::size_t>(n)}, input(t)}, f, q, slopes);
    m.setZero(n, n);
    right.resize(n);
    if (g != nullptr) g->setZero(n, n);
    // The slope of the input on the side of the corner that is being integrated.
    const double look = kLook * (end - begun), ahead = std::min(t + look, end),
                 behind = std::max(t - look, begun);
    const double input_slope = (input(ahead) - input(behind)) / (ahead - behind);
    for (Eigen::Index i = 0; i < n; ++i) right(i) = -f[static_cast<std::size_t>(i)];
    for (const Stamps::Slope& one : slopes) {
      if (one.column == kInput) {
        right(one.row) -= one.q * input_slope;
        continue;
      }
      m(one.row, one.column) += one.q;
      if (g != nullptr) (*g)(one.row, one.column) += one.f;
    }
    for (Eigen::Index i = 0; i < equations.nodes(); ++i) m(i, i) += kLeastFarad;
    for (const auto& [node, branch] : held) {
      // The node moves as its source says, the current is left as it is.
      m.row(node).setZero();
      m(node, branch) = 1.0;
      right(node) = 0.0;
      if (g != nullptr) g->row(node).setZero();
      if (m(branch, node) == 0.0) m(branch, node) = kStill;  // a voltage that does not change
    }
  }

  void rate(double t, const double* x, double* dx) {
    assemble(t, x, nullptr);
    Eigen::Map<Eigen::VectorXd>(dx, right.size()) = m.partialPivLu().solve(right);
  }

  void jacobian(double t, const double* x, double* j) {
    assemble(t, x, &slope);
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(j, slope.rows(), slope.cols()) = -m.partialPivLu().solve(slope);
  }

  static constexpr double kLook = 1e-6;   ///< of a piece between corners, for the input's slope
  static constexpr double kStill = 1e-9;  ///< s: how soon a source has its voltage

  Netlist netlist;
  Equations equations;
  Input input;
  std::vector<double> f, q;
  std::vector<Stamps::Slope> slopes;
  struct Held {
    int node, branch;
  };
  std::vector<Held> held;  ///< nodes of ideal sources and the rows of their currents
  Eigen::MatrixXd m, slope;
  Eigen::VectorXd right;
  std::vector<double> state;
  double begun = 0.0, end = 1.0;
  std::unique_ptr<simulate::CvodeSolver> solver;
};

InTime::InTime(const Netlist& netlist, Input input, const Assumptions& assumptions)
    : implementation_(std::make_unique<Implementation>(netlist, std::move(input), assumptions)) {}
InTime::~InTime() = default;

void InTime::begin(double t, const std::map<std::string, double>& volts) {
  Implementation& it = *implementation_;
  it.state.assign(static_cast<std::size_t>(it.equations.unknowns()), 0.0);
  for (const auto& [node, value] : volts) it.state[static_cast<std::size_t>(it.equations.node(node))] = value;
  for (const Source& one : it.netlist.sources) {
    if (const int at = it.equations.node(one.node); at >= 0)
      it.state[static_cast<std::size_t>(at)] = one.volts;
  }
  it.begun = t;
}

void InTime::run_to(double stop, const std::function<void(double from, double to)>& step) {
  Implementation& it = *implementation_;
  it.end = stop;
  it.solver->start(it.begun, it.state.data(), stop);
  for (auto outcome = simulate::CvodeSolver::Outcome::stepped;
       outcome == simulate::CvodeSolver::Outcome::stepped;) {
    stop_if_interrupted();
    outcome = it.solver->step();
    if (step) step(it.solver->step_begin(), it.solver->time());
  }
  it.state.assign(it.solver->state(), it.solver->state() + it.state.size());
  it.begun = stop;
}

double InTime::volts(const std::string& node, double t) const {
  const Implementation& it = *implementation_;
  const int at = it.equations.node(node);
  if (at < 0) return at == kInput ? it.input(t) : 0.0;
  std::vector<double> x(it.state.size());
  it.solver->at(t, x.data());
  return x[static_cast<std::size_t>(at)];
}

}  // namespace bodesmith::schematic
