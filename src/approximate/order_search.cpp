#include "approximate/order_search.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.hpp"

namespace bodesmith {
namespace {

/// Error curves of the candidate approximations on one grid for all terms: the curves of a product add.
class Candidates {
 public:
  Candidates(const std::vector<FractionalLeadLag>& terms, const ApproximationOptions& options)
      : terms_(terms), options_(options), known_(terms.size()) {
    double low = INFINITY;
    double high = 0.0;
    for (const FractionalLeadLag& term : terms) {
      low = std::min(low, term.low_corner().hz().value);
      high = std::max(high, term.high_corner().hz().value);
    }
    const double decades = std::log10(high / low) + 6.0;
    grid_ = log_grid({Hertz{low / 1000.0}, Hertz{high * 1000.0}}, static_cast<int>(60.0 * decades));
  }

  struct Candidate {
    TermApproximation approximation;
    std::vector<double> error_db;
  };

  /// Nothing when the method refuses this order.
  const Candidate* get(size_t term, int order) {
    auto& known = known_[term];
    auto found = known.find(order);
    if (found == known.end()) found = known.emplace(order, make(terms_[term], order)).first;
    return found->second ? &*found->second : nullptr;
  }

  /// Largest |sum of the curves|.
  double total(const std::vector<int>& orders) {
    std::vector<double> sum(grid_.size(), 0.0);
    for (size_t i = 0; i < orders.size(); ++i) {
      const Candidate* candidate = get(i, orders[i]);
      if (candidate == nullptr) return INFINITY;
      for (size_t j = 0; j < sum.size(); ++j) sum[j] += candidate->error_db[j];
    }
    double largest = 0.0;
    for (const double e : sum) largest = std::max(largest, std::abs(e));
    return largest;
  }

 private:
  std::optional<Candidate> make(const FractionalLeadLag& term, int order) const {
    Candidate out;
    try {
      out.approximation = approximate_term(term, options_, order);
    } catch (const DesignError&) {
      return std::nullopt;
    }
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

/// Tries every split of `poles` over the terms from index `at` on, within `trials` evaluations.
bool find_split(Candidates& candidates, std::vector<int>& orders, size_t at, int poles,
                const std::vector<int>& least, int most, double limit, int& trials) {
  if (at + 1 == orders.size()) {
    if (poles < least[at] || poles > most || trials-- <= 0) return false;
    orders[at] = poles;
    return candidates.total(orders) <= limit;
  }
  for (int n = least[at]; n <= std::min(most, poles); ++n) {
    orders[at] = n;
    if (find_split(candidates, orders, at + 1, poles - n, least, most, limit, trials)) return true;
  }
  return false;
}

}  // namespace

std::vector<TermApproximation> search_orders(const std::vector<FractionalLeadLag>& terms,
                                             const ApproximationOptions& options) {
  if (terms.empty()) return {};
  Candidates candidates(terms, options);
  const int most = options.max_order;
  // A little below the limit: the final error is measured on another grid.
  const double limit = *options.max_error_db * (1.0 - 1e-3);
  std::vector<int> least;
  for (size_t i = 0; i < terms.size(); ++i) {
    int n = 1;
    while (n <= most && candidates.get(i, n) == nullptr) ++n;
    if (n > most)
      throw DesignError("the method accepts no order up to the largest allowed for one of the terms");
    // One term alone can be no better inside the product than the limit plus what the others add; no sound
    // bound follows, so only refused orders are passed over.
    least.push_back(n);
  }
  const auto next_order = [&](size_t i, int n) {
    do ++n;
    while (n <= most && candidates.get(i, n) == nullptr);
    return n;
  };
  std::vector<int> orders = least;
  std::vector<int> best = orders;
  double best_error = candidates.total(orders);
  // Grow where a pole helps most, then take away what is not needed.
  while (best_error > limit) {
    std::vector<int> grown;
    double grown_error = INFINITY;
    double own_worst = -1.0;
    for (size_t i = 0; i < orders.size(); ++i) {
      const int n = next_order(i, orders[i]);
      if (n > most) continue;
      const double own = candidates.get(i, orders[i])->approximation.error.everywhere_db;
      if (own <= own_worst) continue;
      own_worst = own;
      grown = orders;
      grown[i] = n;
    }
    if (grown.empty()) break;
    orders = grown;
    grown_error = candidates.total(orders);
    if (grown_error < best_error) {
      best_error = grown_error;
      best = orders;
    }
  }
  orders = best;
  if (best_error <= limit) {
    int trials = 4000;
    for (;;) {
      int poles = -1;
      for (const int n : orders) poles += n;
      std::vector<int> fewer = orders;
      if (!find_split(candidates, fewer, 0, poles, least, most, limit, trials)) break;
      orders = fewer;
    }
  }
  std::vector<TermApproximation> out;
  for (size_t i = 0; i < terms.size(); ++i) out.push_back(candidates.get(i, orders[i])->approximation);
  return out;
}

}  // namespace bodesmith
