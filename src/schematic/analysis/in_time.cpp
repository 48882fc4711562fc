#include "schematic/analysis/in_time.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "numeric/linear_algebra/sparse_lu.hpp"
#include "simulate/ode/cvode_solver.hpp"

namespace bodesmith::schematic {
namespace {

constexpr double kLeastFarad = 1e-15, kLeastOhm = 1.0;
constexpr Hertz kFastest{1e7};

/// Op-amps with an output resistance, however small; ideal ones no faster than leaves the equations regular (some 1e-4 of what
/// they do below a kilohertz).
Netlist with_states(Netlist netlist) {
  const auto with_state = [](OpAmpModel& model) {
    model.output_resistance_ohm = std::max(model.output_resistance_ohm, kLeastOhm);
    if (!model.is_ideal) return;
    model.gain_bandwidth = kFastest;
    model.output_resistance_ohm = 50.0;
  };
  with_state(netlist.opamp);
  std::ranges::for_each(netlist.other_opamps, with_state);
  return netlist;
}

Assumptions switching(Assumptions out) {
  out.switching = true;
  return out;
}

using Sparse = Eigen::SparseMatrix<double>;

}  // namespace

struct InTime::Implementation {
  /// Solves with matrices of one pattern that change little from one to the next: an LU is kept as long as a few corrections
  /// with it bring what is left to `share` of the right side, rows scaled to about 1.
  class KeptLu {
   public:
    Eigen::VectorXd solve(const Sparse& a, const Eigen::VectorXd& b, double share) {
      if (known_) {
        Eigen::VectorXd x = lu_.solve(b);
        const double wanted = share * scale_.cwiseProduct(b).lpNorm<Eigen::Infinity>();
        for (int i = 0; i < kMostCorrections; ++i) {
          const Eigen::VectorXd left = b - a * x;
          if (scale_.cwiseProduct(left).lpNorm<Eigen::Infinity>() <= wanted) return x;
          x += lu_.solve(left);
        }
      }
      known_ = lu_.factorise(a);
      if (!known_) return Eigen::VectorXd::Constant(b.size(), std::numeric_limits<double>::quiet_NaN());
      scale_ = Eigen::VectorXd::Zero(a.rows());
      for (Eigen::Index k = 0; k < a.outerSize(); ++k) {
        for (Sparse::InnerIterator at(a, k); at; ++at)
          scale_(at.row()) = std::max(scale_(at.row()), std::abs(at.value()));
      }
      scale_ = scale_.cwiseInverse().eval();
      return lu_.solve(b);
    }

   private:
    static constexpr int kMostCorrections = 3;
    bool known_ = false;
    Eigen::VectorXd scale_;
    SparseLu<double> lu_;
  };

  Implementation(const Netlist& given, Input input_of_time, const Assumptions& assumptions)
      : netlist(with_states(given)),
        equations(netlist, switching(assumptions)),
        input(std::move(input_of_time)) {
    const auto n = static_cast<std::size_t>(equations.unknowns());
    f.resize(n);
    q.resize(n);
    is_held.resize(n, false);
    for (const Equations::Held& one : equations.held()) is_held[static_cast<std::size_t>(one.node)] = true;
    make_pattern();
    simulate::CvodeProblem problem;
    problem.order = n;
    problem.rate = [this](double t, const double* x, double* dx) { rate(t, x, dx); };
    problem.newton = [this](double t, const double* x, double gamma, double* b) { newton(t, x, gamma, b); };
    solver = std::make_unique<simulate::CvodeSolver>(problem, simulate::CvodeSolver::Method::bdf, kRelative,
                                                     kAbsolute);
  }

  /// Elements stamp the same places in the same order whatever the point.
  void make_pattern() {
    const std::vector<double> rest(f.size(), 0.0);
    equations.evaluate({rest, 0.0, rest}, f, q, slopes);
    std::vector<Eigen::Triplet<double>> all;
    for (const Stamps::Slope& one : slopes) {
      if (one.column != kInput) all.emplace_back(one.row, one.column, 1.0);
    }
    for (int i = 0; i < equations.nodes(); ++i) all.emplace_back(i, i, 1.0);
    for (const Equations::Held& one : equations.held()) {
      all.emplace_back(one.node, one.branch, 1.0);
      all.emplace_back(one.branch, one.node, 1.0);
    }
    const auto n = equations.unknowns();
    mass.resize(n, n);
    mass.setFromTriplets(all.begin(), all.end());
    mass.makeCompressed();
    stiffness = matrix = mass;
    const auto place = [&](int row, int column) { return &mass.coeffRef(row, column) - mass.valuePtr(); };
    for (const Stamps::Slope& one : slopes)
      places.push_back(one.column == kInput || is_held[static_cast<std::size_t>(one.row)]
                           ? -1
                           : place(one.row, one.column));
    for (int i = 0; i < equations.nodes(); ++i)
      diagonal.push_back(is_held[static_cast<std::size_t>(i)] ? -1 : place(i, i));
    for (const Equations::Held& one : equations.held())
      held.push_back({place(one.node, one.branch), place(one.branch, one.node)});
  }

