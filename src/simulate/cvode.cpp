#include "simulate/cvode.hpp"

#include <cvode/cvode.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bodesmith::simulate {

struct Cvode::Implementation {
  Problem problem;
  SUNContext context = nullptr;
  void* memory = nullptr;
  N_Vector x = nullptr;
  N_Vector scratch = nullptr;
  SUNMatrix matrix = nullptr;
  SUNLinearSolver linear = nullptr;
  SUNNonlinearSolver nonlinear = nullptr;
  double time = 0.0;
  double begin = 0.0;
  double stop = 0.0;
  double longest = 0.0;
  bool initialised = false;
  std::vector<double> row_major;
  std::vector<int> crossings;
  std::size_t steps = 0;
  std::size_t evaluations = 0;
  std::size_t restarts = 0;

  ~Implementation() {
    if (memory != nullptr) CVodeFree(&memory);
    if (nonlinear != nullptr) SUNNonlinSolFree(nonlinear);
    if (linear != nullptr) SUNLinSolFree(linear);
    if (matrix != nullptr) SUNMatDestroy(matrix);
    if (x != nullptr) N_VDestroy(x);
    if (scratch != nullptr) N_VDestroy(scratch);
    if (context != nullptr) SUNContext_Free(&context);
  }

  static int rate(double t, N_Vector x, N_Vector dx, void* self) {
    auto& me = *static_cast<Implementation*>(self);
    ++me.evaluations;
    me.problem.rate(t, N_VGetArrayPointer(x), N_VGetArrayPointer(dx));
    return 0;
  }
  static int jacobian(double t, N_Vector x, N_Vector, SUNMatrix j, void* self, N_Vector, N_Vector, N_Vector) {
    auto& me = *static_cast<Implementation*>(self);
    const auto n = static_cast<std::size_t>(me.problem.order);
    me.row_major.assign(n * n, 0.0);
    me.problem.jacobian(t, N_VGetArrayPointer(x), me.row_major.data());
    double* data = SUNDenseMatrix_Data(j);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < n; ++k) data[k * n + i] = me.row_major[i * n + k];
    }
    return 0;
  }
  /// CVODE hands over no matrix: the solver asks where it stands and works on the problem's own structure.
  static int newton(SUNLinearSolver self, SUNMatrix, N_Vector z, N_Vector b, realtype) {
    auto& me = *static_cast<Implementation*>(self->content);
    realtype t = 0.0, gamma = 0.0, rl1 = 0.0;
    N_Vector predicted = nullptr, x = nullptr, rate_there = nullptr, zn1 = nullptr;
    void* user = nullptr;
    const int flag =
        CVodeGetNonlinearSystemData(me.memory, &t, &predicted, &x, &rate_there, &gamma, &rl1, &zn1, &user);
    if (flag < 0) return flag;
    N_VScale(1.0, b, z);
    me.problem.newton(t, N_VGetArrayPointer(x), gamma, N_VGetArrayPointer(z));
    return 0;
  }
  SUNLinearSolver own_solver() {
    SUNLinearSolver out = SUNLinSolNewEmpty(context);
    if (out == nullptr) return out;
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
  static int event(double t, N_Vector x, double* g, void* self) {
    auto& me = *static_cast<Implementation*>(self);
    me.problem.event(t, N_VGetArrayPointer(x), g);
    return 0;
  }
};

namespace {

void check(int flag, const char* what) {
  if (flag < 0) throw std::runtime_error(fmt::format("CVODE gave up in {} (code {})", what, flag));
}

/// The solver's own messages would go to stderr; its codes are enough.
void silent(int, const char*, const char*, char*, void*) {}

}  // namespace

