#pragma once

#include <string>
#include <vector>

#include "synthesis/generator/circuit.hpp"

/// The steps of make_layout() and make_controller(), for their own files only.
namespace bodesmith::generator {

constexpr std::size_t kMostBranches = 64;

class Builder : private GeneratorMaker {
 public:
  /// `size`: powers to a group. `disturbance`: closed, what the polynomials are of, with its tables.
  Builder(const Input& input, const Options& options, int size, const Disturbance& disturbance = {});
  DisturbanceCircuit build();

 private:
  // build.cpp
  void check_gains();
  void check_polynomials();
  void scale_branches();
  void scale_branches_open();
  bool is_open() const { return options_.form == Form::open; }
  double gain_limit(std::size_t b, bool greatest) const;
  /// Greatest argument, and greatest |d| of a branch up to there.
  double top() const { return std::max(out_.loop.greatest_drive, 1.0); }
  double peak_of(std::size_t b) const { return peak(out_.branches[b].wanted, top()); }
  std::vector<BranchGain*> gains(BranchGain Branch::*which);

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

  // build_pass.cpp: powers, branches, switch, output
  void pass(const std::string& x, const std::string& out, int number);
  int groups(const std::vector<double>& a) const;
  std::vector<double> group_coefficients(const std::vector<double>& a, int j) const;
  double chain_scale(int j) const;
  double greatest_inside(const std::vector<double>& a) const;
  Powers powers(Pass& pass, const std::string& tail);
  void branch(Pass& pass, std::size_t number, const Powers& powers);
  void output(Pass& pass);
  void subtraction(Pass& pass, const std::string& tail);
  void branch_switch();
  schematic::Gate decoded(int branch, std::size_t channel) const;
  void warn_above(const std::string& name, double peak_v, const char* note = "");

  const Input& input_;
  Options options_;
  int size_;
  double input_ohm_ = 0.0, feedback_ohm_ = 0.0;  ///< of the open circuit's output amplifier
  DisturbanceCircuit out_;
};

void add_nodes(DisturbanceCircuit& layout);
/// Every group size from 1 to the degree; marks the one to build.
std::vector<Candidate> compare_schemes(const Input& input, const Options& options);

}  // namespace bodesmith::generator
