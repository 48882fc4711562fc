#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "hysteresis/preisach.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::hysteresis {

/// How a kernel's weight lies in its cell of the plane: f and g are the fractions of the upper and lower end
/// in their cells, m(f, g) the part of the corner cell (i, j) that is swept:
///   bilinear  m = f (1 − g)        evenly over the cell
///   relays                         all in one corner
///   kp        m = max(0, f − g)    along the diagonal: the Krasnoselskii-Pokrovskii kernel with a ramp as long
///                                  as the cell
enum class CellShape { bilinear, relays, kp };

/// The linear map from the weights of a Preisach plane to the outputs of records, kept as the stack saw it:
/// sample t is y_t = y_parent(t) ± T(high_t, low_t). A product costs one sweep over the plane (prefix sums)
/// and one over the samples; memory is 48 bytes a sample, however many relays there are.
class EverettTrace {
 public:
  EverettTrace(double u_min, double u_max, std::size_t levels, CellShape shape);
  /// The record starts at rest, come up from u_min. The first `skip` samples move the memory but make no
  /// rows.
  void add(const TimeRecord& record, std::size_t skip);

  Eigen::Index rows() const { return rows_; }
  Eigen::Index columns() const { return static_cast<Eigen::Index>(levels_ * (levels_ + 1) / 2); }
  void apply(const Eigen::VectorXd& weights, Eigen::VectorXd& y) const;
  void adjoint(const Eigen::VectorXd& residual, Eigen::VectorXd& gradient) const;

 private:
  struct Sample {
    std::int32_t parent = -1;  ///< index of the sample the branch left; −1: all relays off
    std::int32_t row = -1;     ///< −1: not counted
    float sign = 0.0F;         ///< 0: as the parent
    std::int32_t high = 0;     ///< offset of the table row of the upper cell
    std::int32_t low = 0;
    double high_fraction = 0.0;
    double low_fraction = 0.0;
    double corner = 0.0;  ///< m
  };
  double u_min_;
  double u_max_;
  std::size_t levels_;
  CellShape shape_;
  Eigen::Index rows_ = 0;
  std::vector<Sample> samples_;
  mutable std::vector<double> table_;
  mutable std::vector<double> along_;
  mutable std::vector<double> column_;
};

}  // namespace bodesmith::hysteresis
