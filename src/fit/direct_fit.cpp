#include "fit/direct_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "fit/curve_search.hpp"
#include "fit/start_builder.hpp"
#include "lti/section_making.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr size_t kMostScreeningPoints = 160;  ///< dense curves are thinned while starts are screened
constexpr size_t kMostFinalPoints = 3000;

CurveTarget thin(const CurveTarget& full, size_t most) {
  const size_t n = full.frequency.size();
  if (n <= most) return full;
  CurveTarget out;
  out.masks = full.masks;
  // Evenly over log frequency, always a point of the data.
  const double low = std::log(full.frequency.front().value);
  const double high = std::log(full.frequency.back().value);
  size_t at = 0;
  for (size_t i = 0; i < most; ++i) {
    const double wanted = low + (high - low) * static_cast<double>(i) / static_cast<double>(most - 1);
    size_t next = at;
    while (next + 1 < n && std::log(full.frequency[next].value) < wanted) ++next;
    if (i > 0 && next == at) continue;
    at = next;
    out.frequency.push_back(full.frequency[at]);
    out.log_gain.push_back(full.log_gain[at]);
    out.weight.push_back(full.weight[at]);
    if (!full.phase_rad.empty()) out.phase_rad.push_back(full.phase_rad[at]);
  }
  return out;
}

/// The points joined by straight lines in log-log, as a faint wish between them: what keeps an
/// underdetermined fit calm.
CurveTarget joined(const CurveTarget& points, double weight) {
  CurveTarget out = points;
  for (size_t i = 0; i + 1 < points.frequency.size(); ++i) {
    for (int k = 1; k < 8; ++k) {
      const double t = k / 8.0;
      out.frequency.push_back({std::exp((1 - t) * std::log(points.frequency[i].value) +
                                        t * std::log(points.frequency[i + 1].value))});
      out.log_gain.push_back((1 - t) * points.log_gain[i] + t * points.log_gain[i + 1]);
      out.weight.push_back(weight);
      if (!points.phase_rad.empty())
        out.phase_rad.push_back((1 - t) * points.phase_rad[i] + t * points.phase_rad[i + 1]);
    }
  }
  return out;
}

double mask_db(const BodePoints& mask, double log_w, bool& inside) {
  const auto& p = mask.points;
  inside = false;
  for (size_t i = 0; i + 1 < p.size(); ++i) {
    const double a = std::log(p[i].frequency.rad_s().value);
    const double b = std::log(p[i + 1].frequency.rad_s().value);
    if (log_w < a - 1e-12 || log_w > b + 1e-12) continue;
    inside = true;
    const double t = (log_w - a) / (b - a);
    return (1 - t) * std::log(p[i].gain) + t * std::log(p[i + 1].gain);
  }
  return 0.0;
}

void add_mask(CurveTarget& target, const std::optional<BodePoints>& mask, int side) {
  if (!mask || mask->points.size() < 2) return;
  for (const Hertz f : log_grid({mask->points.front().frequency, mask->points.back().frequency}, 80)) {
    bool inside = false;
    const double limit = mask_db(*mask, std::log(f.rad_s().value), inside);
    if (inside) target.masks.push_back({f.rad_s(), limit, side});
  }
}

CurveTarget make_target(const BodePoints& points, const DirectFitOptions& options) {
  CurveTarget target;
  double turns = 0.0;
  double last = 0.0;
  for (const BodePoint& point : points.points) {
    if (point.weight == 0.0) continue;
    target.frequency.push_back(point.frequency.rad_s());
    target.log_gain.push_back(std::log(point.gain));
    target.weight.push_back(point.weight);
    if (options.use_phase) {
      if (!point.phase_deg)
        throw InputError(points.file, point.line, "has no phase_deg, expected one to fit phase");
      const double here = to_radians(*point.phase_deg);
      if (!target.phase_rad.empty())
        turns -= 2.0 * std::numbers::pi * std::round((here + turns - last) / (2.0 * std::numbers::pi));
      last = here + turns;
      target.phase_rad.push_back(last);
    }
  }
  if (target.frequency.empty()) throw InputError(points.file, 0, "has no point with a weight above 0");
  add_mask(target, options.upper, 1);
  add_mask(target, options.lower, -1);
  return target;
}

