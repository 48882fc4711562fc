#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "base/registry.hpp"
#include "synthesis/realise.hpp"
#include "synthesis/stages/stage_form.hpp"

namespace bodesmith::circuit {

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

}  // namespace bodesmith::circuit
