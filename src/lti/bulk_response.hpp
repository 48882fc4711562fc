#pragma once

#include <complex>
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

  void responses(std::span<const RadPerSecond> w, std::span<std::complex<double>> out) const;

  /// (c0 - c2 w^2) + j c1 w, scaled so that its largest coefficient at the roots' frequency is about 1.
  struct Quadratic {
    double c0 = 1.0;
    double c1 = 0.0;
    double c2 = 0.0;
  };

 private:
  double gain_ = 1.0;
  double delay_s_ = 0.0;
  // One numerator beside each denominator; constants (1) where there is no zero.
  std::vector<Quadratic> numerators_;
  std::vector<Quadratic> denominators_;
};

/// H(j2πf) at every frequency: BulkResponse, and Sections::response() where its products leave the range of a double.
/// Handed on in pieces, several threads at once on long grids: use(place of the first, responses).
using PieceOfResponse = std::function<void(std::size_t, std::span<const std::complex<double>>)>;
void for_pieces(const Sections& sections, const std::vector<Hertz>& grid, const PieceOfResponse& use);
/// The same in one array.
std::vector<std::complex<double>> responses(const Sections& sections, const std::vector<Hertz>& grid);

}  // namespace bodesmith
