#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/registry.hpp"
#include "lti/sections.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::synthesis {

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

/// A capacitor as the search of parts chooses it.
struct CapacitorChoice {
  RadPerSecond works_at;  ///< where it works against its resistor: C is near 1/(w R)
  double ratio = 1.0;     ///< best this many times the first capacitor …
  double slack = 0.0;     ///< … up to this factor more or less; 0: the usual
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
  /// parts()). Nothing when these capacitors cannot do it. The gain is met too where
  /// it does not follow the capacitors.
  virtual std::optional<std::vector<double>> design(std::span<const double> capacitors) const = 0;
  /// A design exact in everything, gain too, near `values`: what each part should have been.
  virtual std::optional<std::vector<double>> exact_near(std::span<const double> values) const;
  /// One for each capacitor of parts(), in their order.
  const std::vector<CapacitorChoice>& capacitor_choices() const { return capacitor_choices_; }

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
    capacitor_choices_.push_back({works_at, ratio, slack});
  }
  void opamp(std::string name, std::string plus, std::string minus, std::string out) {
    opamps_.push_back({std::move(name), std::move(plus), std::move(minus), std::move(out)});
  }

  Biquad wanted_;

 private:
  std::vector<StagePart> parts_;
  std::vector<StageOpAmp> opamps_;
  std::vector<CapacitorChoice> capacitor_choices_;
};

/// The section with its gain's sign turned round.
inline Section negated(Section section) {
  section.gain = -section.gain;
  return section;
}

/// Where one op-amp ends to be enough for a high-pass: above, Sallen and Key's form asks too much of its parts.
constexpr double kSallenKeyMaxQuality = 3.0;

/// Two poles, two zeros at the origin.
inline bool is_high_pass(const Section& section) {
  return section.poles.size() == 2 && section.zeros.size() == 2 && std::abs(section.zeros[0]) == 0.0 &&
         std::abs(section.zeros[1]) == 0.0;
}

/// Q of two poles.
inline double quality_of(const Section& section) {
  return std::abs(section.poles[0]) / std::abs((section.poles[0] + section.poles[1]).real());
}

/// Nodes of one stage of a chain, by their local names: "in" and "out" at the ends of the chain and n1, n2, …
/// between; the stage's own prefixed by s1_, s2_, …
class StageNodes {
 public:
  StageNodes(std::size_t stage, std::size_t stages) : stage_(stage), stages_(stages) {}
  std::string operator()(const std::string& local) const;
  /// Back again.
  static std::string local_name(const Stage& stage, std::size_t index, const std::string& node);

 private:
  std::size_t stage_, stages_;
};

/// A stage with its values, before it is placed in a chain.
struct StageDesign {
  std::string realisation;
  std::vector<StagePart> parts;
  std::vector<StageOpAmp> opamps;
  std::vector<double> wanted_values, realised_values;  ///< in the order of `parts`
  std::vector<Biquad> wanted, realised;                ///< factors of its transfer
  std::shared_ptr<const StageForm> form;               ///< null: no equations
};

/// Adds it as the next of `stages` stages.
void add_stage(Circuit& circuit, const StageDesign& design, std::size_t stages,
               const RealiseOptions& options);

class StageRealisation;
class RcLadder;

/// A named way to make sections as a circuit of op-amps, resistors and capacitors (`--realization NAME`).
class Realisation {
 public:
  virtual ~Realisation() = default;
  virtual std::string_view name() const = 0;
  /// The limits of its parts where none are asked for.
  virtual PartLimits usual_limits() const { return {}; }
  virtual Outcome<Realised> design(const Sections& sections, const RealiseOptions& options) const = 0;
  /// Itself where it makes one section as one stage; null otherwise.
  virtual const StageRealisation* stage_realisation() const { return nullptr; }
  /// The ladder that it puts round its op-amps; null: none.
  virtual const RcLadder* ladder() const { return nullptr; }

 protected:
  Realisation() = default;
  Realisation(const Realisation&) = default;
  Realisation& operator=(const Realisation&) = default;
};

struct FormOptions {
  /// In series with a capacitor that would load the stage before; 0: none.
  double isolation_ohm = 0.0;
};

/// A form that makes one section as one stage. As a Realisation: every stage in this form, as far as it can
/// be.
class StageRealisation : public Realisation {
 public:
  /// H = -|k| …: the sign that the form gives to the section's leading coefficient.
  virtual bool inverts() const { return true; }
  /// Real poles are kept in pairs for it, two a stage.
  virtual bool makes_two_poles() const { return true; }
  /// Why it cannot make this section (whose gain is above 0); nothing when it can.
  virtual std::optional<Refusal> refusal(const Section& section) const = 0;
  /// The form for a section that it does not refuse; the form's wanted() carries the sign.
  virtual std::unique_ptr<StageForm> make(const Section& section, const FormOptions& options) const = 0;

  /// How well it suits a section where "opamp-rc" chooses: the highest bid is taken, 0 or less never.
  virtual int bid(const Section&) const { return 0; }
  /// The same form with one part more, for designs whose few parts cannot meet the gain; null: none.
  virtual const StageRealisation* trimmed() const { return nullptr; }
  /// Another form for the same sections, tried where "opamp-rc" ends with parts that are far off; null: none.
  virtual const StageRealisation* fallback() const { return nullptr; }

  Outcome<Realised> design(const Sections& sections, const RealiseOptions& options) const override;
  const StageRealisation* stage_realisation() const override { return this; }
};

/// All of them, in the order of the documentation.
Registry<Realisation>& realisation_registry();

/// The form with the highest bid for this section.
Outcome<const StageRealisation*> best_form(const Section& section);

/// An inverting amplifier: a gain without poles.
const StageRealisation& inverter();

}  // namespace bodesmith::synthesis
