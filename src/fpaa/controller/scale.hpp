#pragma once

#include <vector>

#include "fpaa/controller/controller.hpp"

namespace bodesmith::fpaa {

/// The rate gains that a branch goes through: those of its table, or 1 (also where a compensator makes them).
std::vector<double> rate_gains(const Disturbance& disturbance, Disturbance::Branch branch,
                               const BranchPlans& compensators);

/// Where and how strongly the loop v = r - K d(v) contracts.
struct Contraction {
  double factor = 0.0;  ///< max |K d'(x)|, x over the drive's range
  double x = 0.0;
  double gain = 1.0;  ///< K there
  Disturbance::Branch branch = Disturbance::Branch::ascending;
};

/// The share of the stroke that reference and drive take, over the whole stroke and all rate gains.
struct DriveRange {
  double low = 0.0;
  double high = 1.0;
  Contraction contraction;
};
DriveRange drive_range(const Disturbance& disturbance, const BranchPlans& compensators);

/// A range in volts: bipolar takes all of +- full scale, otherwise 0 V stands for x = 0. A little is left
/// free.
VoltScale volt_scale(const DriveRange& range, bool bipolar);

/// v of v + K d(v) = r near r: what a converging loop settles at; a few passes otherwise.
double settled_drive(const Disturbance& disturbance, Disturbance::Branch branch, double gain, double r);

/// Greatest |d| of a branch over the range.
double greatest_disturbance(const Disturbance& disturbance, Disturbance::Branch branch,
                            const DriveRange& range);

}  // namespace bodesmith::fpaa
