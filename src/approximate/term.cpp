#include "approximate/term.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "approximate/limit_law.hpp"
#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "lti/section_making.hpp"

namespace bodesmith {
namespace {

constexpr int kMaxOrder = 40;     ///< of one term, whatever the method
constexpr double kWhole = 1e-12;  ///< a power within this of a whole number is one

/// |beta| = whole + rest: what is split off as exact sections, and what is left to the method.
struct SplitPower {
  int whole = 0;
  double rest = 0.0;
  int min_order() const { return whole + (rest > 0.0 ? 1 : 0); }
};

SplitPower split_power(const Method& method, double size) {
  SplitPower out;
  if (method.splits_whole_powers()) out.whole = whole_number<int>(std::floor(size + kWhole));
  out.rest = size - out.whole;
  if (std::abs(out.rest) < kWhole) out.rest = 0.0;
  return out;
}

/// Zeros and poles of a normalised lead (or the lag that is its reciprocal), scaled to `centre`; together
/// with a gain of its own at 0 Hz, which the ripple may put off 1: that goes to the first section.
std::vector<Section> sections_of(NormalisedApproximation approximation, RadPerSecond centre, bool lag) {
  double gain = approximation.gain;
  for (auto& zero : approximation.zeros) zero *= centre.value;
  for (auto& pole : approximation.poles) pole *= centre.value;
  if (lag) {
    std::swap(approximation.zeros, approximation.poles);
    gain = 1.0 / gain;
  }
  Sections made = make_sections(gain, std::move(approximation.zeros), std::move(approximation.poles));
  made.sections.front().gain *= made.gain;
  return std::move(made.sections);
}

void append(std::vector<Section>& to, const std::vector<Section>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

ApproximationError term_error(const std::vector<Section>& sections, const FractionalLeadLag& term) {
  Sections alone;
  alone.sections = sections;
  Cascade cascade;
  cascade.terms = {term};
  return approximation_error(alone, cascade);
}

}  // namespace

bool is_nothing(const FractionalLeadLag& term) {
  return std::abs(term.beta) < kWhole;
}

Outcome<TermApproximation> try_approximate_term(const FractionalLeadLag& term,
                                                const ApproximationOptions& options, int order) {
  const Method& method = method_registry().get(options.method);
  if (order < 1 || order > kMaxOrder)
    throw InputError(fmt::format("the order is {}, expected 1 to {}", order, kMaxOrder));
  if (is_nothing(term)) throw InputError("a term with beta = 0 is 1 and needs no approximation");
  const double size = std::abs(term.beta);
  // Its gain at high frequencies, x^-beta.
  constexpr double kMostGainNepers = 700.0;
  if (!(size * std::abs(std::log(term.x)) <= kMostGainNepers))
    throw DesignError(fmt::format(
        "a term with x = {} and beta = {} changes its gain by more than double precision can hold (6000 dB)",
        term.x, term.beta));
  const SplitPower power = split_power(method, size);
  if (power.min_order() > order) {
    return Refusal{fmt::format(
        "{} with beta = {} needs an order of at least {}, not {}; the method minimax makes its best of any "
        "order",
        method.name(), term.beta, power.min_order(), order)};
  }
  // (s/f1 + 1)/(s/f2 + 1) with f1 > f2 is the reciprocal of the term with the corners exchanged.
  const bool lag = !term.rises();
  const RadPerSecond zero = lag ? term.high_corner() : term.low_corner();
  const RadPerSecond pole = lag ? term.low_corner() : term.high_corner();
  const RadPerSecond centre{std::sqrt(term.first_corner().value) * std::sqrt(term.second_corner().value)};

  TermApproximation out;
  out.term = term;
  out.order = order;
  out.sections.assign(static_cast<std::size_t>(power.whole), Section::pole_zero(1.0, zero, pole));
  if (power.rest > 0.0 || power.whole == 0) {
    auto made = method.approximate({.kappa = term.corner_ratio(),
                                    .beta = power.rest,
                                    .order = order - power.whole,
                                    .real_roots = options.real_roots,
                                    .over_band = options.over_band});
    if (auto* refusal = std::get_if<Refusal>(&made)) return std::move(*refusal);
    append(out.sections, sections_of(std::get<NormalisedApproximation>(std::move(made)), centre, lag));
  }
  if (size < order + 1) out.limit_law_db = minimax_limit_db(term.corner_ratio(), size, order);
  out.error = term_error(out.sections, term);
  return out;
}

TermApproximation approximate_term(const FractionalLeadLag& term, const ApproximationOptions& options,
                                   int order) {
  return value_or_throw(try_approximate_term(term, options, order));
}

}  // namespace bodesmith
