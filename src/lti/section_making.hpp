#pragma once

#include <vector>

#include "lti/sections.hpp"

namespace bodesmith {

/// How poles and zeros become sections.
struct SectionMaking {
  bool biquads =
      false;  ///< real poles in pairs too, where two are left; otherwise each gets a section of its own
};

/// H(s) = gain * prod (s - zero)/prod (s - pole) as sections of one or two poles, conjugate pairs together,
/// zeros with the nearest poles (in log frequency), in rising order of their poles. Each section has a gain
/// of 1 at 0 Hz (1 at its poles' frequency when it has a zero at the origin); the rest is the cascade's gain. Real poles
/// share a section where a complex pair of zeros needs one, or lies a factor of e nearer to them than otherwise.
/// Needs no more zeros than poles; throws std::logic_error otherwise.
Sections make_sections(double gain, std::vector<Complex> zeros, std::vector<Complex> poles,
                       const SectionMaking& making = {});

/// The whole product H(s) = gain * prod (s - zero)/prod (s - pole).
struct PooledRoots {
  double gain = 1.0;
  std::vector<Complex> zeros;
  std::vector<Complex> poles;
};
PooledRoots pooled_roots(const Sections& sections);

/// The same product with real poles two to a section where there are two; the stated error stays.
Sections as_biquads(const Sections& sections);

/// H(s) = prod_k H_k(s), their delays added; `error` is that of a single one, of several there is none.
Sections in_series(const std::vector<Sections>& parts);

/// Sections in another order (and, where all are of first order, with other pairs), same product.
struct OrderedSections {
  Sections sections;
  /// Largest over the stages of (highest - lowest gain over the band from the input to that stage's output),
  /// dB: what a stage must bear between overload at one frequency and noise at another.
  double span_before_db = 0.0;
  double span_after_db = 0.0;
  bool exhaustive = false;  ///< no other order (and pairing) has a smaller span
};

/// Pairing and ordering for the smallest internal span over the band, which every section of a cascade must
/// bear whatever its gain; then the gains, so that the peaks of the stages lead evenly (in dB) from 1 at the
/// input to the whole's peak. First-order sections with as many zeros as poles: pairs and order together,
/// exhaustively to 8 sections; otherwise the order, exhaustively to 14 sections, beyond unchanged.
OrderedSections order_sections(const Sections& sections, Band band);

}  // namespace bodesmith
