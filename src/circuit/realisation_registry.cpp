#include "circuit/realisation.hpp"

namespace bodesmith::circuit {

// One line a realisation: the function that its own file defines. opamp_rc() chooses among the stages.
#define BODESMITH_REALISATIONS(ENTRY)             \
  ENTRY(Realisation, opamp_rc)                    \
  ENTRY(StageRealisation, first_order)            \
  ENTRY(StageRealisation, first_order_right_zero) \
  ENTRY(StageRealisation, first_order_trimmed)    \
  ENTRY(StageRealisation, inverter)               \
  ENTRY(StageRealisation, tow_thomas)             \
  ENTRY(StageRealisation, khn)                    \
  ENTRY(StageRealisation, sallen_key)             \
  ENTRY(StageRealisation, multiple_feedback)      \
  ENTRY(Realisation, foster1_realisation)         \
  ENTRY(Realisation, foster2_realisation)         \
  ENTRY(Realisation, cauer1_realisation)          \
  ENTRY(Realisation, cauer2_realisation)

#define BODESMITH_DECLARE(TYPE, NAME) const TYPE& NAME();
BODESMITH_REALISATIONS(BODESMITH_DECLARE)
#undef BODESMITH_DECLARE

Registry<Realisation>& realisation_registry() {
#define BODESMITH_ENTRY(TYPE, NAME) &NAME(),
  static Registry<Realisation> registry("realization", {BODESMITH_REALISATIONS(BODESMITH_ENTRY)});
#undef BODESMITH_ENTRY
  return registry;
}
#undef BODESMITH_REALISATIONS

Outcome<Realised> try_realise(const Sections& sections, const RealiseOptions& options) {
  options.limits.validate();
  return realisation_registry().get(options.realisation).design(sections, options);
}

Realised realise(const Sections& sections, const RealiseOptions& options) {
  return value_or_throw(try_realise(sections, options));
}

}  // namespace bodesmith::circuit