double mean_gain(const CurveTarget& target) {
  double sum = 0.0;
  double weight = 0.0;
  for (size_t i = 0; i < target.frequency.size(); ++i) {
    sum += target.weight[i] * target.log_gain[i];
    weight += target.weight[i];
  }
  return sum / weight;
}

double worst_miss_db(const RootModel::Roots& roots, const CurveTarget& target) {
  double worst = 0.0;
  for (size_t i = 0; i < target.frequency.size(); ++i) {
    const std::complex<double> s(0.0, target.frequency[i].value);
    double log_gain = std::log(roots.gain);
    for (const auto& z : roots.zeros) log_gain += std::log(std::abs(s - z));
    for (const auto& p : roots.poles) log_gain -= std::log(std::abs(s - p));
    worst = std::max(worst, target.weight[i] * std::abs(log_gain - target.log_gain[i]));
  }
  return kDecibelPerNeper * worst;
}

/// Takes away poles and zeros that cancel without making the fit worse by more than a thousandth (or 1e-5 dB:
/// rounding of a fit that is exact with fewer). Returns how many poles went.
int drop_cancelling(RootModel::Roots& roots, const CurveTarget& target, double value_db) {
  const double allowed = std::max(1.001 * std::max(value_db, worst_miss_db(roots, target)), 1e-5);
  int dropped = 0;
  for (bool again = true; again;) {
    again = false;
    for (size_t z = 0; z < roots.zeros.size() && !again; ++z) {
      for (size_t p = 0; p < roots.poles.size() && !again; ++p) {
        const auto zero = roots.zeros[z];
        const auto pole = roots.poles[p];
        if (zero.imag() < 0.0 || (zero.imag() == 0.0) != (pole.imag() == 0.0) || pole.imag() < 0.0) continue;
        if (std::abs(zero - pole) > 1e-2 * std::abs(pole)) continue;
        RootModel::Roots fewer = roots;
        // A conjugate stands right behind its root.
        const auto count = zero.imag() == 0.0 ? 1 : 2;
        const auto zero_at = fewer.zeros.begin() + static_cast<std::ptrdiff_t>(z);
        const auto pole_at = fewer.poles.begin() + static_cast<std::ptrdiff_t>(p);
        fewer.zeros.erase(zero_at, zero_at + count);
        fewer.poles.erase(pole_at, pole_at + count);
        if (fewer.poles.empty() || worst_miss_db(fewer, target) > allowed) continue;
        roots = std::move(fewer);
        dropped += count;
        again = true;
      }
    }
  }
  return dropped;
}

/// Exchange moves: each group of poles goes, with the zeros nearest to it, to other places, and everything is
/// improved again. Leaves valleys that no start led out of. Returns the number of tries.
int move_groups(const RootModel& model, const CurveTarget& screening, const CurveTarget& target,
                const RootLimits& limits, const StartBuilder::Settings& settings, bool least_squares,
                SearchResult& best) {
  constexpr int kRounds = 3;
  constexpr int kPlaces = 9;
  constexpr size_t kRefined = 3;
  const double low = std::log(settings.low.value);
  const double high = std::log(settings.high.value);
  int tried = 0;
  for (int round = 0; round < kRounds && best.value > 1e-6; ++round) {
    std::vector<SearchResult> found;
    const Index first_zero_pair = 1 + model.real_zeros;
    const Index first_real_pole = first_zero_pair + 2 * model.zero_pairs;
    const Index first_pole_pair = first_real_pole + model.real_poles;
    const auto try_moves = [&](Index first_zero, int zeros, Index first_pole, int poles, bool pair) {
      const int width = pair ? 2 : 1;
      for (int p = 0; p < poles; ++p) {
        const Index pole = first_pole + width * p;
        Index zero = -1;
        for (int z = 0; z < zeros; ++z) {
          const Index here = first_zero + width * z;
          if (zero < 0 ||
              std::abs(best.theta(here) - best.theta(pole)) < std::abs(best.theta(zero) - best.theta(pole)))
            zero = here;
        }
        if (zero < 0) continue;
        for (int i = 0; i < kPlaces; ++i) {
          for (const double split : {0.15, -0.15}) {
            VectorXd theta = best.theta;
            const double at = low + (high - low) * (i + 0.5) / kPlaces;
            theta(zero) = pair ? at : at + split;
            theta(pole) = pair ? at : at - split;
            if (pair) {
              theta(zero + 1) = std::log(split > 0.0 ? 0.5 : 0.8);
              theta(pole + 1) = std::log(split > 0.0 ? 0.8 : 0.5);
            }
            found.push_back(search_least_squares(model, screening, limits, theta, 30));
            ++tried;
          }
        }
      }
    };
    try_moves(1, model.real_zeros, first_real_pole, model.real_poles, false);
    try_moves(first_zero_pair, model.zero_pairs, first_pole_pair, model.pole_pairs, true);
    std::stable_sort(found.begin(), found.end(),
                     [](const SearchResult& a, const SearchResult& b) { return a.value < b.value; });
    const double before = best.value;
    double last = -1.0;
    size_t refined = 0;
    for (const SearchResult& start : found) {
      if (refined == kRefined) break;
      if (start.value < 1.002 * last) continue;
      last = start.value;
      ++refined;
      const SearchResult result = search_constrained(model, target, limits, start.theta, least_squares, 60);
      if (result.value < best.value) best = result;
    }
    if (best.value > 0.995 * before) break;
  }
  return tried;
}

}  // namespace

