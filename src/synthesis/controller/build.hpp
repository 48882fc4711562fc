#pragma once

#include <string>
#include <vector>

#include "synthesis/controller/controller.hpp"
#include "synthesis/parts/netlist_maker.hpp"

/// The steps of make_controller(), for its own files only.
namespace bodesmith::controller {

/// Greatest |voltage| aimed at, as a share of full scale: room for what E-series resistors round.
constexpr double kRoom = 0.97;

class Builder : private circuit::NetlistMaker {
 public:
  Builder(const Disturbance& disturbance, const Options& options);
  AnalogController build();

 private:
  // build.cpp
  void check_polynomials();
  void check_rates();
  double peak_of(int b) const;
  double gain_limit(int b, bool greatest) const;

  // build_rate.cpp: the slope as a voltage, the gain curve, the sign of the slope
  void detector();
  void slope_meter();
  void curve_rectifiers();
  void rectifier(std::size_t k, double threshold_v, const std::string& low_reference, double low_v);
  void control(int b);
  std::vector<double> control_gains(int b) const;
  std::vector<std::vector<double>> control_rows() const;
  int inverting_sum(const std::vector<std::string>& from, const std::vector<double>& gains,
                    const std::vector<std::vector<double>>& rows, const std::string& letters,
                    const std::string& role, const std::string& node, std::vector<double>& realised);

  // build_pass.cpp: powers, branches, switch, subtraction
  void scale_branches();
  void pass(const std::string& x, const std::string& out, int number);
  void powers(Pass& pass, const std::string& tail);
  void branch(Pass& pass, int b, const std::string& tail);
  void output(Pass& pass, const std::string& tail);

  void declare_groups();
  /// What is added next belongs there.
  void enter(const std::string& title);
  int multiplier(const std::string& name, const std::string& role, const std::string& x, const std::string& y,
                 const std::string& z, const std::string& to, double peak_v);

  const Disturbance& disturbance_;
  Options options_;
  AnalogController out_;
  double greatest_gain_[2] = {1.0, 1.0};  ///< of the rate gains
  double pass_scale_ = 1.0;               ///< of the divider before the multipliers
};

}  // namespace bodesmith::controller
