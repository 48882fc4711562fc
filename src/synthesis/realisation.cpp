#include "synthesis/realisation.hpp"

namespace bodesmith::circuit {

// A name a realisation: the function that its own file defines. opamp_rc() chooses among the stages.
BODESMITH_REGISTRY(Realisation, realisation_registry, "realization", opamp_rc, first_order,
                   first_order_right_zero, first_order_trimmed, inverter_realisation, tow_thomas, khn,
                   sallen_key, multiple_feedback, foster1_realisation, foster2_realisation,
                   cauer1_realisation, cauer2_realisation)

Outcome<Realised> try_realise(const Sections& sections, const RealiseOptions& options) {
  options.limits.validate();
  return realisation_registry().get(options.realisation).design(sections, options);
}

Realised realise(const Sections& sections, const RealiseOptions& options) {
  return value_or_throw(try_realise(sections, options));
}

}  // namespace bodesmith::circuit
