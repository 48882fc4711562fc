#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/registry.hpp"

namespace bodesmith::faults {

/// A change of one admittance, or of one op-amp's equation, in the nodal equations A x = b of a circuit:
///   A x + delta(s) u (v'x + constant) = b,   delta(s) = g + c s + d s^2.
/// u and v have two entries at most. An admittance y between nodes p and q: u = v = e_p - e_q, delta = y; where one
/// of them is the input (V = 1, known), it is the constant; ground is left out.
struct Stamp {
  struct Entry {
    int at = 0;
    double weight = 0.0;  ///< 0: not there
  };
  std::array<Entry, 2> into;   ///< u
  std::array<Entry, 2> reads;  ///< v
  double constant = 0.0;
  double g = 0.0;
  double c = 0.0;
  double d = 0.0;
  bool rough = false;  ///< known to within Effect::model_error of the change that it makes only

  std::complex<double> delta(std::complex<double> s) const { return g + s * (c + s * d); }
  Stamp times(double factor) const {
    Stamp out = *this;
    out.g *= factor;
    out.c *= factor;
    out.d *= factor;
    return out;
  }
};

class CircuitBoard;
class PlanBoard;
class FaultKind;

/// What a fault does to a board: to the equations of a circuit, or to an FPAA plan.
struct Effect {
  std::vector<Stamp> stamps;
  /// The spread of these unknowns of the good board (index, factor) changes with it: an open resistor has no tolerance.
  std::vector<std::pair<std::size_t, double>> spread;

  /// What is not known of such a fault's details, relative to the change of ln H that its rough stamps make.
  double model_error = 0.0;

  /// Of a plan: capacitors (index in DrawnBoard, new units), clocks of CAMs (index, factor on the frequency).
  std::vector<std::pair<std::size_t, double>> units;
  std::vector<std::pair<std::size_t, double>> clocks;
};

/// A quantity for files: {"value_ohm": 4700}.
struct FaultSize {
  std::string key;  ///< with its unit; empty: the fault has no size
  double value = 0.0;
};

/// One thing that may be wrong with one board.
struct Fault {
  const FaultKind* kind = nullptr;
  std::vector<std::string> parts;  ///< what it accuses: one name, two where two parts are swapped
  std::string site;                ///< what the probabilities are summed over: the parts joined, or "node n1"
  /// Its size t: uniform between these beforehand. Equal: the fault has one size.
  double from = 0.0;
  double to = 0.0;
  std::function<Effect(double t)> effect;
  std::function<std::string(double t)> words;  ///< "R2_1 is 12.1 kΩ instead of 10 kΩ"
  std::function<FaultSize(double t)> size = [](double) { return FaultSize{}; };
  std::string rework;               ///< what to do about it
  std::vector<std::string> covers;  ///< every op-amp: what is wrong with one of these is no second fault
  std::vector<std::size_t>
      replaces;  ///< indices of the parts (of the circuit) to exchange, if that is the rework

  bool has_size() const { return to > from; }
  /// Of one name, with a size exp(t) between these.
  static Fault of(const std::string& name, double least = 1.0, double most = 1.0) {
    Fault out;
    out.parts = {name};
    out.site = name;
    out.from = std::log(least);
    out.to = std::log(most);
    return out;
  }
};

/// A kind of fault: where on a board it can be. Each is an object in a file of kinds/.
class FaultKind {
 public:
  /// `what` is for a person; `prior` is the share of all faulty boards that have it, beforehand (normalised over the kinds a
  /// board can have).
  FaultKind(std::string_view name, std::string_view what, double prior)
      : name_(name), what_(what), prior_(prior) {}
  virtual ~FaultKind() = default;
  std::string_view name() const { return name_; }
  std::string_view what() const { return what_; }
  double prior() const { return prior_; }
  virtual std::vector<Fault> on_circuit(const CircuitBoard&) const { return {}; }
  virtual std::vector<Fault> on_plan(const PlanBoard&) const { return {}; }

 private:
  std::string_view name_, what_;
  double prior_;
};

Registry<FaultKind>& fault_kind_registry();

}  // namespace bodesmith::faults
