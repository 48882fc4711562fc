#include "simulate/ode/cvode_solver.hpp"

#include <cvode/cvode.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <type_traits>

namespace bodesmith::simulate {

/// SUNDIALS' objects are pointers, each kind with a function that frees it.
namespace sundials {

struct Free {
  void operator()(SUNContext p) const { SUNContext_Free(&p); }
  void operator()(void* p) const { CVodeFree(&p); }
  void operator()(N_Vector p) const { N_VDestroy(p); }
  void operator()(SUNMatrix p) const { SUNMatDestroy(p); }
  void operator()(SUNLinearSolver p) const { SUNLinSolFree(p); }
  void operator()(SUNNonlinearSolver p) const { SUNNonlinSolFree(p); }
};
template <class Pointer>
using Owned = std::unique_ptr<std::remove_pointer_t<Pointer>, Free>;
using Context = Owned<SUNContext>;
using Memory = Owned<void*>;
using Vector = Owned<N_Vector>;
using Matrix = Owned<SUNMatrix>;
using LinearSolver = Owned<SUNLinearSolver>;
using NonlinearSolver = Owned<SUNNonlinearSolver>;

}  // namespace sundials

namespace {

void expect_success(int flag, const char* what) {
  if (flag < 0) throw SolverFailure(fmt::format("CVODE gave up in {} (code {})", what, flag));
}

sundials::Context new_context() {
  SUNContext out = nullptr;
  expect_success(SUNContext_Create(nullptr, &out), "SUNContext_Create");
  return sundials::Context(out);
}

/// The solver's own messages would go to stderr; its codes are enough.
void silent(int, const char*, const char*, char*, void*) {}

}  // namespace

struct CvodeSolver::Implementation {
  // Freed in the reverse order: what uses an object before the object.
  CvodeProblem problem;
  sundials::Context context = new_context();
  sundials::Vector x;
  sundials::Vector scratch;
  sundials::Matrix matrix;
  sundials::LinearSolver linear;
  sundials::NonlinearSolver nonlinear;
  sundials::Memory memory;
  double time = 0.0;
  double begin = 0.0;
  double stop = 0.0;
  double max_step = 0.0;
  std::vector<int> crossings;
  std::size_t steps = 0;
  std::size_t evaluations = 0;
  std::size_t restarts = 0;
  long failures = 0;  ///< of steps tried
  int lame = 0;       ///< steps one after another of the first order, each after a failure

  explicit Implementation(CvodeProblem wanted) : problem(std::move(wanted)) {}

  static int rate(double t, N_Vector x, N_Vector dx, void* self) {
    auto& me = *static_cast<Implementation*>(self);
    ++me.evaluations;
    me.problem.rate(t, N_VGetArrayPointer(x), N_VGetArrayPointer(dx));
    return 0;
  }
  /// CVODE hands over no matrix: the solver asks where it stands and works on the problem's own structure.
  static int newton(SUNLinearSolver self, SUNMatrix, N_Vector z, N_Vector b, realtype) {
    auto& me = *static_cast<Implementation*>(self->content);
    realtype t = 0.0, gamma = 0.0, rl1 = 0.0;
    N_Vector predicted = nullptr, x = nullptr, rate_there = nullptr, zn1 = nullptr;
    void* user = nullptr;
    const int flag = CVodeGetNonlinearSystemData(me.memory.get(), &t, &predicted, &x, &rate_there, &gamma,
                                                 &rl1, &zn1, &user);
    if (flag < 0) return flag;
    N_VScale(1.0, b, z);
    me.problem.newton(t, N_VGetArrayPointer(x), gamma, N_VGetArrayPointer(z));
    return 0;
  }
  static int event(double t, N_Vector x, double* g, void* self) {
    auto& me = *static_cast<Implementation*>(self);
    me.problem.event(t, N_VGetArrayPointer(x), g);
    return 0;
  }

  sundials::LinearSolver own_solver() {
    sundials::LinearSolver out(SUNLinSolNewEmpty(context.get()));
    if (out == nullptr) throw SolverFailure("CVODE could not be set up");
    out->content = this;
    out->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_MATRIX_EMBEDDED; };
    out->ops->solve = newton;
    out->ops->free = [](SUNLinearSolver solver) {
      solver->content = nullptr;
      SUNLinSolFreeEmpty(solver);
      return 0;
    };
    return out;
  }

  void create(Method method, double relative_tolerance, double absolute_tolerance) {
    const auto n = static_cast<sunindextype>(problem.order);
    memory.reset(CVodeCreate(method == Method::adams ? CV_ADAMS : CV_BDF, context.get()));
    x.reset(N_VNew_Serial(n, context.get()));
    scratch.reset(N_VNew_Serial(n, context.get()));
    if (x != nullptr) N_VEnableFusedOps_Serial(x.get(), SUNTRUE);  // several sums in one pass
    if (memory == nullptr || x == nullptr || scratch == nullptr)
      throw SolverFailure("CVODE could not be set up");
    expect_success(CVodeSetErrHandlerFn(memory.get(), silent, nullptr), "CVodeSetErrHandlerFn");
    N_VConst(0.0, x.get());
    expect_success(CVodeInit(memory.get(), rate, 0.0, x.get()), "CVodeInit");
    expect_success(CVodeSStolerances(memory.get(), relative_tolerance, absolute_tolerance),
                   "CVodeSStolerances");
    expect_success(CVodeSetUserData(memory.get(), this), "CVodeSetUserData");
    // Above order two the formulas are unstable for oscillations that hardly decay (op-amps of little phase margin), and the step ends at
    // what they bear: the order goes down where that is seen.
    if (method == Method::bdf)
      expect_success(CVodeSetStabLimDet(memory.get(), SUNTRUE), "CVodeSetStabLimDet");
    expect_success(CVodeSetMaxNumSteps(memory.get(), 100000000), "CVodeSetMaxNumSteps");
    // From the steps of a reference that moves in milliseconds to those of a comparator that trips in nanoseconds.
    constexpr int kMostTrials = 60;
    expect_success(CVodeSetMaxErrTestFails(memory.get(), kMostTrials), "CVodeSetMaxErrTestFails");
    expect_success(CVodeSetMaxConvFails(memory.get(), kMostTrials), "CVodeSetMaxConvFails");
  }

