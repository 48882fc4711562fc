#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "faults/fault.hpp"
#include "faults/measurement.hpp"
#include "fpaa/device/mismatch.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::faults {

/// What the probabilities of a board's parts rest on.
struct Spread : schematic::Tolerances {
  explicit Spread(const schematic::Tolerances& parts = {.resistor_percent = 1.0, .capacitor_percent = 1.0})
      : Tolerances(parts) {}
  double opamp_percent = 30.0;   ///< standard deviation of gain-bandwidth and output resistance
  double stray_f = 3e-12;        ///< standard deviation of the stray capacitance at a node
  fpaa::MismatchModel mismatch;  ///< of an FPAA's capacitors
};

/// What a board with certain faults would show: H at every measured point (channels one behind the other), and how
/// it moves with everything that differs from board to board: d ln H for one standard deviation of each.
struct Prediction {
  Eigen::VectorXcd response;
  Eigen::MatrixXcd slopes;   ///< [point][unknown]
  double model_error = 0.0;  ///< Effect::model_error
  /// What the model error's change is counted from: H without what is known roughly. Empty: the good board's.
  Eigen::VectorXcd reference;
};

/// A board with certain faults, asked for what further ones would make of it, by one thread at a time.
class ChangedBoard {
 public:
  virtual ~ChangedBoard() = default;
  virtual Eigen::VectorXcd response(const Effect& further) const = 0;
};

/// A board as it was meant to be built, asked for what faults would make of it.
class Board {
 public:
  virtual ~Board() = default;

  const Measurement& measured() const { return measured_; }
  /// |H| at each point below which nothing is told apart: -90 dB of the input, or -60 dB of the good board (what a
  /// dead board lets through is crosstalk that no model has).
  const std::vector<double>& floors() const { return floors_; }
  const Eigen::VectorXcd& good_response() const { return good_; }
  /// Everything that differs from one good board to the next. Those that are parts with a tolerance are marked.
  virtual std::size_t unknowns() const = 0;
  virtual bool is_part(std::size_t unknown) const = 0;

  virtual Prediction predict(const Effect& effect) const = 0;
  /// The response alone: quicker.
  virtual Eigen::VectorXcd response(const Effect& effect) const = 0;
  /// For many responses that have some faults in common. The board must outlive it.
  virtual std::unique_ptr<ChangedBoard> changed_by(const Effect& effect) const;
  /// The same board made of parts that are off by so many standard deviations each (one number an unknown; those that
  /// are no parts are left as they are). Null where the linear form is as good.
  virtual std::unique_ptr<Board> with_parts(const Eigen::VectorXd& deviations) const;
  /// Every fault of every kind in the registry that this board can have.
  std::vector<Fault> faults() const;

  /// Nodes that a probe can reach, other than input and output; none where there is only the output.
  virtual std::vector<std::string> probe_nodes() const { return {}; }
  /// From the input to a node over the first channel's grid.
  virtual Eigen::VectorXcd at_node(const std::string& node, const Effect& effect) const;

  /// A part that another of its sort can be soldered across; none on a board without parts.
  struct SolderedPart {
    std::string name;
    double nominal = 0.0;
    std::string_view unit;  ///< "Ω", "F"
  };
  virtual std::vector<SolderedPart> soldered_parts() const { return {}; }
  /// The effect of `factor` times the nominal value in parallel with a part, whatever that one is.
  virtual Effect in_parallel(std::size_t part, double factor) const;

 protected:
  explicit Board(Measurement measured) : measured_(std::move(measured)) {}
  virtual std::vector<Fault> faults_of(const FaultKind& kind) const = 0;
  void set_good(const Eigen::VectorXcd& good);

 private:
  Measurement measured_;
  Eigen::VectorXcd good_;
  std::vector<double> floors_;
};

/// Both at once.
Effect joined(const Effect& a, const Effect& b);

}  // namespace bodesmith::faults