  /// M x' = r at (t, x): M with what makes it regular, and the slopes that `rates` leave.
  void assemble(double t, const double* x, std::span<const double> rates) {
    const auto n = f.size();
    equations.evaluate({{x, n}, input(t), rates}, f, q, slopes);
    std::fill_n(mass.valuePtr(), mass.nonZeros(), 0.0);
    std::fill_n(stiffness.valuePtr(), stiffness.nonZeros(), 0.0);
    right.resize(equations.unknowns());
    // The slope of the input on the side of the corner that is being integrated.
    const double look = kLook * (end - begun), ahead = std::min(t + look, end),
                 behind = std::max(t - look, begun);
    const double input_slope = (input(ahead) - input(behind)) / (ahead - behind);
    for (std::size_t i = 0; i < n; ++i) right(static_cast<Eigen::Index>(i)) = is_held[i] ? 0.0 : -f[i];
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      const Stamps::Slope& one = slopes[k];
      if (one.column == kInput) {
        right(one.row) -= one.q * input_slope;
      } else if (places[k] >= 0) {
        mass.valuePtr()[places[k]] += one.q;
        stiffness.valuePtr()[places[k]] += one.f;
      }
    }
    for (const auto at : diagonal) {
      if (at >= 0) mass.valuePtr()[at] += kLeastFarad;
    }
    for (const auto& [current, voltage] : held) {
      // The node moves as its source says, the current is left as it is.
      mass.valuePtr()[current] = 1.0;
      if (mass.valuePtr()[voltage] == 0.0) mass.valuePtr()[voltage] = kStill;
    }
  }

  void rate(double t, const double* x, double* dx) {
    assemble(t, x, {});
    last_rate = of_mass.solve(mass, right, kExact);
    std::copy_n(last_rate.data(), last_rate.size(), dx);
  }

  void newton(double t, const double* x, double gamma, double* b) {
    const auto n = equations.unknowns();
    assemble(t, x, {last_rate.data(), static_cast<std::size_t>(n)});
    Eigen::Map<Eigen::VectorXd> at(b, n);
    const Eigen::VectorXd wanted = mass * at;
    for (Eigen::Index i = 0; i < mass.nonZeros(); ++i)
      matrix.valuePtr()[i] = mass.valuePtr()[i] + gamma * stiffness.valuePtr()[i];
    at = of_matrix.solve(matrix, wanted, kEnough);
  }

  /// Ten times as much and a comparator that a smooth input brings slowly to its threshold trips up to 4 % of its delay late.
  static constexpr double kRelative = 1e-7, kAbsolute = 1e-8;
  static constexpr double kLook = 1e-6;  ///< of a piece between corners, for the input's slope
  static constexpr double kExact = 1e-13, kEnough = 1e-3;
  static constexpr double kStill = 1e-9;  ///< s: how soon a source has its voltage

  Netlist netlist;
  Equations equations;
  Input input;
  std::vector<double> f, q;
  std::vector<Stamps::Slope> slopes;
  std::vector<bool> is_held;
  std::vector<std::ptrdiff_t> places, diagonal;  ///< in the matrices' values; -1: none
  struct Held {
    std::ptrdiff_t current, voltage;
  };
  std::vector<Held> held;
  Sparse mass, stiffness, matrix;
  KeptLu of_mass, of_matrix;
  Eigen::VectorXd right, last_rate;
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
  const auto set = [&it](const std::string& node, double value) {
    if (const int at = it.equations.node(node); at >= 0) it.state[static_cast<std::size_t>(at)] = value;
  };
  for (const auto& [node, value] : volts) set(node, value);
  for (const Source& one : it.netlist.sources) set(one.node, one.volts);
  it.begun = t;
}

void InTime::run_to(double stop, const std::function<void(double from, double to)>& step) {
  // From one turn of a reference to the next controllers take some ten thousand: more is a switch that chatters.
  constexpr int kMostSteps = 100'000;
  Implementation& it = *implementation_;
  it.end = stop;
  int steps = 0;
  try {
    it.solver->start(it.begun, it.state.data(), stop);
    for (auto outcome = simulate::CvodeSolver::Outcome::stepped;
         outcome == simulate::CvodeSolver::Outcome::stepped;) {
      stop_if_interrupted();
      outcome = it.solver->step();
      if (step) step(it.solver->step_begin(), it.solver->time());
      if (++steps == kMostSteps)
        throw simulate::SolverFailure(
            fmt::format("{} steps have come to {} s only", steps, it.solver->time()));
    }
  } catch (const simulate::SolverFailure& failure) {
    throw DesignError(fmt::format("the circuit cannot be followed in time from {} to {} s: {}", it.begun,
                                  stop, failure.what()));
  }
  it.state.assign(it.solver->state(), it.solver->state() + it.state.size());
  it.begun = stop;
}

std::optional<double> InTime::rises(const std::string& node, double stop) {
  std::optional<double> out;
  run_to(stop, [&](double from, double to) {
    if (out || !(volts(node, from) < 0.0) || volts(node, to) < 0.0) return;
    for (int i = 0; i < 60 && from < to; ++i) {
      const double middle = 0.5 * (from + to);
      (volts(node, middle) < 0.0 ? from : to) = middle;
    }
    out = to;
  });
  return out;
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
