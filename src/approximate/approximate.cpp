#include "approximate/approximate.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "approximate/order_search.hpp"

namespace bodesmith {
namespace {

constexpr int kDefaultOrder = 4;  ///< of one term, when neither an order nor a limit is asked for

/// The terms' approximations, or why there are none.
Outcome<std::vector<TermApproximation>> approximate_terms(const std::vector<FractionalLeadLag>& terms,
                                                          const ApproximationOptions& options) {
  if (!options.order && options.max_error_db) return search_orders(terms, options, *options.max_error_db);
  std::vector<TermApproximation> out;
  for (const FractionalLeadLag& term : terms) {
    auto made = try_approximate_term(term, options, options.order.value_or(kDefaultOrder));
    if (auto* refusal = std::get_if<Refusal>(&made)) return std::move(*refusal);
    out.push_back(std::get<TermApproximation>(std::move(made)));
  }
  return out;
}

}  // namespace

CascadeApproximation approximate_cascade(const Cascade& cascade, const ApproximationOptions& options) {
  std::vector<FractionalLeadLag> terms;
  std::copy_if(cascade.terms.begin(), cascade.terms.end(), std::back_inserter(terms),
               [](const FractionalLeadLag& term) { return !is_nothing(term); });
  CascadeApproximation out;
  out.method = options.method;
  out.max_error_db = options.max_error_db;
  out.terms = value_or_throw(approximate_terms(terms, options));
  out.sections.gain = cascade.gain;
  for (const TermApproximation& term : out.terms)
    out.sections.sections.insert(out.sections.sections.end(), term.sections.begin(), term.sections.end());
  // A plain gain is its own approximation.
  if (out.sections.sections.empty()) return out;
  out.error = approximation_error(out.sections, cascade);
  if (options.max_error_db) out.limit_met = out.error.everywhere_db <= *options.max_error_db;
  out.sections.error = out.error.summary();
  return out;
}

}  // namespace bodesmith
