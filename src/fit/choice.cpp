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
  if (largest <= kLargestUsableOrder) return std::nullopt;
  return fmt::format("{} bands through these points take orders up to {}, which cannot be built",
                     fit.terms.size(), rounded_text(largest, 3));
}

namespace {

constexpr int kMaxSplits = 4;
constexpr double kWorthASplit = 0.1;  ///< of the largest error: a split is a term more to build

/// In the middle (of log frequency) of the band that ends at the point with the largest error.
Hertz worst_band_middle(const CascadeFit& fit, const std::vector<Hertz>& splits) {
  Hertz from = fit.base;
  Hertz worst_from = from;
  Hertz worst_to = from;
  double most = -1.0;
  for (const Cascade::FitPoint& point : fit.cascade.fit->points) {
    const double error = std::abs(point.got_db - point.wanted_db);
    if (error > most) {
      most = error;
      worst_from = from;
      worst_to = point.frequency;
    }
    from = point.frequency;
  }
  for (const Hertz split : splits)
    if (worst_from < split && split < worst_to) worst_from = split;
  return Hertz{std::sqrt(worst_from.value * worst_to.value)};
}

}  // namespace

ChartedFit fit_by_chart(const BodePoints& points, const CascadeFitOptions& options) {
  ChartedFit out{fit_cascade(points, options), {}};
  if (options.bounded() || options.fewest_bands_db || options.fitted_terms > 0 || !options.corners.empty())
    return out;
  const std::optional<std::string> unusable = why_unusable(out.fit);
  if (!unusable) return out;
  CascadeFitOptions bounded = options;
  bounded.beta_max = kChartBound;
  out.fit = fit_cascade(points, bounded);
  const auto left = [&] { return out.fit.cascade.fit->max_db; };
  out.steps.push_back(fmt::format("{}: bounded by {} (eq. 19), which leaves {} dB at a point", *unusable,
                                  rounded_text(kChartBound), rounded_text(left(), 3)));
  for (int i = 0; i < kMaxSplits; ++i) {
    CascadeFitOptions split = bounded;
    split.splits.push_back(worst_band_middle(out.fit, bounded.splits));
    std::ranges::sort(split.splits);
    CascadeFit more = fit_cascade(points, split);
    if (more.cascade.fit->max_db > (1.0 - kWorthASplit) * left()) break;
    const auto added = std::ranges::find_if(
        split.splits, [&](Hertz f) { return std::ranges::find(bounded.splits, f) == bounded.splits.end(); });
    bounded = split;
    out.fit = std::move(more);
    out.steps.push_back(
        fmt::format("a band split at {} Hz: {} dB", rounded_text(added->value), rounded_text(left(), 3)));
  }
  return out;
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
