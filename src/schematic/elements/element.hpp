#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/constants.hpp"
#include "base/units.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

/// Places of nodes that are no unknowns.
constexpr int kGround = -1;
constexpr int kInput = -2;  ///< V(in): 1 V for small signals, Point::input_v at rest and in time

/// The unknowns at one instant: node voltages, then branch currents.
struct Point {
  std::span<const double> x;  ///< empty: all 0
  double input_v = 0.0;
  std::span<const double> rate;  ///< dx/dt; empty: all 0

  double operator[](int place) const {
    if (place == kInput) return input_v;
    return place == kGround || x.empty() ? 0.0 : x[static_cast<std::size_t>(place)];
  }
  double rate_of(int place) const {
    return place < 0 || rate.empty() ? 0.0 : rate[static_cast<std::size_t>(place)];
  }
};

/// What the elements of a netlist add up to,
///   f(x) + d/dt q(x) = 0,
/// one row an unknown: at a node the currents that leave it and the charges that have left it, then one equation for every
/// branch current; with the slopes df/dx + (d^2 q/dx^2) dx/dt and dq/dx. The slopes' columns of the input are kept: they
/// drive it.
class Stamps {
 public:
  struct Slope {
    int row, column;
    double f, q;
  };
  Stamps(std::span<double> f, std::span<double> q, std::vector<Slope>& slopes)
      : f_(f), q_(q), slopes_(slopes) {}

  void add(int row, double f, double q) {
    if (row < 0) return;
    if (!f_.empty()) f_[static_cast<std::size_t>(row)] += f;
    if (!q_.empty()) q_[static_cast<std::size_t>(row)] += q;
  }
  void slope(int row, int column, double f, double q) {
    if (row >= 0 && column != kGround) slopes_.push_back({row, column, f, q});
  }
  /// A current i(v) and a charge q(v) between two nodes, v = V(from) - V(to), with slopes g and c.
  void between(int from, int to, double i, double q, double g, double c) {
    add(from, i, q);
    add(to, -i, -q);
    slope(from, from, g, c);
    slope(from, to, -g, -c);
    slope(to, to, g, c);
    slope(to, from, -g, -c);
  }

 private:
  std::span<double> f_, q_;
  std::vector<Slope>& slopes_;
};

/// Where noise enters: rows of the equations.
class NoiseSources {
 public:
  virtual ~NoiseSources() = default;
  /// A current of this density (A^2/Hz) from one node to another; a voltage (V^2/Hz) in the equation of a branch: `to` is
  /// ground then.
  virtual void add(int from, int to, double density) = 0;
};

/// Thermal noise is that of SPICE's own temperature, 27 C.
constexpr double kKelvin = 300.15;

/// One element of a netlist, as all analyses see it.
class Element {
 public:
  virtual ~Element() = default;
  virtual void stamp(const Point& at, Stamps& to) const = 0;
  virtual void noise(RadPerSecond, bool /*flicker*/, NoiseSources&) const {}
  /// d ln(stamp)/d ln(value) of a part whose stamp is a power of its value: -1 a resistor, 1 a capacitor.
  virtual std::optional<double> power_of_value() const { return std::nullopt; }
};

// One file each. `branch`: the row of its current and of its own equation.
std::unique_ptr<Element> make_resistor(int from, int to, double ohm);
std::unique_ptr<Element> make_capacitor(int from, int to, double farad);
std::unique_ptr<Element> make_diode(int anode, int cathode, const DiodeModel& model);
/// Conducts without a voltage, or holds any voltage backwards without a current.
std::unique_ptr<Element> make_ideal_diode(int anode, int cathode, int branch);
struct Inputs {
  int plus, minus, out;
};
std::unique_ptr<Element> make_opamp(const Inputs& at, int branch, const OpAmpModel& model, double offset_v);
/// A nullor: V(plus) + offset = V(minus), whatever current it takes.
std::unique_ptr<Element> make_nullor(const Inputs& at, int branch, double offset_v);
struct Factors {
  int x, y, z, out;
};
std::unique_ptr<Element> make_multiplier(const Factors& at, int branch, const MultiplierModel& model,
                                         const MultiplierDeviation& off);
std::unique_ptr<Element> make_contact(int from, int to, const SwitchModel& model, bool closed);
/// The contact that its control moves; `timer`: the row of the voltage that delays it. Throws DesignError as SwitchTimer::of.
struct Control {
  int node, timer;
};
std::unique_ptr<Element> make_moving_contact(int from, int to, const Control& by, const SwitchModel& model);
std::unique_ptr<Element> make_comparator(int in, int out, int branch, double gain, double threshold_v);
std::unique_ptr<Element> make_gate(std::vector<int> high, std::vector<int> low, int out, int branch);
std::unique_ptr<Element> make_source(int node, int branch, double volts);

}  // namespace bodesmith::schematic
