#pragma once

#include <string>
#include <vector>

#include "synthesis/controller/controller.hpp"
#include "synthesis/parts/netlist_maker.hpp"

/// The steps of make_controller(), for its own files only.
namespace bodesmith::controller {

/// Greatest |voltage| aimed at, as a share of full scale: room for what E-series resistors round.
constexpr double kRoom = 0.97;

/// Of the voltage reference.
constexpr double kReferenceV = 2.5;

/// Branch 0, ascending, or 1, descending: for titles and roles; for names.
std::string branch_name(int b);
std::string branch_letter(int b);

/// Gains of both branches as straight pieces over a voltage s: exact at the corners, constant beyond the ends.
struct GainCurve {
  std::string node;                   ///< carries -s
  std::string rectifiers;             ///< begins their nodes' names
  std::string control, inverted;      ///< begin the names of the control voltages
  std::string group;                  ///< what the gain goes by: "rate"
  std::vector<double> corner_v = {};  ///< rising
  std::vector<std::string> corner_text = {};
  std::vector<double> gain[2] = {};  ///< at the corners
  bool varies[2] = {false, false};

  std::string rectifier(std::size_t corner) const { return rectifiers + std::to_string(corner + 1); }
};

class Builder : private synthesis::NetlistMaker {
 public:
  Builder(const Disturbance& disturbance, const Options& options);
  AnalogController build();

 private:
  // build.cpp
  void check_polynomials();
  void check_gains();
  double peak_of(int b) const;
  double gain_limit(int b, bool greatest) const;

  // build_rate.cpp: the slope as a voltage, the gains over it, the sign of the slope
  void detector();
  void slope_meter();
  void rate_gains();

  // build_stroke.cpp: the reference's stroke as a voltage, what is divided by it, the gains over it
  std::vector<double> strokes() const;
  std::vector<double> stroke_gains(int b) const;
  void stroke_hold();
  /// The node of voltage s V(node)/stroke; `node` itself where there are no amplitude gains.
  std::string over_stroke(const std::string& node);
  void amplitude_gains();

  // build_curve.cpp
  void reference();
  void build_curve(const GainCurve& curve, BranchGain* gains);
  int control(const GainCurve& curve, int b, double at_rest);
  std::vector<double> control_gains(const GainCurve& curve, int b, double at_rest) const;

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
  double greatest_gain_[2] = {1.0, 1.0};       ///< of the rate gains
  double greatest_amplitude_[2] = {1.0, 1.0};  ///< of the amplitude gains
  double pass_scale_ = 1.0;                    ///< of the divider before the multipliers
};

}  // namespace bodesmith::controller
