#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <stdexcept>
#include <vector>

namespace bodesmith::simulate {

/// x' = f(t, x) with event functions.
struct CvodeProblem {
  std::size_t order = 0;
  std::function<void(double t, const double* x, double* dx)> rate;
  /// Replaces b by the solution z of (I - gamma df/dx) z = b (bdf only). For problems whose structure makes
  /// that cheap: a chain's states in series are solved block by block, at a cost linear in their number. Empty: a dense
  /// solver and difference quotients.
  std::function<void(double t, const double* x, double gamma, double* b)> newton;
  /// Event functions, stopping where one crosses zero.
  std::size_t events = 0;
  std::function<void(double t, const double* x, double* g)> event;
};

/// An initial value problem that could not be solved.
class SolverFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// SUNDIALS CVODE behind a small door: one initial value problem, restarted as often as needed.
class CvodeSolver {
 public:
  enum class Method {
    adams,  ///< variable order to 12, fixed-point iteration: not stiff
    bdf,    ///< variable order to 5, Newton with the problem's own solver or a dense one: stiff
  };

  CvodeSolver(CvodeProblem problem, Method method, double relative_tolerance, double absolute_tolerance);
  ~CvodeSolver();
  CvodeSolver(CvodeSolver&&) noexcept;
  CvodeSolver& operator=(CvodeSolver&&) noexcept;

  /// Starts, or starts again, from x at time t; `stop` is not stepped over.
  void start(double t, const double* x, double stop);
  enum class Outcome { stepped, stopped, event };
  /// One internal step. Throws SolverFailure when CVODE gives up.
  Outcome step();
  double time() const;          ///< where the last step ended (at an event: the event)
  double step_begin() const;    ///< where it began
  const double* state() const;  ///< at time()
  /// State inside the last step, by the solver's own interpolation.
  void at(double t, double* x) const;
  /// After Outcome::event: +1/-1 for each function that crossed upwards/downwards, 0 otherwise.
  const std::vector<int>& crossings() const;

  /// Of the formulas: at most 5 (BDF) or 12 (Adams), which it is without this.
  void limit_order(int most);
  /// From the next start() on.
  void limit_step(double max_step);

  std::size_t steps() const;
  std::size_t evaluations() const;
  std::size_t restarts() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace bodesmith::simulate
