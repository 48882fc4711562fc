// The least squares of numeric/, Ceres and Eigen's MINPACK port on fits like those of diagnose: the same search coordinates and starts,
// forward differences, noise of 0.005. Prints runs of the model, time, and how often the fit ends at the noise; the table stands in
// docs/numeric.md. Built where Ceres is installed.
#include "numeric/optimisation/least_squares.hpp"
#include <ceres/ceres.h>
#include <ceres/dynamic_numeric_diff_cost_function.h>
#include <glog/logging.h>
#include <chrono>
#include <cstdio>
#include <functional>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>
#include "numeric/random.hpp"
using namespace bodesmith;
using Eigen::Index;
using Eigen::VectorXd;
static int runs = 0;
struct Problem {
  const char* name;
  std::vector<SearchVariable> truth;
  std::function<void(const VectorXd&, VectorXd&)> simulate;
  VectorXd measured;
};
static std::vector<double> input(int n) {
  std::vector<double> u(n);
  for (int i = 0; i < n; ++i) {
    double t = i * 1e-3;
    u[i] = 0.6 * std::sin(2 * M_PI * 1.3 * t) + 0.4 * std::sin(2 * M_PI * 7.1 * t + 1) +
           0.3 * std::sin(2 * M_PI * 23 * t + 2);
  }
  return u;
}
static void chain(const VectorXd& p, VectorXd& y) {  // lag, resonator, cubic, play
  static const auto u = input(4000);
  y.resize(4000);
  const double tau = p(0), w = p(1), z = p(2), c = p(4), r = std::max(0.0, p(5)), h = 1e-3 / 8;
  double x = 0, q = 0, v = 0, m = 0;
  for (int i = 0; i < 4000; ++i) {
    for (int k = 0; k < 8; ++k) {
      x += h * (u[i] - x) / tau;
      v += h * (w * w * (x - q * (1 + c * q * q)) - 2 * z * w * v);
      q += h * v;
    }
    m = std::clamp(m, q - r, q + r);
    y(i) = p(3) * m;
  }
}
static void plays(const VectorXd& p, VectorXd& y) {  // eight plays with weights >= 0 behind a lag
  static const auto u = input(4000);
  y.resize(4000);
  double m[8] = {}, x = 0;
  for (int i = 0; i < 4000; ++i) {
    x += 1e-3 * (u[i] - x) / p(8);
    double s = 0;
    for (int k = 0; k < 8; ++k) {
      double r = 0.1 * k;
      m[k] = std::clamp(m[k], x - r, x + r);
      s += p(k) * m[k];
    }
    y(i) = s;
  }
}
static void relaxation(const VectorXd& p, VectorXd& y) {
  y.resize(2000);
  for (int i = 0; i < 2000; ++i) {
    double t = i * 1e-3;
    y(i) = p(0) * std::exp(-t / p(1)) + p(2) * std::exp(-t / p(3)) + p(4) * std::exp(-t / p(5));
  }
}
static double to_s(const SearchVariable& u, double v) {
  return u.logarithmic ? std::log(v) : v / u.scale;
}
static double from_s(const SearchVariable& u, double s) {
  return std::clamp(u.logarithmic ? std::exp(std::clamp(s, -600.0, 600.0)) : s * u.scale, u.min, u.max);
}
struct InSearch {
  const Problem& p;
  const std::vector<SearchVariable>& start;
  void eval(const double* s, VectorXd& r) const {
    VectorXd x(start.size());
    for (Index j = 0; j < x.size(); ++j) x(j) = from_s(start[j], s[j]);
    ++runs;
    p.simulate(x, r);
    r -= p.measured;
    for (double& v : r)
      if (!std::isfinite(v)) v = 1e6;
  }
};
struct EigenFunctor {
  typedef double Scalar;
  typedef VectorXd InputType;
  typedef VectorXd ValueType;
  typedef Eigen::MatrixXd JacobianType;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };
  InSearch f;
  int m;
  int inputs() const { return int(f.start.size()); }
  int values() const { return m; }
  int operator()(const VectorXd& s, VectorXd& r) const {
    f.eval(s.data(), r);
    return 0;
  }
};
struct CeresFunctor {
  InSearch f;
  bool operator()(double const* const* s, double* r) const {
    VectorXd v;
    f.eval(s[0], v);
    Eigen::Map<VectorXd>(r, v.size()) = v;
    return v.allFinite();
  }
};
struct Score {
  double runs = 0, seconds = 0, worst = 0;
  int found = 0;
};
int main(int, char** argv) {
  google::InitGoogleLogging(argv[0]);
  FLAGS_minloglevel = 3;
  const double inf = std::numeric_limits<double>::infinity();
  auto lg = [](double v) { return SearchVariable{v, v * 1e-3, v * 1e3, true, 1.0}; };
  auto ln = [&](double v, double lo, double hi, double sc) { return SearchVariable{v, lo, hi, false, sc}; };
  std::vector<Problem> problems;
  problems.push_back(
      {"lag, resonator, cubic, play",
       {lg(0.01), lg(60), lg(0.2), ln(1.3, -inf, inf, 1), ln(0.3, 0, 5, 1), ln(0.1, 0, 2, 0.2)},
       chain,
       {}});
  std::vector<SearchVariable> w;
  for (int k = 0; k < 8; ++k) w.push_back(ln(k % 3 == 0 ? 0.4 : k % 3 == 1 ? 0.0 : 0.1, 0, 10, 1));
  w.push_back(lg(0.02));
  problems.push_back({"eight plays, weights >= 0", w, plays, {}});
  problems.push_back(
      {"three relaxations",
       {ln(1, -inf, inf, 1), lg(0.05), ln(0.5, -inf, inf, 1), lg(0.3), ln(0.8, -inf, inf, 1), lg(2)},
       relaxation,
       {}});
  for (auto& p : problems) {
    VectorXd x(p.truth.size());
    for (Index j = 0; j < x.size(); ++j) x(j) = p.truth[j].value;
    p.simulate(x, p.measured);
    Random noise(5);
    for (double& v : p.measured) v += 0.005 * noise.normal();
    const double floor = p.measured.size() * 0.005 * 0.005;
    Score s[4];
    const int trials = 20;
    for (int t = 0; t < trials; ++t) {
      Random random(100 + t);
      auto start = p.truth;
      for (auto& u : start)
        u.value = u.logarithmic ? u.value * std::exp(0.7 * random.normal())
                                : std::clamp(u.value + 0.5 * u.scale * random.normal(), u.min, u.max);
      VectorXd s0(start.size());
      for (Index j = 0; j < s0.size(); ++j) s0(j) = to_s(start[j], start[j].value);
      for (int method = 0; method < 4; ++method) {
        runs = 0;
        const auto begin = std::chrono::steady_clock::now();
        double cost = 0;
        if (method < 2) {
          cost = least_squares(start,
                               [&](const VectorXd& x, VectorXd& r) {
                                 ++runs;
                                 p.simulate(x, r);
                                 r -= p.measured;
                                 return r.allFinite();
                               },
                               {.max_iterations = 100, .broyden = method == 0})
                     .cost;
        } else if (method == 2) {
          VectorXd s1 = s0;
          auto* cost_function = new ceres::DynamicNumericDiffCostFunction<CeresFunctor, ceres::FORWARD>(
              new CeresFunctor{{p, start}}, ceres::TAKE_OWNERSHIP, [] {
                ceres::NumericDiffOptions o;
                o.relative_step_size = 1e-4;
                return o;
              }());
          cost_function->AddParameterBlock(int(s1.size()));
          cost_function->SetNumResiduals(int(p.measured.size()));
          ceres::Problem problem;
          problem.AddResidualBlock(cost_function, nullptr, s1.data());
          for (Index j = 0; j < s1.size(); ++j) {
            if (std::isfinite(start[j].min))
              problem.SetParameterLowerBound(s1.data(), int(j), to_s(start[j], start[j].min));
            if (std::isfinite(start[j].max))
              problem.SetParameterUpperBound(s1.data(), int(j), to_s(start[j], start[j].max));
          }
          ceres::Solver::Options o;
          o.max_num_iterations = 100;
          o.linear_solver_type = ceres::DENSE_QR;
          o.function_tolerance = 1e-7;
          o.logging_type = ceres::SILENT;
          ceres::Solver::Summary summary;
          ceres::Solve(o, &problem, &summary);
          cost = 2 * summary.final_cost;
        } else {
          EigenFunctor f{{p, start}, int(p.measured.size())};
          Eigen::NumericalDiff<EigenFunctor> d(f, 1e-8);
          Eigen::LevenbergMarquardt<Eigen::NumericalDiff<EigenFunctor>> lm(d);
          lm.parameters.ftol = 1e-7;
          lm.parameters.xtol = 1e-7;
          lm.parameters.maxfev = 400;
          VectorXd s1 = s0;
          lm.minimize(s1);
          cost = lm.fvec.squaredNorm();
        }
        s[method].runs += runs;
        s[method].seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        if (cost < 1.05 * floor) ++s[method].found;
      }
    }
    const char* names[] = {"ours, Broyden", "ours, fresh Jacobian", "Ceres, DENSE_QR",
                           "Eigen MINPACK (no bounds)"};
    std::printf("%s, %d unknowns\n", p.name, int(p.truth.size()));
    for (int m = 0; m < 4; ++m)
      std::printf("  %-26s %6.1f runs  %7.1f ms  %d of %d at the noise\n", names[m], s[m].runs / trials,
                  1e3 * s[m].seconds / trials, s[m].found, trials);
  }
}
