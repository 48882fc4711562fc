#include "approximate/approximate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

#include "base/documents/json.hpp"
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

using Orders = std::vector<int>;  ///< one a term

/// Error curves of the candidate approximations on one grid for all terms: the curves of a product add.
class OrderCandidates {
 public:
  OrderCandidates(const std::vector<FractionalLeadLag>& terms, const ApproximationOptions& options)
      : terms_(terms), options_(options), known_(terms.size()) {
    const auto [low, high] = Cascade{1.0, terms, {}}.corner_band();
    const double decades = std::log10(high.value / low.value) + 6.0;
    grid_ = log_grid({Hertz{low.value / 1000.0}, Hertz{high.value * 1000.0}},
                     whole_number(60.0 * decades, 2, 60 * 700));
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
      : candidates_(candidates), min_orders_(min_orders), limit_db_(limit_db), least_left_(min_orders) {
    for (std::size_t i = min_orders.size() - 1; i-- > 0;) least_left_[i] += least_left_[i + 1];
  }

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
    const int most = std::min(max_order, poles - least_left_[at + 1]);
    for (int n = min_orders_[at]; n <= most && trials_left_ > 0; ++n) {
      orders[at] = n;
      if (search(orders, at + 1, poles - n)) return true;
    }
    return false;
  }

  OrderCandidates& candidates_;
  const Orders& min_orders_;
  double limit_db_;
  Orders least_left_;       ///< poles that a term and those behind it have at least
  int trials_left_ = 4000;  ///< a few seconds for the largest grids
};

/// One pole of one term fewer, where that leaves the product nearest; nothing when none leaves it within the limit.
std::optional<Orders> drop_one_pole(OrderCandidates& candidates, const Orders& orders,
                                    const Orders& min_orders, double limit_db) {
  std::optional<Orders> best;
  double best_db = limit_db;
  for (std::size_t i = 0; i < orders.size(); ++i) {
    Orders fewer = orders;
    if (--fewer[i] < min_orders[i]) continue;
    const double db = candidates.total_db(fewer);
    if (db > best_db) continue;
    best_db = db;
    best = fewer;
  }
  return best;
}

/// One pole fewer as long as some split of them is within the limit: of many terms more splits than can be tried.
Orders take_poles_away(OrderCandidates& candidates, Orders orders, const Orders& min_orders,
                       double limit_db) {
  SplitSearch search(candidates, min_orders, limit_db);
  while (true) {
    auto fewer = drop_one_pole(candidates, orders, min_orders, limit_db);
    if (!fewer) fewer = search.find(std::accumulate(orders.begin(), orders.end(), -1));
    if (!fewer) return orders;
    orders = *fewer;
  }
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

bool is_nothing(const FractionalLeadLag& term) {
  return std::abs(term.beta) < kWhole;
}

Outcome<std::vector<Section>> try_term_sections(const FractionalLeadLag& term,
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

  std::vector<Section> out(static_cast<std::size_t>(power.whole), Section::pole_zero(1.0, zero, pole));
  if (power.rest > 0.0 || power.whole == 0) {
    auto made = method.approximate({.kappa = term.corner_ratio(),
                                    .beta = power.rest,
                                    .order = order - power.whole,
                                    .real_roots = options.real_roots,
                                    .over_band = options.over_band});
    if (auto* refusal = std::get_if<Refusal>(&made)) return std::move(*refusal);
    append(out, sections_of(std::get<NormalisedApproximation>(std::move(made)), centre, lag));
  }
  return out;
}

Outcome<TermApproximation> try_approximate_term(const FractionalLeadLag& term,
                                                const ApproximationOptions& options, int order) {
  auto made = try_term_sections(term, options, order);
  if (auto* refusal = std::get_if<Refusal>(&made)) return std::move(*refusal);
  TermApproximation out;
  out.term = term;
  out.order = order;
  out.sections = std::get<std::vector<Section>>(std::move(made));
  const double size = std::abs(term.beta);
  if (size < order + 1) out.limit_law_db = minimax_limit_db(term.corner_ratio(), size, order);
  out.error = term_error(out.sections, term);
  return out;
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
  for (const TermApproximation& term : out.terms)
    out.sections.sections.insert(out.sections.sections.end(), term.sections.begin(), term.sections.end());
  // A plain gain is its own approximation.
  if (out.sections.sections.empty()) return out;
  out.error = approximation_error(out.sections, cascade);
  out.sections.error = out.error.summary();
  return out;
}

Json CascadeApproximation::report_json() const {
  Json out;
  out["method"] = method;
  if (max_error_db) out["max_error_db"] = *max_error_db;
  out["limit_met"] = limit_met();
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
