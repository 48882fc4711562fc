#include "approximate/approximate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "approximate/limit_law.hpp"
#include "approximate/order_search.hpp"
#include "base/error.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "lti/section_making.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

/// Whole powers that the method leaves aside (towards 0, so that the rest keeps beta's sign).
int split_off(const ApproximationMethod& method, double size) {
  if (!method.splits_whole_powers) return 0;
  return static_cast<int>(std::floor(size + 1e-12));
}

/// Zeros and poles of a normalised lead (or the lag that is its reciprocal), scaled to `centre`; together
/// with a gain of its own at 0 Hz, which the ripple may put off 1: that goes to the first section.
std::vector<Section> sections_of(NormalisedApproximation approximation, RadPerSecond centre, bool lag) {
  double gain = approximation.gain;
  for (Complex& zero : approximation.zeros) zero *= centre.value;
  for (Complex& pole : approximation.poles) pole *= centre.value;
  if (lag) {
    std::swap(approximation.zeros, approximation.poles);
    gain = 1.0 / gain;
  }
  Sections made = make_sections(gain, std::move(approximation.zeros), std::move(approximation.poles));
  made.sections.front().gain *= made.gain;
  return std::move(made.sections);
}

double log_magnitude(const Section& section, RadPerSecond w) {
  double out = std::log(std::abs(section.gain));
  for (size_t i = 0; i < section.poles.size(); ++i) {
    const Complex s(0.0, w.value);
    if (i < section.zeros.size())
      out += std::log(std::abs((s - section.zeros[i]) / (s - section.poles[i])));
    else
      out -= std::log(std::abs(s - section.poles[i]));
  }
  return out;
}

double phase(const Section& section, RadPerSecond w) {
  double out = section.gain < 0.0 ? std::numbers::pi : 0.0;
  const Complex s(0.0, w.value);
  for (const Complex& zero : section.zeros) out += std::arg(s - zero);
  for (const Complex& pole : section.poles) out -= std::arg(s - pole);
  return out;
}

struct Difference {
  double db = 0.0;
  double deg = 0.0;
};

Difference difference(const Sections& sections, const Cascade& cascade, RadPerSecond w) {
  double np = std::log(std::abs(sections.gain / cascade.gain));
  double rad = 0.0;
  for (const Section& section : sections.sections) {
    np += log_magnitude(section, w);
    rad += phase(section, w);
  }
  for (const FractionalLeadLag& term : cascade.terms) {
    np -= term.log_magnitude(w);
    rad -= term.phase_rad(w);
  }
  return {kDecibelPerNeper * np, to_degrees(rad)};
}

/// Ends of the frequency axis, exactly.
double difference_at_zero(const Sections& sections, const Cascade& cascade) {
  double np = std::log(std::abs(sections.gain / cascade.gain));
  for (const Section& section : sections.sections) np += std::log(std::abs(section.dc_gain()));
  return kDecibelPerNeper * np;
}
double difference_at_infinity(const Sections& sections, const Cascade& cascade) {
  double np = std::log(std::abs(sections.gain / cascade.gain));
  for (const Section& section : sections.sections) np += std::log(std::abs(section.high_frequency_gain()));
  for (const FractionalLeadLag& term : cascade.terms) np += term.beta * std::log(term.x);
  return kDecibelPerNeper * np;
}

}  // namespace

ApproximationError approximation_error(const Sections& sections, const Cascade& cascade) {
  ApproximationError out;
  out.band = cascade.corner_band();
  const Band corners = sections.corner_band();
  if (corners.to.value > 0.0) {
    out.band.from = std::min(out.band.from, corners.from);
    out.band.to = std::max(out.band.to, corners.to);
  }
  if (!(out.band.to.value > 0.0) || !std::isfinite(out.band.from.value)) out.band = {Hertz{1.0}, Hertz{1.0}};
  // Beyond 100 times the corners nothing turns any more; in between the ripples are wider than the grid by
  // far.
  const double below = out.band.from.value / 100.0;
  const double above = out.band.to.value * 100.0;
  const int count = std::clamp(static_cast<int>(120.0 * std::log10(above / below)), 200, 4000);
  const auto grid = log_grid({Hertz{below}, Hertz{above}}, count);
  const auto visit = [&](Hertz f) {
    const Difference d = difference(sections, cascade, f.rad_s());
    const double db = std::abs(d.db);
    const double deg = std::abs(d.deg);
    if (db > out.everywhere_db) {
      out.everywhere_db = db;
      out.worst = f;
    }
    out.everywhere_deg = std::max(out.everywhere_deg, deg);
    if (f >= out.band.from && f <= out.band.to) {
      out.band_db = std::max(out.band_db, db);
      out.band_deg = std::max(out.band_deg, deg);
    }
  };
  for (const Hertz f : grid) visit(f);
  visit(out.band.from);
  visit(out.band.to);
  const double at_zero = std::abs(difference_at_zero(sections, cascade));
  const double at_infinity = std::abs(difference_at_infinity(sections, cascade));
  if (at_zero > out.everywhere_db) {
    out.everywhere_db = at_zero;
    out.worst = grid.front();
  }
  if (at_infinity > out.everywhere_db) {
    out.everywhere_db = at_infinity;
    out.worst = grid.back();
  }
  return out;
}

