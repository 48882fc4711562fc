#include "approximate/merge_sections.hpp"

#include <algorithm>
#include <cmath>

#include "lti/section_making.hpp"

namespace bodesmith {
namespace {

/// Sets the gain that balances the largest errors up and down; returns what is then left, dB.
double balance_gain(PooledRoots& roots, const Cascade& cascade, const std::vector<Hertz>& grid) {
  const Sections whole = make_sections(roots.gain, roots.zeros, roots.poles);
  double low = INFINITY;
  double high = -INFINITY;
  for (const Hertz f : grid) {
    const RadPerSecond w = f.rad_s();
    const double error = to_decibel(std::abs(whole.response(w))) - cascade.magnitude_db(w);
    low = std::min(low, error);
    high = std::max(high, error);
  }
  roots.gain *= from_decibel(-0.5 * (low + high));
  return 0.5 * (high - low);
}

/// The real pair closest in log frequency; false when there is none.
bool leave_out_closest(PooledRoots& roots) {
  double best = INFINITY;
  std::size_t zero = 0;
  std::size_t pole = 0;
  for (std::size_t i = 0; i < roots.zeros.size(); ++i) {
    for (std::size_t j = 0; j < roots.poles.size(); ++j) {
      const Complex z = roots.zeros[i];
      const Complex p = roots.poles[j];
      if (z.imag() != 0.0 || p.imag() != 0.0 || !(z.real() * p.real() > 0.0)) continue;
      const double distance = std::abs(std::log(z.real() / p.real()));
      if (distance >= best) continue;
      best = distance;
      zero = i;
      pole = j;
    }
  }
  if (!std::isfinite(best)) return false;
  roots.gain *= std::sqrt(roots.zeros[zero].real() / roots.poles[pole].real());
  roots.zeros.erase(roots.zeros.begin() + static_cast<std::ptrdiff_t>(zero));
  roots.poles.erase(roots.poles.begin() + static_cast<std::ptrdiff_t>(pole));
  return true;
}

}  // namespace

MergedSections merge_sections(const Sections& sections, const Cascade& cascade, double limit_db) {
  MergedSections out{.sections = sections, .error = approximation_error(sections, cascade)};
  if (cascade.terms.empty() || sections.sections.size() < 2) return out;
  const Band corners = cascade.corner_band();
  const std::vector<Hertz> grid =
      log_grid({Hertz{corners.from.value * 1e-4}, Hertz{corners.to.value * 1e4}}, 1201);
  PooledRoots roots = pooled_roots(sections);
  while (roots.poles.size() > 1 && leave_out_closest(roots)) {
    if (balance_gain(roots, cascade, grid) > limit_db) break;
    const Sections made = make_sections(roots.gain, roots.zeros, roots.poles);
    const ApproximationError error = approximation_error(made, cascade);
    if (error.everywhere_db > limit_db) break;
    out.sections = made;
    out.error = error;
    ++out.pairs_left_out;
  }
  out.sections.error = out.error.summary();
  return out;
}

}  // namespace bodesmith
