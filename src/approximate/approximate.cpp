#include "approximate/approximate.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

#include "base/whole_number.hpp"

namespace bodesmith {
namespace {

using Orders = std::vector<int>;  ///< one a term

/// Error curves of the candidate approximations on one grid for all terms: the curves of a product add.
class OrderCandidates {
 public:
  OrderCandidates(const std::vector<FractionalLeadLag>& terms, const ApproximationOptions& options)
      : terms_(terms), options_(options), known_(terms.size()) {
    double low = INFINITY;
    double high = 0.0;
    for (const FractionalLeadLag& term : terms) {
      low = std::min(low, term.low_corner().hz().value);
      high = std::max(high, term.high_corner().hz().value);
    }
    const double decades = std::log10(high / low) + 6.0;
    grid_ = log_grid({Hertz{low / 1000.0}, Hertz{high * 1000.0}}, whole_number(60.0 * decades, 2, 60 * 700));
  }

  struct Candidate {
    TermApproximation approximation;
    std::vector<double> error_db;
  };

  std::size_t terms() const { return terms_.size(); }
  int max_order() const { return options_.max_order; }

  /// Null when the method refuses this order.
  const Candidate* get(std::size_t term, int order) {
    auto& known = known_[term];
    auto found = known.find(order);
    if (found == known.end()) found = known.emplace(order, make(terms_[term], order)).first;
    return found->second ? &*found->second : nullptr;
  }

  /// The smallest order above `order` that the method makes; max_order + 1 when there is none.
  int next_order(std::size_t term, int order) {
    do ++order;
    while (order <= max_order() && get(term, order) == nullptr);
    return order;
  }

  /// Largest |sum of the curves|.
  double total_db(const Orders& orders) {
    std::vector<double> sum(grid_.size(), 0.0);
    for (std::size_t i = 0; i < orders.size(); ++i) {
      const Candidate* candidate = get(i, orders[i]);
      if (candidate == nullptr) return INFINITY;
      for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += candidate->error_db[j];
    }
    double largest = 0.0;
    for (const double e : sum) largest = std::max(largest, std::abs(e));
    return largest;
  }

 private:
  std::optional<Candidate> make(const FractionalLeadLag& term, int order) const {
    auto made = try_approximate_term(term, options_, order);
    if (!std::holds_alternative<TermApproximation>(made)) return std::nullopt;
    Candidate out{std::get<TermApproximation>(std::move(made)), {}};
    Sections sections;
    sections.sections = out.approximation.sections;
    for (const Hertz f : grid_) {
      out.error_db.push_back(to_decibel(std::abs(sections.response(f.rad_s()))) -
                             kDecibelPerNeper * term.log_magnitude(f.rad_s()));
    }
    return out;
  }

  const std::vector<FractionalLeadLag>& terms_;
  const ApproximationOptions& options_;
  std::vector<Hertz> grid_;
  std::vector<std::map<int, std::optional<Candidate>>> known_;
};

/// The smallest order that the method makes of each term; nothing when one term has none. (One term alone can be no
/// better inside the product than the limit plus what the others add; no sound lower bound follows from that, so only
/// refused orders are passed over.)
std::optional<Orders> min_orders(OrderCandidates& candidates) {
  Orders out;
  for (std::size_t i = 0; i < candidates.terms(); ++i) {
    out.push_back(candidates.next_order(i, 0));
    if (out.back() > candidates.max_order()) return std::nullopt;
  }
  return out;
}

/// Adds poles to the term that is worst by itself until the product is within the limit; the best orders met.
Orders grow_worst_terms(OrderCandidates& candidates, Orders orders, double limit_db) {
  Orders best = orders;
  double best_db = candidates.total_db(orders);
  while (best_db > limit_db) {
    std::optional<std::size_t> worst;
    double worst_db = -1.0;
    for (std::size_t i = 0; i < orders.size(); ++i) {
      const double own_db = candidates.get(i, orders[i])->approximation.error.everywhere_db;
      if (own_db <= worst_db || candidates.next_order(i, orders[i]) > candidates.max_order()) continue;
      worst = i;
      worst_db = own_db;
    }
    if (!worst) break;
    orders[*worst] = candidates.next_order(*worst, orders[*worst]);
    const double db = candidates.total_db(orders);
    if (db < best_db) {
      best_db = db;
      best = orders;
    }
  }
  return best;
}

/// Tries the splits of a number of poles over the terms, within a number of evaluations in all.
class SplitSearch {
 public:
  SplitSearch(OrderCandidates& candidates, const Orders& min_orders, double limit_db)
      : candidates_(candidates), min_orders_(min_orders), limit_db_(limit_db) {}

  /// A split whose product is within the limit; nothing when there is none or the evaluations are used up.
  std::optional<Orders> find(int poles) {
    Orders orders(min_orders_.size());
    if (search(orders, 0, poles)) return orders;
    return std::nullopt;
  }

 private:
  bool search(Orders& orders, std::size_t at, int poles) {
    const int max_order = candidates_.max_order();
    if (at + 1 == orders.size()) {
      if (poles < min_orders_[at] || poles > max_order || trials_left_-- <= 0) return false;
      orders[at] = poles;
      return candidates_.total_db(orders) <= limit_db_;
    }
    for (int n = min_orders_[at]; n <= std::min(max_order, poles); ++n) {
      orders[at] = n;
      if (search(orders, at + 1, poles - n)) return true;
    }
    return false;
  }

  OrderCandidates& candidates_;
  const Orders& min_orders_;
  double limit_db_;
  int trials_left_ = 4000;  ///< a few seconds for the largest grids
};

/// One pole fewer as long as some split of them is within the limit.
Orders take_poles_away(OrderCandidates& candidates, Orders orders, const Orders& min_orders,
                       double limit_db) {
  SplitSearch search(candidates, min_orders, limit_db);
  while (auto fewer = search.find(std::accumulate(orders.begin(), orders.end(), -1))) orders = *fewer;
  return orders;
}

/// Approximations of the terms, with the fewest poles in all for which the product stays within max_error_db at all
/// frequencies; the best found up to options.max_order a term when none does. Refused when the method makes no order up
/// to max_order for one of the terms.
Outcome<std::vector<TermApproximation>> search_orders(const std::vector<FractionalLeadLag>& terms,
                                                      const ApproximationOptions& options,
                                                      double max_error_db) {
  if (terms.empty()) return std::vector<TermApproximation>{};
  // A little below the limit: the final error is measured on another grid.
  const double limit_db = max_error_db * (1.0 - 1e-3);
  OrderCandidates candidates(terms, options);
  const auto smallest = min_orders(candidates);
  if (!smallest) return Refusal{"the method accepts no order up to the largest allowed for one of the terms"};
  Orders orders = grow_worst_terms(candidates, *smallest, limit_db);
  if (candidates.total_db(orders) <= limit_db)
    orders = take_poles_away(candidates, orders, *smallest, limit_db);
  std::vector<TermApproximation> out;
  for (std::size_t i = 0; i < terms.size(); ++i) out.push_back(candidates.get(i, orders[i])->approximation);
  return out;
}

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
