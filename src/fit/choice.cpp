#include "fit/choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "base/whole_number.hpp"

namespace bodesmith {
namespace {

/// Sections of more poles than this are seldom built, and their search takes seconds an order.
constexpr int kLargestDirectOrder = 8;

double largest_order(const CascadeFit& fit) {
  double out = 0.0;
  for (const CascadeFitTerm& term : fit.terms) out = std::max(out, std::abs(term.beta));
  return out;
}

std::string cascade_text(const CascadeFit& fit, double limit_db) {
  return fmt::format("a cascade of the fewest bands {} {} dB with {} terms of orders up to {}",
                     fit.limit_met ? "meets" : "misses", rounded_text(limit_db), fit.terms.size(),
                     rounded_text(largest_order(fit), 3));
}

}  // namespace

std::optional<std::string> why_unusable(const CascadeFit& fit) {
  const double largest = largest_order(fit);
  const bool few = fit.cascade.fit && fit.cascade.fit->points.size() <= kFewPoints;
  if (largest <= (few ? kLargestUsableOrderOfFewPoints : kLargestUsableOrder)) return std::nullopt;
  return fmt::format("{} bands through these points take orders up to {}, which cannot be built",
                     fit.terms.size(), rounded_text(largest, 3));
}

int least_poles(const CascadeFit& fit) {
  int out = 0;
  for (const CascadeFitTerm& term : fit.terms) {
    if (term.beta != 0.0) out += whole_number<int>(std::ceil(std::abs(term.beta)), 0, 1000) + 1;
  }
  return out;
}

FitChoice choose_fit(const BodePoints& points, const CascadeFitOptions& cascade,
                     const DirectFitOptions& direct, double limit_db) {
  CascadeFitOptions fewest = cascade;
  fewest.fewest_bands_db = limit_db;
  CascadeFit bands = fit_cascade(points, fewest);
  DirectFit sections =
      fit_directly_within(points, direct, limit_db, std::max(1, direct.relative_degree), kLargestDirectOrder);
  const bool bands_do = bands.limit_met && !why_unusable(bands);
  const bool sections_do = sections.max_db <= limit_db;
  const int poles = sections.sections.pole_count();
  FitChoice out;
  if (bands_do && (!sections_do || least_poles(bands) < poles)) {
    out.why = cascade_text(bands, limit_db) +
              (sections_do ? fmt::format(", sections directly need {} poles", poles)
                           : fmt::format(", {} poles directly miss it by {} dB", poles,
                                         rounded_text(sections.max_db - limit_db, 2)));
    out.cascade = std::move(bands);
  } else {
    out.why = fmt::format("{} poles directly {} {} dB, {}", poles, sections_do ? "meet" : "miss",
                          rounded_text(limit_db), cascade_text(bands, limit_db));
    out.sections = std::move(sections);
  }
  return out;
}

}  // namespace bodesmith
