#include "approximate/approximate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "approximate/limit_law.hpp"
#include "approximate/order_search.hpp"
#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "lti/section_making.hpp"

namespace bodesmith {
namespace {

constexpr int kMaxOrder = 40;     ///< of one term, whatever the method
constexpr int kDefaultOrder = 4;  ///< of one term, when neither an order nor a limit is asked for
constexpr double kWhole = 1e-12;  ///< a power within this of a whole number is one

/// A band whose true power is 0 comes out of a fit as a power of rounding's size.
bool is_nothing(const FractionalLeadLag& term) {
  return std::abs(term.beta) < kWhole;
}

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

/// The terms' approximations, or why there are none.
std::variant<std::vector<TermApproximation>, Method::Refusal> approximate_terms(
    const std::vector<FractionalLeadLag>& terms, const ApproximationOptions& options) {
  if (!options.order && options.max_error_db) return search_orders(terms, options, *options.max_error_db);
  std::vector<TermApproximation> out;
  for (const FractionalLeadLag& term : terms) {
    auto made = try_approximate_term(term, options, options.order.value_or(kDefaultOrder));
    if (auto* refusal = std::get_if<Method::Refusal>(&made)) return std::move(*refusal);
    out.push_back(std::get<TermApproximation>(std::move(made)));
  }
  return out;
}

/// The value, or the refusal as an error.
template <class T>
T value_or_throw(std::variant<T, Method::Refusal> outcome) {
  if (const auto* refusal = std::get_if<Method::Refusal>(&outcome)) throw DesignError(refusal->reason);
  return std::get<T>(std::move(outcome));
}

}  // namespace

std::variant<TermApproximation, Method::Refusal> try_approximate_term(const FractionalLeadLag& term,
                                                                      const ApproximationOptions& options,
                                                                      int order) {
  const Method& method = method_registry().get(options.method);
  if (order < 1 || order > kMaxOrder)
    throw InputError(fmt::format("the order is {}, expected 1 to {}", order, kMaxOrder));
  if (is_nothing(term)) throw InputError("a term with beta = 0 is 1 and needs no approximation");
  const double size = std::abs(term.beta);
  const SplitPower power = split_power(method, size);
  if (power.min_order() > order) {
    return Method::Refusal{fmt::format(
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
    if (auto* refusal = std::get_if<Method::Refusal>(&made)) return std::move(*refusal);
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

CascadeApproximation approximate_cascade(const Cascade& cascade, const ApproximationOptions& options) {
  std::vector<FractionalLeadLag> terms;
  std::copy_if(cascade.terms.begin(), cascade.terms.end(), std::back_inserter(terms),
               [](const FractionalLeadLag& term) { return !is_nothing(term); });
  CascadeApproximation out;
  out.method = options.method;
  out.max_error_db = options.max_error_db;
  out.terms = value_or_throw(approximate_terms(terms, options));
  out.sections.gain = cascade.gain;
  for (const TermApproximation& term : out.terms) append(out.sections.sections, term.sections);
  // A plain gain is its own approximation.
  if (out.sections.sections.empty()) return out;
  out.error = approximation_error(out.sections, cascade);
  if (options.max_error_db) out.limit_met = out.error.everywhere_db <= *options.max_error_db;
  out.sections.error = out.error.summary();
  return out;
}

}  // namespace bodesmith
