#pragma once

#include <string>
#include <vector>

#include "synthesis/controller/controller.hpp"
#include "synthesis/generator/maker.hpp"

/// The steps of make_controller(), for its own files only.
namespace bodesmith::controller {

class Builder : private generator::GeneratorMaker {
 public:
  Builder(const Disturbance& disturbance, const Options& options);
  AnalogController build();

 private:
  // build.cpp
  void check_polynomials();
  void check_gains();
  double peak_of(std::size_t b) const;
  double gain_limit(std::size_t b, bool greatest) const;

  // build_rate.cpp: the slope as a voltage, the gains over it
  void slope_meter();
  void rate_gains();

  // build_stroke.cpp: the reference's stroke as a voltage, what is divided by it, the gains over it
  std::vector<double> strokes() const;
  std::vector<double> stroke_gains(std::size_t b) const;
  void stroke_hold();
  /// The node of voltage s V(node)/stroke; `node` itself where there are no amplitude gains.
  std::string over_stroke(const std::string& node);
  void amplitude_gains();

  // build_pass.cpp: powers, branches, switch, subtraction
  void scale_branches();
  void pass(const std::string& x, const std::string& out, int number);
  generator::Powers powers(Pass& pass, const std::string& tail);
  void branch(Pass& pass, std::size_t b, const generator::Powers& powers);
  void output(Pass& pass, const std::string& tail);

  const Disturbance& disturbance_;
  Options options_;
  AnalogController out_;
  double greatest_gain_[2] = {1.0, 1.0};       ///< of the rate gains
  double greatest_amplitude_[2] = {1.0, 1.0};  ///< of the amplitude gains
};

}  // namespace bodesmith::controller
