#pragma once

#include "synthesis/ladders/rc_ladder.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {

/// Sections as RC ladders around inverting op-amps, as fractional elements are built: for poles and zeros
/// that alternate, starting with a pole, H or, starting with a zero, 1/H is an RC impedance Z
/// (rc_ladder.hpp), so
///   lag:  H = -Z(s)/R1 with Z in the feedback,   lead: H = -R2/Z(s) with Z at the input.
/// A whole fractional term (or s^-alpha) becomes one op-amp. The gain is spread over the chains. The level of
/// each ladder is put between the limits of the parts; its values are then searched jointly (exchange of
/// single values and of pairs among their neighbours in the series, from the best levels) for the least
/// |H/H_wanted - 1|. Refused where poles or zeros are complex, right of or on the axis, or not as many of one
/// as of the other, and where no level puts all parts between their limits.
class LadderRealisation final : public Realisation {
 public:
  explicit LadderRealisation(const RcLadder& ladder) : ladder_(ladder) {}
  std::string_view name() const override { return ladder_.name(); }
  /// The values of a ladder spread as wide as its corners do.
  PartLimits usual_limits() const override { return {100.0, 10e6, 47e-12, 4.7e-6}; }
  const RcLadder* ladder() const override { return &ladder_; }
  Outcome<Realised> design(const Sections& sections, const RealiseOptions& options) const override;

 private:
  const RcLadder& ladder_;
};

}  // namespace bodesmith::synthesis
