#pragma once

#include <string>
#include <vector>

#include "fpaa/controller/controller.hpp"
#include "fpaa/controller/scale.hpp"

namespace bodesmith::fpaa {

/// What the branches of a pass are made of: the argument itself, and its powers where they are needed.
struct BranchInputs {
  std::string argument;
  std::vector<std::string> powers;  ///< of the sums, in the order of their weights; empty with look-up
};

/// What a branch's look-up table holds: minus the part of d that a line in parallel with it leaves, over its greatest
/// value, at 3 V. (What follows the table inverts.) The line is there where it flattens the table: the 8 bits
/// of the converter then act on a small remainder.
struct TableShape {
  double line = 0.0;      ///< d in the line per stroke, 0 at the scale's centre
  double greatest = 0.0;  ///< |d - line| over the drive's range
};
TableShape table_shape(const Disturbance& disturbance, Disturbance::Branch branch, const DriveRange& range,
                       const VoltScale& scale);
/// The function that the table imitates, volts to volts.
double table_volts(const Disturbance& disturbance, Disturbance::Branch branch, const TableShape& shape,
                   const VoltScale& scale, double input_v);

/// Makes the polynomials' CAMs with their volts: inputs by the variant's scale, outputs so that times
/// output_weight() they are K d in the same volts per stroke.
class ControllerBranches {
 public:
  ControllerBranches(ControllerVariant& variant, const Disturbance& disturbance,
                     const BranchPlans& compensators, const ControllerOptions& options);

  static const char* name_of(Disturbance::Branch branch);

  /// A CAM of the fast clock with what its facts say.
  ControllerCam cam(const std::string& name, const Cam& cam, std::vector<std::string> inputs) const;

  BranchInputs add_powers(std::vector<ControllerCam>& cams, const std::string& prefix,
                          const std::string& argument, int group);
  /// The name of the branch's last CAM. Throws DesignError where its table cannot be made.
  std::string add_branch(std::vector<ControllerCam>& cams, const std::string& prefix,
                         Disturbance::Branch branch, const BranchInputs& inputs, int group);
  /// Weight of the branches in the difference from the reference, as its capacitors make it.
  double output_weight() const { return output_weight_; }

 private:
  struct Side {
    bool compensated = false;
    double most_v = 0.0;          ///< at its output: what the branch switch, or the compensator, takes
    double greatest = 0.0;        ///< max |d|
    double greatest_gain = 1.0;   ///< of the rate table
    std::vector<double> weights;  /// of the powers, without the rate gain, over output_weight()
  };
  std::vector<double> power_weights(Disturbance::Branch branch) const;
  double wanted_output_weight() const;
  std::string add_table(std::vector<ControllerCam>& cams, const std::string& name, Disturbance::Branch branch,
                        const BranchInputs& inputs, int group);
  std::string add_sum(std::vector<ControllerCam>& cams, const std::string& name, Disturbance::Branch branch,
                      const BranchInputs& inputs, int group);
  std::string add_multiplier(std::vector<ControllerCam>& cams, const std::string& name,
                             std::vector<std::string> inputs, int group) const;
  void add_outside(OutsidePart part);
  void finish(ControllerCam& cam, std::vector<double> weights, std::vector<double> products,
              Disturbance::Branch branch, int group) const;
  std::vector<double> products_of(const std::vector<std::vector<double>>& signals) const;

  ControllerVariant& out_;
  const Disturbance& disturbance_;
  const ControllerOptions& options_;
  DriveRange range_;
  std::array<Side, 2> sides_;  ///< of kBranches
  double output_weight_ = 1.0;
};

/// d(x) as the branch CAMs make it at rest, against d(x): max and rms over x in [0, 1], both branches. Fills
/// the variant's figures (compensators and rate gains are 1 there).
void set_polynomial_error(ControllerVariant& variant, const Disturbance& disturbance);

/// The whole controller with its polynomials made in one way, in one structure: every CAM in signal order
/// with its capacitors and its place, what stands outside, the I/O cells it needs, its delay and its error.
/// Where it does not fit on the board or cannot work, the variant says so.
ControllerVariant laid_out(PolynomialBy by, ControllerStructure structure, const Disturbance& disturbance,
                           const BranchPlans& compensators, const ControllerOptions& options);

/// Gives a CAM that weighs its inputs (SumDiff; GainHold, one input, inverting) the capacitors that make
/// `rate_gain` times its weights with the least error (products): its z, realised gains and late inputs
/// follow. A weight of 0 has no capacitor.
void set_weights(ControllerCam& cam, double rate_gain);

/// A SumDiff whose first weight is exactly 1: the others as near as capacitors come.
void set_weights_first_exact(ControllerCam& cam);

}  // namespace bodesmith::fpaa
