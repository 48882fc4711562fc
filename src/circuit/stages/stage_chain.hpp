#pragma once

#include "circuit/realisation.hpp"

namespace bodesmith::circuit {

/// Sections as a chain of op-amp RC stages. Real poles and zeros of all sections are pooled, paired sorted by
/// frequency (least span a stage) and each pair becomes a stage, e.g. R1||C1 into R2||C2 around an inverting
/// op-amp,
///   H(s) = -(R2/R1)(1 + s R1 C1)/(1 + s R2 C2);
/// complex pairs become biquads. Stages are ordered so that no node between them is far above or below the
/// signal, the gain is spread over them, an inverter is added where the number of inversions is odd.
/// Resistors and capacitors of all stages are then searched jointly in their series for the least complex
/// error of the whole chain. `form`: for every stage that it can make; null: the best for each.
Outcome<Realised> realise_as_stages(const Sections& sections, const StageRealisation* form,
                                    const RealiseOptions& options);

}  // namespace bodesmith::circuit