Cvode::Cvode(Problem problem, Method method, double relative_tolerance, double absolute_tolerance)
    : implementation_(std::make_unique<Implementation>()) {
  auto& me = *implementation_;
  me.problem = std::move(problem);
  const int n = me.problem.order;
  check(SUNContext_Create(nullptr, &me.context), "SUNContext_Create");
  me.memory = CVodeCreate(method == Method::adams ? CV_ADAMS : CV_BDF, me.context);
  me.x = N_VNew_Serial(n, me.context);
  me.scratch = N_VNew_Serial(n, me.context);
  if (me.memory == nullptr || me.x == nullptr || me.scratch == nullptr)
    throw std::runtime_error("CVODE could not be set up");
  check(CVodeSetErrHandlerFn(me.memory, silent, nullptr), "CVodeSetErrHandlerFn");
  N_VConst(0.0, me.x);
  check(CVodeInit(me.memory, Implementation::rate, 0.0, me.x), "CVodeInit");
  check(CVodeSStolerances(me.memory, relative_tolerance, absolute_tolerance), "CVodeSStolerances");
  check(CVodeSetUserData(me.memory, &me), "CVodeSetUserData");
  check(CVodeSetMaxNumSteps(me.memory, 100000000), "CVodeSetMaxNumSteps");
  if (method == Method::adams) {
    me.nonlinear = SUNNonlinSol_FixedPoint(me.x, 0, me.context);
    check(CVodeSetNonlinearSolver(me.memory, me.nonlinear), "CVodeSetNonlinearSolver");
  } else if (me.problem.newton) {
    me.linear = me.own_solver();
    check(CVodeSetLinearSolver(me.memory, me.linear, nullptr), "CVodeSetLinearSolver");
  } else {
    me.matrix = SUNDenseMatrix(n, n, me.context);
    me.linear = SUNLinSol_Dense(me.x, me.matrix, me.context);
    check(CVodeSetLinearSolver(me.memory, me.linear, me.matrix), "CVodeSetLinearSolver");
    if (me.problem.jacobian) check(CVodeSetJacFn(me.memory, Implementation::jacobian), "CVodeSetJacFn");
  }
  if (me.problem.events > 0) {
    check(CVodeRootInit(me.memory, me.problem.events, Implementation::event), "CVodeRootInit");
    check(CVodeSetNoInactiveRootWarn(me.memory), "CVodeSetNoInactiveRootWarn");
    me.crossings.resize(static_cast<std::size_t>(me.problem.events));
  }
}

Cvode::~Cvode() = default;

void Cvode::start(double t, const double* x, double stop) {
  auto& me = *implementation_;
  std::copy_n(x, me.problem.order, N_VGetArrayPointer(me.x));
  check(CVodeReInit(me.memory, t, me.x), "CVodeReInit");
  check(CVodeSetStopTime(me.memory, stop), "CVodeSetStopTime");
  if (me.longest > 0.0) check(CVodeSetMaxStep(me.memory, me.longest), "CVodeSetMaxStep");
  me.time = me.begin = t;
  me.stop = stop;
  ++me.restarts;
}

Cvode::Outcome Cvode::step() {
  auto& me = *implementation_;
  me.begin = me.time;
  const int flag = CVode(me.memory, me.stop, me.x, &me.time, CV_ONE_STEP);
  check(flag, "a step");
  ++me.steps;
  if (flag == CV_ROOT_RETURN) {
    check(CVodeGetRootInfo(me.memory, me.crossings.data()), "CVodeGetRootInfo");
    return Outcome::event;
  }
  if (flag == CV_TSTOP_RETURN || me.time >= me.stop) return Outcome::stopped;
  return Outcome::stepped;
}

double Cvode::time() const {
  return implementation_->time;
}
double Cvode::step_begin() const {
  return implementation_->begin;
}
const double* Cvode::state() const {
  return N_VGetArrayPointer(implementation_->x);
}

void Cvode::at(double t, double* x) const {
  auto& me = *implementation_;
  if (CVodeGetDky(me.memory, t, 0, me.scratch) < 0) {
    std::copy_n(N_VGetArrayPointer(me.x), me.problem.order, x);  // only a rounding beyond the end of the step
    return;
  }
  std::copy_n(N_VGetArrayPointer(me.scratch), me.problem.order, x);
}

const std::vector<int>& Cvode::crossings() const {
  return implementation_->crossings;
}
void Cvode::limit_step(double longest) {
  implementation_->longest = longest;
}
std::size_t Cvode::steps() const {
  return implementation_->steps;
}
std::size_t Cvode::evaluations() const {
  return implementation_->evaluations;
}
std::size_t Cvode::restarts() const {
  return implementation_->restarts;
}

}  // namespace bodesmith::simulate