DirectFit fit_directly(const BodePoints& points, const DirectFitOptions& options) {
  if (options.order < 1 || options.order > 12)
    throw InputError(fmt::format("the order is {}, expected 1 to 12", options.order));
  if (options.relative_degree < 0 || options.relative_degree > options.order) {
    throw InputError(fmt::format("the relative degree is {}, expected 0 to the order {}",
                                 options.relative_degree, options.order));
  }
  const CurveTarget target = thin(make_target(points, options), kMostFinalPoints);
  const RadPerSecond lowest = target.frequency.front();
  const RadPerSecond highest = target.frequency.back();
  RootLimits limits;
  limits.low = {lowest.value / 1000.0};
  limits.high = {options.max_corner ? options.max_corner->rad_s().value : highest.value * 1000.0};
  if (limits.high.value <= limits.low.value) limits.low = {limits.high.value / 1e4};
  limits.least_damping = options.least_damping;
  const RadPerSecond reference{std::sqrt(lowest.value * highest.value)};
  const int zeros = options.order - options.relative_degree;
  const bool underdetermined = static_cast<Index>(target.frequency.size()) <=
                               StartBuilder::make_model(zeros, options.order, true, reference).size();
  const CurveTarget screening = underdetermined ? joined(target, 0.02) : thin(target, kMostScreeningPoints);
  StartBuilder::Settings settings;
  settings.low = {std::clamp(lowest.value / std::numbers::e, limits.low.value, limits.high.value / 3.0)};
  settings.high = {std::clamp(highest.value * std::numbers::e, settings.low.value * 2.0, limits.high.value)};
  settings.log_gain = mean_gain(target);
  settings.random = options.starts;
  settings.kept = 8;
  settings.seed = options.seed;

  RootModel model;
  SearchResult best;
  best.value = INFINITY;
  int tried = 0;
  // Pairs reach real roots too, but their seam is hard to cross: complex fits try real ones as well.
  for (const bool real : options.real ? std::vector<bool>{true} : std::vector<bool>{false, true}) {
    if (best.value < 1e-7) break;
    settings.real = real;
    settings.random = real && !options.real ? options.starts / 4 : options.starts;
    StartBuilder builder(settings, [&](const RootModel& shape, const VectorXd& start) {
      return search_least_squares(shape, screening, limits, start, 40);
    });
    const RootModel shape = StartBuilder::make_model(zeros, options.order, real, reference);
    const std::vector<SearchResult> starts = builder.build(zeros, options.order, reference);
    tried += builder.tried();
    for (const SearchResult& start : starts) {
      SearchResult result = search_constrained(shape, screening, limits, start.theta, true, 30);
      if (underdetermined && target.masks.empty()) {
        result = search_interpolation(shape, target, limits, result.theta, 60);
      }
      if (!underdetermined || result.value > 1e-6) {
        result = search_constrained(shape, target, limits, result.theta, options.least_squares, 80);
      }
      if (result.value < best.value * (1.0 - 1e-6)) {
        best = result;
        model = shape;
      }
    }
  }

  if (!underdetermined)
    tried += move_groups(model, screening, target, limits, settings, options.least_squares, best);

  DirectFit out;
  RootModel::Roots roots = model.roots(best.theta);
  out.cancelled = drop_cancelling(roots, target, kDecibelPerNeper * best.value);
  out.sections = make_sections(roots.gain, roots.zeros, roots.poles);
  out.parameters = static_cast<int>(model.size());
  out.starts_tried = tried;
  double square = 0.0;
  double weight = 0.0;
  double loudest = -INFINITY;
  size_t at = 0;
  const CurveTarget all = make_target(points, options);
  for (const BodePoint& point : points.points) {
    const double wanted = to_decibel(point.gain);
    const auto response = model.log_response(best.theta, point.frequency.rad_s());
    const double got = to_decibel(std::abs(out.sections.response(point.frequency.rad_s())));
    out.points.push_back({point.frequency, wanted, got});
    loudest = std::max(loudest, wanted);
    if (point.weight == 0.0) continue;
    out.max_db = std::max(out.max_db, std::abs(got - wanted));
    square += point.weight * (got - wanted) * (got - wanted);
    weight += point.weight;
    if (options.use_phase)
      out.max_phase_deg =
          std::max(out.max_phase_deg, std::abs(to_degrees(response.imag() - all.phase_rad[at])));
    ++at;
  }
  out.rms_db = std::sqrt(square / weight);
  for (const CurveTarget::Mask& mask : target.masks) {
    const double over = mask.side * (model.log_response(best.theta, mask.frequency).real() - mask.log_gain);
    out.mask_violation_db = std::max(out.mask_violation_db, kDecibelPerNeper * over);
  }
  out.highest_gain_above_band_db = -INFINITY;
  for (const Hertz f :
       log_grid({highest.hz(), Hertz{std::max(limits.high.value, highest.value) / 6.0 * 100.0}}, 300)) {
    out.highest_gain_above_band_db = std::max(
        out.highest_gain_above_band_db, to_decibel(std::abs(out.sections.response(f.rad_s()))) - loudest);
  }
  if (out.highest_gain_above_band_db > 6.0) {
    out.warnings.push_back(
        fmt::format("above the points the gain rises {} dB over the largest of them: cap the corners with "
                    "--max-corner-hz",
                    rounded_text(out.highest_gain_above_band_db, 3)));
  }
  if (underdetermined) {
    out.warnings.push_back(fmt::format(
        "{} points for {} free numbers: between the points the curve is only kept near straight lines",
        target.frequency.size(), model.size()));
  }
  if (out.mask_violation_db > 1e-6) {
    out.warnings.push_back(fmt::format("a mask is missed by {} dB", rounded_text(out.mask_violation_db, 3)));
  }
  out.sections.error = Sections::Error{{points.points.front().frequency, points.points.back().frequency},
                                       out.max_db,
                                       out.max_phase_deg,
                                       out.max_db};
  return out;
}

Json DirectFit::report_json() const {
  Json out;
  out["points"] = Json::array();
  for (const DirectFitPoint& point : points) {
    out["points"].push_back(
        {{"frequency_hz", point.frequency.value}, {"wanted_db", point.wanted_db}, {"got_db", point.got_db}});
  }
  out["rms_db"] = rms_db;
  out["max_db"] = max_db;
  out["mask_violation_db"] = mask_violation_db;
  out["highest_gain_above_band_db"] = highest_gain_above_band_db;
  out["parameters"] = parameters;
  out["starts_tried"] = starts_tried;
  out["cancelled_poles"] = cancelled;
  out["warnings"] = warnings;
  return out;
}

DirectFit fit_directly_within(const BodePoints& points, DirectFitOptions options, double limit_db,
                              int min_order, int max_order) {
  DirectFit fit;
  for (options.order = min_order; options.order <= max_order; ++options.order) {
    fit = fit_directly(points, options);
    if (fit.max_db <= limit_db) break;
  }
  return fit;
}

}  // namespace bodesmith
