#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "multiplier_layout/layout.hpp"

namespace bodesmith::multiplier_layout {

/// The whole generator at rest with ideal op-amps (but for their offsets); everything that may be off is a
/// member.
class Bench {
 public:
  explicit Bench(const Layout& layout);

  std::vector<MultiplierDeviation> multiplier;  ///< layout.multipliers, then amplitude's
  std::vector<double> resistor;                 ///< relative, by place in layout.parts
  /// V at the inputs of the op-amps: layout.sums, the output amplifier, then amplitude's controls.
  std::vector<double> offset;
  double switch_relative = 0.0;

  /// d at each x, without amplitude gains.
  std::vector<double> curve(size_t branch, const std::vector<double>& x) const;
  /// d of the amplitude version.
  std::vector<double> curve(size_t branch, const std::vector<double>& x, double alpha) const;
  /// Control voltage of a branch, V.
  double control_v(size_t branch, double alpha) const;

 private:
  struct Product {
    int x, y, z, out;
  };
  int node(const std::string& name);
  double ohm(int part) const;
  double multiply(const MultiplierDeviation& off, double x, double y, double z) const;
  std::vector<double> run(size_t branch, const std::vector<double>& x, std::optional<double> control_v) const;
  std::vector<double> gains(const Sum& sum, double& noise_gain) const;

  const Layout& layout_;
  std::map<std::string, int> names_;
  std::vector<Product> products_;
  std::vector<std::vector<int>> terms_;  ///< nodes, one list a sum
  std::vector<int> sum_out_, branch_out_;
};

}  // namespace bodesmith::multiplier_layout
