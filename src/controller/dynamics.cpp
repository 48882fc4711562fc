#include "controller/dynamics.hpp"

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "base/whole_number.hpp"
#include "simulate/cvode_solver.hpp"

namespace bodesmith::controller {
namespace {

using tracking::Reference;

/// Of the smoothing behind the slope meter: what a repeat must exceed for the start to be forgotten.
constexpr double kSettled = 10.0;

class Chain {
 public:
  Chain(const AnalogController& controller, const Reference& reference, Hertz operating)
      : controller_(controller),
        reference_(reference),
        behaviour_(controller),
        repeat_(static_cast<double>(reference.periods()) / operating.value) {
    for (const Pass& pass : controller.passes) {
      built_.push_back(behaviour_.build(pass));
      Rates rates;
      const double gbw = controller.opamp.gain_bandwidth.rad_s().value;
      for (const std::size_t b : {0u, 1u}) {
        const int sum = pass.branch[b].sum;
        rates.sum[b] = sum < 0 ? gbw : gbw / behaviour_.noise_gain(controller.sum(sum));
      }
      rates.output = gbw / behaviour_.noise_gain(controller.sum(pass.output));
      rates_.push_back(rates);
    }
    if (controller.slope) {
      const AnalogController::SlopeMeter& m = *controller.slope;
      const auto value = [&](int part) { return controller.part(part).realised; };
      rs_ = value(m.damping), cd_ = value(m.differentiates), rd_ = value(m.gain), cf_ = value(m.limits);
    }
  }

  std::size_t order() const { return first() + 3 * built_.size(); }
  double repeat() const { return repeat_; }
  bool rising = true;  ///< what the switch has chosen

  double reference_at(double t) const {
    const double theta = t / repeat_ - std::floor(t / repeat_);

    return reference_.value(theta);
  }

  void rate(double t, const double* x, double* dx) const {
    const double r = reference_at(t), swing = controller_.opamp.swing_v;
    double control[2] = {0.0, 0.0};
    if (controller_.slope) {
      const double i = (r - x[0]) / rs_;
      dx[0] = i / cd_;
      const double w = std::clamp(x[1], -swing, swing);
      dx[1] = -(i + w / rd_) / cf_;
      if (std::abs(x[1]) >= swing && dx[1] * x[1] > 0.0) dx[1] = 0.0;
      dx[2] = (behaviour_.slope_v(-w / (rd_ * cd_)) - x[2]) / controller_.slope->smoothing_s;
      control[0] = behaviour_.control_v(Disturbance::Branch::ascending, x[2]);
      control[1] = behaviour_.control_v(Disturbance::Branch::descending, x[2]);
    }
    const int b = rising ? 0 : 1;
    double argument = r;
    for (std::size_t k = 0; k < built_.size(); ++k) {
      const Pass& pass = controller_.passes[k];
      const double* state = x + first() + 3 * k;
      double* change = dx + first() + 3 * k;
      if (pass.x == pass.out) argument = state[2];
      for (const std::size_t i : {0u, 1u})
        change[i] = rates_[k].sum[i] * (built_[k].sum[i].value(argument) - state[i]);
      const double target = built_[k].reference * r + built_[k].offset +
                            built_[k].load * behaviour_.gained(pass, b, state[b], control[b]);
      change[2] = rates_[k].output * (target - state[2]);
      argument = state[2];
    }
  }

 private:
  struct Rates {
    double sum[2] = {0.0, 0.0}, output = 0.0;
  };
  std::size_t first() const { return controller_.slope ? 3 : 0; }

  const AnalogController& controller_;
  const Reference& reference_;
  Behaviour behaviour_;
  std::vector<Behaviour::BuiltPass> built_;
  std::vector<Rates> rates_;
  double repeat_ = 1.0, rs_ = 1.0, cd_ = 1.0, rd_ = 1.0, cf_ = 1.0;
};

/// Corners of the reference and changes of the switch over `repeats`, rising.
struct Stop {
  double t = 0.0;
  int turns = 0;  ///< +1: the switch chooses rising from here, -1: falling, 0: a corner
};
std::vector<Stop> stops_of(const Reference& reference, double repeat, int repeats, double delay) {
  std::vector<Stop> out;
  const std::vector<double>& turns = reference.turns();
  for (int k = 0; k < repeats; ++k) {
    for (std::size_t i = 0; i < turns.size(); ++i) {
      const double t = (k + turns[i]) * repeat;
      if (t > 0.0) out.push_back({t, 0});
      out.push_back({t + delay, Reference::rises(i) ? 1 : -1});
    }
  }
  out.push_back({repeats * repeat, 0});
  std::sort(out.begin(), out.end(), [](const Stop& a, const Stop& b) { return a.t < b.t; });
  while (out.back().t > repeats * repeat) out.pop_back();
  return out;
}

}  // namespace

Settled run_in_cvode(const AnalogController& controller, const Reference& reference, Hertz operating,
                     std::size_t samples) {
  const Stopwatch watch;
  Chain chain(controller, reference, operating);
  const double repeat = chain.repeat();
  const double slowest = controller.slope ? kSettled * controller.slope->smoothing_s : 0.0;
  const int repeats = whole_number(std::ceil(slowest / repeat), 1, 20) + 1;
  const double begin = (repeats - 1) * repeat;
  Settled out{reference, operating, repeat / static_cast<double>(samples), {}, {}, {}, 0.0};
  simulate::CvodeProblem problem;
  problem.order = chain.order();
  problem.rate = [&](double t, const double* x, double* dx) { chain.rate(t, x, dx); };
  simulate::CvodeSolver solver(problem, simulate::CvodeSolver::Method::bdf, 1e-7, 1e-8);
  std::vector<double> x(chain.order(), 0.0);
  double t = 0.0;
  for (const Stop& stop :
       stops_of(reference, repeat, repeats, switch_delay_s(controller, reference, operating))) {
    if (stop.t > t) {
      solver.start(t, x.data(), stop.t);
      for (auto outcome = simulate::CvodeSolver::Outcome::stepped;
           outcome == simulate::CvodeSolver::Outcome::stepped;) {
        outcome = solver.step();
        while (out.v.size() < samples) {
          const double at = begin + static_cast<double>(out.v.size()) * out.step_s;
          if (at > solver.time() || at < solver.step_begin()) break;
          solver.at(at, x.data());
          out.v.push_back(x.back());
          out.r.push_back(chain.reference_at(at));
        }
      }
      x.assign(solver.state(), solver.state() + chain.order());
      t = stop.t;
    }
    if (stop.turns != 0) chain.rising = stop.turns > 0;
  }
  while (out.v.size() < samples) {  // rounding at the very end
    out.v.push_back(x.back());
    out.r.push_back(chain.reference_at(begin + static_cast<double>(out.r.size()) * out.step_s));
  }
  out.wall_s = watch.seconds();
  return out;
}

}  // namespace bodesmith::controller
