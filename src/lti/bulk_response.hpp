#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/units.hpp"
#include "lti/sections.hpp"

namespace bodesmith {

/// Responses of a section chain at very many frequencies: roots are paired into real quadratics once, then
/// many frequencies run side by side with one division for every eight poles. Agrees with
/// Sections::response() to a few rounding errors of the whole product. No allocation after construction.
class BulkResponse {
 public:
  explicit BulkResponse(const Sections& sections);

  void responses(std::span<const RadPerSecond> w, std::span<Complex> out) const;

  /// (c0 - c2 w^2) + j c1 w, scaled so that its largest coefficient at the roots' frequency is about 1.
  struct Quadratic {
    double c0 = 1.0;
    double c1 = 0.0;
    double c2 = 0.0;
  };

 private:
  double gain_ = 1.0;
  double delay_s_ = 0.0;
  // One numerator for each denominator; constants (1) where there is no zero.
  std::vector<Quadratic> numerators_;
  std::vector<Quadratic> denominators_;
};

/// H(j2πf) at every frequency: BulkResponse, and Sections::response() where its products leave the range of a double.
/// Handed on in pieces, several threads at once on long grids: use(place of the first, responses).
using PieceOfResponse = std::function<void(std::size_t, std::span<const Complex>)>;
void for_pieces(const Sections& sections, const std::vector<Hertz>& grid, const PieceOfResponse& use);
/// The same in one array.
std::vector<Complex> responses(const Sections& sections, const std::vector<Hertz>& grid);

/// A response along a grid as a Bode plot shows it.
struct LevelAndPhase {
  std::vector<double> magnitude_db;
  std::vector<double> phase_deg;  ///< without jumps of more than half a turn from one frequency to the next
};
LevelAndPhase level_and_phase(std::span<const Complex> response);
/// Of sections, without keeping the responses in between; the phase turns as their roots do, however coarse the grid.
LevelAndPhase level_and_phase(const Sections& sections, const std::vector<Hertz>& grid);

/// Group delay -d(arg H)/dw in seconds. Of sections in closed form, sum Re 1/(jw - p) - sum Re 1/(jw - z) + delay.
double group_delay_s(const Sections& sections, RadPerSecond w);
/// Of any response by a central difference over 2e-4 of the frequency (relative error about 1e-8 where H is smooth).
double group_delay_s(const std::function<Complex(Hertz)>& response, Hertz f);

}  // namespace bodesmith
