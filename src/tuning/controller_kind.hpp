#pragma once

#include <Eigen/Core>

#include <cmath>
#include <string>
#include <vector>

#include "base/registry.hpp"
#include "base/units.hpp"
#include "lti/sections.hpp"
#include "simulate/pid.hpp"

namespace bodesmith::tuning {

/// C(s) = (kp + ki/s + kd s/(1 + s/w_d)) filter(s): what `simulate --controller` runs.
struct SeriesController {
  simulate::PidController pid;
  Sections filter;  ///< gain 1 and no sections: none

  Complex response(Complex s) const;
  /// The whole as sections, the integrator a pole at 0.
  Sections sections() const;
};

/// Where a loop is shaped.
struct ShapeSetting {
  Hertz crossover;
  Hertz derivative_corner;        ///< of a PID's derivative; where the others roll off at the earliest
  Hertz highest;                  ///< up to which the loop is judged
  std::vector<Hertz> resonances;  ///< peaks of the plant above the crossover, highest first

  /// lg of how far above the crossover a number may act and change nothing there: a tenth at the highest frequency.
  double decades() const { return std::log10(highest.value / crossover.value) + 1.0; }
};

/// A form of controller: numbers x within bounds, C(s) up to its gain. One file a kind under tuning/kinds/, one line in
/// controller_kind.cpp.
class ControllerKind {
 public:
  ControllerKind(std::string name, std::string what) : name_(std::move(name)), what_(std::move(what)) {}
  virtual ~ControllerKind() = default;
  ControllerKind(const ControllerKind&) = delete;
  ControllerKind& operator=(const ControllerKind&) = delete;

  const std::string& name() const { return name_; }
  const std::string& what() const { return what_; }  ///< one line for a person

  struct Bounds {
    Eigen::VectorXd lower;
    Eigen::VectorXd upper;
  };
  virtual Bounds bounds(const ShapeSetting& setting) const = 0;
  virtual SeriesController make(const Eigen::VectorXd& x, const ShapeSetting& setting) const = 0;
  /// C(j w) of the form itself, where making it out of sections is an approximation.
  virtual Complex response(const SeriesController& made, const Eigen::VectorXd&, const ShapeSetting&,
                           Complex s) const {
    return made.response(s);
  }
  /// False: make() is expensive, and response() does without it (`made` is then empty).
  virtual bool made_exactly() const { return true; }

 private:
  std::string name_;
  std::string what_;
};

const std::vector<const ControllerKind*>& controller_kinds();

}  // namespace bodesmith::tuning