TermApproximation approximate_term(const FractionalLeadLag& term, const ApproximationOptions& options,
                                   int order) {
  const ApproximationMethod& method = approximation_method(options.method);
  if (order < 1 || order > 40) throw InputError(fmt::format("the order is {}, expected 1 to 40", order));
  if (term.beta == 0.0) throw InputError("a term with beta = 0 is 1 and needs no approximation");
  const double size = std::abs(term.beta);
  int whole = split_off(method, size);
  double rest = size - whole;
  if (std::abs(rest) < 1e-12) rest = 0.0;
  if (whole + (rest > 0.0 ? 1 : 0) > order) {
    throw DesignError(fmt::format("{} with beta = {} needs an order of at least {}, not {}", method.name,
                                  term.beta, whole + (rest > 0.0 ? 1 : 0), order));
  }
  // (s/f1 + 1)/(s/f2 + 1) with f1 > f2 is the reciprocal of the term with the corners exchanged.
  const bool lag = !term.rises();
  const double kappa = term.corner_ratio();
  const RadPerSecond centre{std::sqrt(term.first_corner().value) * std::sqrt(term.second_corner().value)};

  TermApproximation out;
  out.term = term;
  out.order = order;
  for (int i = 0; i < whole; ++i) {
    Section section = Section::pole_zero(1.0, lag ? term.high_corner() : term.low_corner(),
                                         lag ? term.low_corner() : term.high_corner());
    out.sections.push_back(std::move(section));
  }
  if (rest > 0.0 || whole == 0) {
    ApproximationTask task;
    task.kappa = kappa;
    task.beta = rest;
    task.order = order - whole;
    task.real_roots = options.real_roots;
    task.over_band = options.over_band;
    auto sections = sections_of(method.approximate(task), centre, lag);
    out.sections.insert(out.sections.end(), std::make_move_iterator(sections.begin()),
                        std::make_move_iterator(sections.end()));
  }
  if (size < order + 1) out.limit_law_db = minimax_limit_db(kappa, size, order);
  Sections alone;
  alone.sections = out.sections;
  Cascade one;
  one.terms = {term};
  out.error = approximation_error(alone, one);
  return out;
}

CascadeApproximation approximate_cascade(const Cascade& cascade, const ApproximationOptions& options) {
  CascadeApproximation out;
  out.method = options.method;
  std::vector<FractionalLeadLag> terms;
  std::copy_if(cascade.terms.begin(), cascade.terms.end(), std::back_inserter(terms),
               [](const FractionalLeadLag& term) { return term.beta != 0.0; });
  if (options.order || !options.max_error_db) {
    for (const FractionalLeadLag& term : terms) {
      out.terms.push_back(approximate_term(term, options, options.order.value_or(4)));
    }
  } else {
    out.max_error_db = *options.max_error_db;
    out.terms = search_orders(terms, options);
  }
  out.sections.gain = cascade.gain;
  for (const TermApproximation& term : out.terms) {
    out.sections.sections.insert(out.sections.sections.end(), term.sections.begin(), term.sections.end());
  }
  if (out.sections.sections.empty()) {
    throw DesignError(
        "the cascade has no term with beta other than 0: it is a plain gain and needs no sections");
  }
  out.error = approximation_error(out.sections, cascade);
  if (options.max_error_db) {
    out.max_error_db = *options.max_error_db;
    out.limit_met = out.error.everywhere_db <= *options.max_error_db;
  }
  out.sections.error =
      Sections::Error{out.error.band, out.error.band_db, out.error.band_deg, out.error.everywhere_db};
  return out;
}

Json CascadeApproximation::report_json() const {
  Json out;
  out["method"] = method;
  if (max_error_db > 0.0) out["max_error_db"] = max_error_db;
  out["limit_met"] = limit_met;
  out["everywhere_max_magnitude_db"] = error.everywhere_db;
  out["everywhere_max_phase_deg"] = error.everywhere_deg;
  out["worst_hz"] = error.worst.value;
  out["terms"] = Json::array();
  for (const TermApproximation& term : terms) {
    out["terms"].push_back({{"lambda_s", term.term.lambda_s},
                            {"x", term.term.x},
                            {"beta", term.term.beta},
                            {"order", term.order},
                            {"max_magnitude_db", term.error.band_db},
                            {"max_phase_deg", term.error.band_deg},
                            {"everywhere_max_magnitude_db", term.error.everywhere_db},
                            {"everywhere_max_phase_deg", term.error.everywhere_deg},
                            {"limit_law_db", term.limit_law_db}});
  }
  return out;
}

}  // namespace bodesmith