  void choose_algebra(Method method) {
    const auto n = static_cast<sunindextype>(problem.order);
    if (method == Method::adams) {
      nonlinear.reset(SUNNonlinSol_FixedPoint(x.get(), 0, context.get()));
      expect_success(CVodeSetNonlinearSolver(memory.get(), nonlinear.get()), "CVodeSetNonlinearSolver");
    } else if (problem.newton) {
      linear = own_solver();
      expect_success(CVodeSetLinearSolver(memory.get(), linear.get(), nullptr), "CVodeSetLinearSolver");
    } else {
      matrix.reset(SUNDenseMatrix(n, n, context.get()));
      linear.reset(SUNLinSol_Dense(x.get(), matrix.get(), context.get()));
      expect_success(CVodeSetLinearSolver(memory.get(), linear.get(), matrix.get()), "CVodeSetLinearSolver");
    }
  }

  void begin_at(double t) {
    expect_success(CVodeReInit(memory.get(), t, x.get()), "CVodeReInit");
    expect_success(CVodeSetStopTime(memory.get(), stop), "CVodeSetStopTime");
    time = begin = t;
    failures = lame = 0;
  }

  /// CVODE raises the order after two steps of which no trial failed. Where a ten times longer step always fails (what follows a
  /// slope is off by the step's length times the curvature at the first order, and jumps with it) that never comes: it goes on
  /// with every second trial in vain, at a step that only the first order needs. From a new beginning it gets past.
  void watch_order() {
    constexpr int kLame = 20;
    int order = 0;
    long failed = 0;
    expect_success(CVodeGetLastOrder(memory.get(), &order), "CVodeGetLastOrder");
    expect_success(CVodeGetNumErrTestFails(memory.get(), &failed), "CVodeGetNumErrTestFails");
    lame = order > 1 ? 0 : lame + (failed > failures ? 1 : 0);
    failures = failed;
    if (lame == kLame) begin_at(time);
  }

  void watch_events() {
    if (problem.events == 0) return;
    expect_success(CVodeRootInit(memory.get(), static_cast<int>(problem.events), event), "CVodeRootInit");
    expect_success(CVodeSetNoInactiveRootWarn(memory.get()), "CVodeSetNoInactiveRootWarn");
    crossings.resize(problem.events);
  }
};

CvodeSolver::CvodeSolver(CvodeProblem problem, Method method, double relative_tolerance,
                         double absolute_tolerance)
    : implementation_(std::make_unique<Implementation>(std::move(problem))) {
  implementation_->create(method, relative_tolerance, absolute_tolerance);
  implementation_->choose_algebra(method);
  implementation_->watch_events();
}

CvodeSolver::~CvodeSolver() = default;
CvodeSolver::CvodeSolver(CvodeSolver&&) noexcept = default;
CvodeSolver& CvodeSolver::operator=(CvodeSolver&&) noexcept = default;

void CvodeSolver::start(double t, const double* x, double stop) {
  auto& me = *implementation_;
  std::copy_n(x, me.problem.order, N_VGetArrayPointer(me.x.get()));
  me.stop = stop;
  me.begin_at(t);
  if (me.max_step > 0.0) expect_success(CVodeSetMaxStep(me.memory.get(), me.max_step), "CVodeSetMaxStep");
  ++me.restarts;
}

CvodeSolver::Outcome CvodeSolver::step() {
  auto& me = *implementation_;
  if (me.steps > 0) me.watch_order();
  me.begin = me.time;
  const int flag = CVode(me.memory.get(), me.stop, me.x.get(), &me.time, CV_ONE_STEP);
  expect_success(flag, "a step");
  ++me.steps;
  if (flag == CV_ROOT_RETURN) {
    expect_success(CVodeGetRootInfo(me.memory.get(), me.crossings.data()), "CVodeGetRootInfo");
    return Outcome::event;
  }
  if (flag == CV_TSTOP_RETURN || me.time >= me.stop) return Outcome::stopped;
  return Outcome::stepped;
}

double CvodeSolver::time() const {
  return implementation_->time;
}
double CvodeSolver::step_begin() const {
  return implementation_->begin;
}
const double* CvodeSolver::state() const {
  return N_VGetArrayPointer(implementation_->x.get());
}

void CvodeSolver::at(double t, double* x) const {
  auto& me = *implementation_;
  // It only fails for a rounding beyond the end of the step.
  const bool inside = CVodeGetDky(me.memory.get(), t, 0, me.scratch.get()) >= 0;
  std::copy_n(N_VGetArrayPointer(inside ? me.scratch.get() : me.x.get()), me.problem.order, x);
}

const std::vector<int>& CvodeSolver::crossings() const {
  return implementation_->crossings;
}
void CvodeSolver::limit_order(int most) {
  expect_success(CVodeSetMaxOrd(implementation_->memory.get(), most), "CVodeSetMaxOrd");
}
void CvodeSolver::limit_step(double max_step) {
  implementation_->max_step = max_step;
}
std::size_t CvodeSolver::steps() const {
  return implementation_->steps;
}
std::size_t CvodeSolver::evaluations() const {
  return implementation_->evaluations;
}
std::size_t CvodeSolver::restarts() const {
  return implementation_->restarts;
}

}  // namespace bodesmith::simulate
