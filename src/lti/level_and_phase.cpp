#include "lti/level_and_phase.hpp"

#include <cmath>

#include "base/units.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith {

LevelAndPhase level_and_phase(std::span<const std::complex<double>> response) {
  const std::size_t n = response.size();
  LevelAndPhase out;
  out.magnitude_db.resize(n);
  out.phase_deg.resize(n);
  // Logarithms and angles side by side; only the turns depend on the value before.
  constexpr std::size_t kPiece = 8192;
  parallel_for((n + kPiece - 1) / kPiece, n > 2 * kPiece ? thread_count(0) : 1, [&](std::size_t piece) {
    const std::size_t end = std::min(n, (piece + 1) * kPiece);
    for (std::size_t i = piece * kPiece; i < end; ++i) {
      const std::complex<double> h = response[i];
      const double square = std::norm(h);
      // The square of a gain may leave the range of a double where the gain does not.
      const bool safe = square > 1e-290 && square < 1e290;
      out.magnitude_db[i] = safe ? 10.0 * std::log10(square) : to_decibel(std::abs(h));
      out.phase_deg[i] = to_degrees(std::arg(h));
    }
  });
  double turns = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    const double step = out.phase_deg[i] + turns - out.phase_deg[i - 1];
    if (std::abs(step) > 180.0) turns -= 360.0 * std::round(step / 360.0);
    out.phase_deg[i] += turns;
  }
  return out;
}

}  // namespace bodesmith
