#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "circuit/circuit.hpp"

namespace bodesmith::circuit {

/// A part of a stage before it is placed in a chain. Nodes: "in", "out", "0" (ground), anything else is the
/// stage's own.
struct StagePart {
  Part::Kind kind = Part::Kind::resistor;
  std::string name;
  std::string from;
  std::string to;
  bool fixed = false;  ///< its value is not searched
};
struct StageOpAmp {
  std::string name;
  std::string plus;
  std::string minus;
  std::string out;
};

/// One circuit form made to do one section: its drawing, its design equations, its transfer. Values are in
/// the order of parts(), ohm and farad.
class StageForm {
 public:
  virtual ~StageForm() = default;

  const std::vector<StagePart>& parts() const { return parts_; }
  const std::vector<StageOpAmp>& opamps() const { return opamps_; }
  /// What it is to do, its own sign included.
  const Biquad& wanted() const { return wanted_; }

  /// H(s) with ideal op-amps and these values.
  virtual Biquad transfer(std::span<const double> values) const = 0;
  /// What the search of parts compares with wanted(): transfer() without what is there for stability only.
  virtual Biquad aim(std::span<const double> values) const { return transfer(values); }
  /// Values that put poles and zeros exactly where they are wanted with these capacitors (in the order of
  /// parts()). False when these capacitors cannot do it. The gain is met too unless
  /// gain_follows_capacitors().
  virtual bool design(std::span<const double> capacitors, std::vector<double>& values) const = 0;
  /// A design exact in everything, gain too, near `values`: what each part should have been.
  virtual bool exact_near(std::span<const double> values, std::vector<double>& exact) const;
  virtual bool gain_follows_capacitors() const { return false; }
  /// For each capacitor, the angular frequency at which it works against its resistor: C is near 1/(w R).
  const std::vector<RadPerSecond>& capacitor_frequencies() const { return capacitor_frequencies_; }
  /// Capacitor i is best `capacitor_ratios()[i]` times capacitor 0.
  const std::vector<double>& capacitor_ratios() const { return capacitor_ratios_; }
  /// … up to this factor more or less; 0: the usual.
  const std::vector<double>& capacitor_slacks() const { return capacitor_slacks_; }

  std::vector<double> capacitors(std::span<const double> values) const;

 protected:
  void resistor(std::string name, std::string from, std::string to) {
    parts_.push_back({Part::Kind::resistor, std::move(name), std::move(from), std::move(to), false});
  }
  /// Not searched, and outside the limits of the resistors.
  void fixed_resistor(std::string name, std::string from, std::string to) {
    parts_.push_back({Part::Kind::resistor, std::move(name), std::move(from), std::move(to), true});
  }
  void capacitor(std::string name, std::string from, std::string to, RadPerSecond works_at,
                 double ratio = 1.0, double slack = 0.0) {
    parts_.push_back({Part::Kind::capacitor, std::move(name), std::move(from), std::move(to), false});
    capacitor_frequencies_.push_back(works_at);
    capacitor_ratios_.push_back(ratio);
    capacitor_slacks_.push_back(slack);
  }
  void opamp(std::string name, std::string plus, std::string minus, std::string out) {
    opamps_.push_back({std::move(name), std::move(plus), std::move(minus), std::move(out)});
  }

  Biquad wanted_;
  std::vector<StagePart> parts_;
  std::vector<StageOpAmp> opamps_;
  std::vector<RadPerSecond> capacitor_frequencies_;
  std::vector<double> capacitor_ratios_;
  std::vector<double> capacitor_slacks_;
};

struct FormOptions {
  /// In series with a capacitor that would load the stage before; 0: none.
  double isolation_ohm = 0.0;
};

/// A named way to build a section.
struct Realization {
  std::string name;
  std::string what;
  /// True when H = -|k| ... (the sign that the form gives to the section's leading coefficient).
  bool inverts = true;
  /// Why it cannot make this section (its gain is above 0); empty when it can.
  std::string (*refusal)(const Section& section);
  /// The form for this section; the form's wanted() carries the sign.
  std::unique_ptr<StageForm> (*make)(const Section& section, const FormOptions& options);
};

/// All of them, one file each. "opamp-rc" is not in the list: it is the choice among them.
const std::vector<Realization>& realizations();
/// Throws InputError that lists the names.
const Realization& realization_named(const std::string& name);
/// "opamp-rc": the first-order form for one pole; for two Tow-Thomas, but for a high-pass Sallen-Key up to Q
/// = 3 and KHN above.
const Realization& default_realization(const Section& section);

}  // namespace bodesmith::circuit
