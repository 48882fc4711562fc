#include "fpaa/chain_search.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "fpaa/cams/filter_bilinear.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

/// How far (nepers) the beam lets one CAM's gain stray from what is wanted of it.
constexpr double kCamGainWindow = 0.25;
/// ln of the units that a constant branch starts from: the middle of 1 to 255, in ratio.
constexpr double kUsualConstant = 2.77;
/// A gain error that polishing surely removes, nepers.
constexpr double kGainSlack = 0.02;
/// Corners farther off than this (nepers) are not considered even when the gain asks for them.
constexpr double kFarthestCorner = 1.0;
/// With two branches (one CAM) every pair of candidates is tried, of this many.
constexpr int kCandidatesOfOneCam = 800;
/// Polishing looks at choices whose total gain is within this (nepers) of the best for the shape.
constexpr double kWidestGainWindow = 1e-3;
/// Polishing looks at triples of this many of the finest branches, and at pairs of more.
constexpr size_t kPolishedTriples = 16;
/// Pairs are tried among this many; the coarser branches are then only looked at one by one.
constexpr size_t kPolishedPairs = 32;

struct Candidate {
  BranchValue value;
  double log_gain = 0.0;       ///< ln of its gain at low frequency, signed by the side of the fraction line
  std::vector<double> re, im;  ///< ln(branch / imitated) over the grid, signed likewise
};

class Search {
 public:
  Search(const ChainProblem& problem, const SearchEffort& effort) : p_(problem), effort_(effort) {
    points_ = p_.grid.size();
    for (const RadPerSecond w : p_.grid) {
      one_minus_z_.push_back(1.0 - std::polar(1.0, -w.value / p_.clock.value));
    }
    for (size_t i = 0; i < p_.branches.size(); ++i) {
      lists_.push_back(make_candidates(p_.branches[i]));
      if (lists_.back().empty()) unreachable_.push_back(static_cast<int>(i));
    }
  }

  ChainSolution run() {
    ChainSolution out;
    out.unreachable = unreachable_;
    if (!unreachable_.empty()) return out;
    finest_first_.resize(lists_.size());
    std::iota(finest_first_.begin(), finest_first_.end(), size_t{0});
    std::stable_sort(finest_first_.begin(), finest_first_.end(),
                     [&](size_t a, size_t b) { return multiples(a) > multiples(b); });
    Choice best;
    double least = std::numeric_limits<double>::infinity();
    if (exhaustive()) {
      best = best_of_all();
      least = 0.0;
    }
    const std::vector<double> weights = exhaustive()           ? std::vector<double>{}
                                        : effort_.polished > 0 ? std::vector<double>{1e-4, 1e-3}
                                                               : std::vector<double>{3e-4};
    for (const double weight : weights) {
      for (const Choice& start : by_shape(beam(weight))) {
        set(start);
        double middle = 0.0;
        if (effort_.polished > 0) polish();
        const double score = effort_.polished > 0
                                 ? penalised()
                                 : shape_residual(middle) + std::max(0.0, gain_out_of_reach() - kGainSlack);
        if (score < least) {
          least = score;
          best = choice_;
          out.shape_error = score;
        }
      }
    }
    set(best);
    out.made = true;
    for (size_t i = 0; i < lists_.size(); ++i) out.values.push_back(lists_[i][choice_[i]].value);
    out.max_complex_error = exact_error();
    if (effort_.polished > 0) {
      double middle = 0.0;
      out.shape_error = shape_residual(middle);
    }
    out.gain_error = total_gain() - p_.log_gain;
    out.spread = spread();
    return out;
  }

 private:
  using Choice = std::vector<size_t>;

  Complex imitated(const Branch& branch, size_t k) const {
    const double w = p_.grid[k].value;
    switch (branch.kind) {
      case Branch::Kind::corner:
        return {1.0, w / branch.corner.value};
      case Branch::Kind::differentiating:
        return {0.0, w};
      case Branch::Kind::constant:
        break;
    }
    return 1.0;
  }

  std::vector<Candidate> make_candidates(const Branch& branch) const {
    std::vector<BranchValue> values;
    const int largest = p_.largest;
    if (branch.kind == Branch::Kind::constant) {
      for (int c = 1; c <= largest; ++c) values.push_back({c, 0});
    } else if (branch.kind == Branch::Kind::differentiating) {
      for (int c = 1; c <= largest; ++c) values.push_back({0, c});
    } else if (is_reachable(branch, p_.clock, largest)) {
      values = near_ratio(branch);
    }
    std::vector<Complex> target(points_);
    for (size_t k = 0; k < points_; ++k) target[k] = imitated(branch, k);
    std::vector<Candidate> out;
    for (const BranchValue& value : values) out.push_back(evaluate(branch, value, target));
    return out;
  }

  /// The capacitor pairs whose ratio is nearest to the corner's, counted by ratio.
  std::vector<BranchValue> near_ratio(const Branch& branch) const {
    const double ratio = branch_ratio(branch.corner.hz(), p_.clock);
    struct Near {
      double off;
      BranchValue value;
    };
    std::vector<Near> near;
    // The frequency goes as 1/(1 + 2 C1/C0).
    const double wanted = 1.0 + 2.0 * ratio;
    const auto off = [&](int c0, int c1) {
      return std::abs(std::log((1.0 + 2.0 * c1 / static_cast<double>(c0)) / wanted));
    };
    for (int c0 = 1; c0 <= p_.largest; ++c0) {
      // Beyond the largest capacitor the corner strays: still worth having where the gain needs that C0.
      const int middle =
          static_cast<int>(std::lround(std::clamp(ratio * c0, 1.0, static_cast<double>(p_.largest))));
      if (ratio * c0 > p_.largest && off(c0, middle) > kFarthestCorner) break;
      // A coarse branch (few multiples reach it) needs its farther neighbours more than a fine one does.
      const int reach = std::clamp(static_cast<int>(12.0 / c0), 1, 6);
      for (int c1 = std::max(1, middle - reach); c1 <= std::min(p_.largest, middle + reach); ++c1) {
        near.push_back({off(c0, c1), {c0, c1}});
      }
    }
    const auto less = [](const Near& a, const Near& b) {
      if (a.off != b.off) return a.off < b.off;
      return a.value.c0 < b.value.c0;
    };
    const int most = exhaustive() ? kCandidatesOfOneCam : effort_.candidates;
    const size_t keep = std::min(near.size(), static_cast<size_t>(most));
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(keep), near.end(), less);
    std::vector<BranchValue> out;
    for (size_t i = 0; i < keep; ++i) out.push_back(near[i].value);
    std::sort(out.begin(), out.end(), [](const BranchValue& a, const BranchValue& b) {
      const int left = a.c1 * b.c0;
      const int right = b.c1 * a.c0;
      return left != right ? left < right : a.c0 < b.c0;
    });
    return out;
  }

  Candidate evaluate(const Branch& branch, const BranchValue& value,
                     const std::vector<Complex>& target) const {
    Candidate c;
    c.value = value;
    const double sign = branch.above ? 1.0 : -1.0;
    for (size_t k = 0; k < points_; ++k) {
      const Complex got = static_cast<double>(value.c0) + static_cast<double>(value.c1) * one_minus_z_[k];
      const Complex u = sign * std::log(got / target[k]);
      c.re.push_back(u.real());
      c.im.push_back(u.imag());
    }
    c.log_gain =
        sign * (branch.kind == Branch::Kind::differentiating ? std::log(value.c1 / p_.clock.value)
                                                             : std::log(static_cast<double>(value.c0)));
    return c;
  }

  void set(const Choice& choice) {
    choice_ = choice;
    re_.assign(points_, -p_.log_gain);
    im_.assign(points_, 0.0);
    if (!p_.others.empty()) {
      for (size_t k = 0; k < points_; ++k) {
        re_[k] += p_.others[k].real();
        im_[k] += p_.others[k].imag();
      }
    }
    cam_gain_.assign(p_.cam_log_gain.size(), 0.0);
    for (size_t i = 0; i < lists_.size(); ++i) apply(i, choice_[i], 1.0);
    energy_ = penalised();
  }

  void apply(size_t branch, size_t candidate, double sign) {
    const Candidate& c = lists_[branch][candidate];
    for (size_t k = 0; k < points_; ++k) {
      re_[k] += sign * c.re[k];
      im_[k] += sign * c.im[k];
    }
    cam_gain_[static_cast<size_t>(p_.branches[branch].cam)] += sign * c.log_gain;
  }
  void replace(size_t branch, size_t candidate) {
    apply(branch, choice_[branch], -1.0);
    choice_[branch] = candidate;
    apply(branch, candidate, 1.0);
  }

  double total_gain() const {
    double sum = 0.0;
    for (size_t i = 0; i < lists_.size(); ++i) sum += lists_[i][choice_[i]].log_gain;
    return sum;
  }

  /// Worst |ln(got/wanted)|: to first order the complex error.
  double residual() const {
    double worst = 0.0;
    for (size_t k = 0; k < points_; ++k) worst = std::max(worst, re_[k] * re_[k] + im_[k] * im_[k]);
    return std::sqrt(worst);
  }
  /// The same when a common gain is free: the first-order optimum is the middle of the real parts.
  double shape_residual(double& middle) const {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (size_t k = 0; k < points_; ++k) {
      low = std::min(low, re_[k]);
      high = std::max(high, re_[k]);
    }
    middle = 0.5 * (low + high);
    double worst = 0.0;
    for (size_t k = 0; k < points_; ++k) {
      const double re = re_[k] - middle;
      worst = std::max(worst, re * re + im_[k] * im_[k]);
    }
    return std::sqrt(worst);
  }
  double exact_error() const {
    double worst = 0.0;
    for (size_t k = 0; k < points_; ++k) {
      worst = std::max(worst, std::abs(std::exp(Complex(re_[k], im_[k])) - 1.0));
    }
    return worst;
  }

  double spread() const {
    double off = 0.0;
    double worst = 0.0;
    for (size_t c = 0; c < cam_gain_.size(); ++c) {
      off += cam_gain_[c] - p_.cam_log_gain[c];
      worst = std::max(worst, std::abs(off));
    }
    return worst;
  }
  double spread_penalty() const { return 0.05 * std::max(0.0, spread() - p_.spread_window); }
  double penalised() const { return residual() + spread_penalty(); }
  /// One CAM by itself, to be finished.
  bool exhaustive() const { return p_.branches.size() == 2 && effort_.polished > 0; }

  Choice best_of_all() {
    set({0, 0});
    Choice best{0, 0};
    double least = std::numeric_limits<double>::infinity();
    for (size_t a = 0; a < lists_[0].size(); ++a) {
      for (size_t b = 0; b < lists_[1].size(); ++b) {
        const Candidate& x = lists_[0][a];
        const Candidate& y = lists_[1][b];
        double worst = 0.0;
        // Exact: |exp(r) - 1| of the whole residual, which may be large here.
        for (size_t k = 0; k < points_ && worst < least; ++k) {
          const double re =
              -p_.log_gain + x.re[k] + y.re[k] + (p_.others.empty() ? 0.0 : p_.others[k].real());
          const double im = x.im[k] + y.im[k] + (p_.others.empty() ? 0.0 : p_.others[k].imag());
          const double size = std::exp(re);
          worst = std::max(worst, size * size - 2.0 * size * std::cos(im) + 1.0);
        }
        if (worst < least) {
          least = worst;
          best = {a, b};
        }
      }
    }
    return best;
  }

  /// The best few of the beam by their worst error with the gain free.
  std::vector<Choice> by_shape(const std::vector<Choice>& starts) {
    std::vector<double> shapes;
    for (const Choice& start : starts) {
      set(start);
      double middle = 0.0;
      shapes.push_back(shape_residual(middle));
    }
    std::vector<size_t> rank(starts.size());
    std::iota(rank.begin(), rank.end(), size_t{0});
    std::stable_sort(rank.begin(), rank.end(), [&](size_t a, size_t b) { return shapes[a] < shapes[b]; });
    const size_t few =
        lists_.size() > kPolishedPairs ? 1 : static_cast<size_t>(std::max(1, effort_.polished));
    std::vector<Choice> out;
    for (size_t r = 0; r < rank.size() && r < few; ++r) {
      out.push_back(starts[rank[r]]);
    }
    return out;
  }

  /// Beam search in the sense of least squares, the coarsest branch first: those not yet chosen are taken as
  /// continuous (linearised, lightly bound to their nominal corner), the common gain as free. What a partial
  /// choice costs is then what no choice of the rest could repair.
  std::vector<Choice> beam(double corner_weight) const {
    const size_t n = lists_.size();
    const auto rows = static_cast<Eigen::Index>(2 * points_);
    const std::vector<size_t> order(finest_first_.rbegin(), finest_first_.rend());

    // Each candidate with its gain taken off: only the shape counts here.
    const auto shape = [&](const Candidate& c) {
      Eigen::VectorXd u(rows);
      for (size_t k = 0; k < points_; ++k) {
        u[static_cast<Eigen::Index>(k)] = c.re[k] - c.log_gain;
        u[static_cast<Eigen::Index>(points_ + k)] = c.im[k];
      }
      return u;
    };
    struct State {
      Eigen::VectorXd residual;
      Choice choice;
      double cost;
    };
    std::vector<Eigen::VectorXd> slopes(n), nominal(n);
    State start{Eigen::VectorXd::Zero(rows), Choice(n, 0), 0.0};
    if (!p_.others.empty()) {
      for (size_t k = 0; k < points_; ++k) {
        start.residual[static_cast<Eigen::Index>(k)] = p_.others[k].real();
        start.residual[static_cast<Eigen::Index>(points_ + k)] = p_.others[k].imag();
      }
    }
    for (size_t i = 0; i < n; ++i) {
      nominal[i] = continuous(p_.branches[i], 1.0);
      slopes[i] = (continuous(p_.branches[i], 1.001) - continuous(p_.branches[i], 0.999)) / 0.002;
      start.residual += nominal[i];
    }
    std::vector<State> states{start};
    std::vector<bool> settled(n, false);
    for (size_t step = 0; step < n; ++step) {
      const size_t i = order[step];
      Eigen::MatrixXd free = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(n - step));
      free.col(0).head(static_cast<Eigen::Index>(points_)).setOnes();
      for (size_t later = step + 1; later < n; ++later) {
        free.col(static_cast<Eigen::Index>(later - step)) = slopes[order[later]];
      }
      Eigen::MatrixXd normal = free.transpose() * free;
      for (Eigen::Index d = 1; d < normal.rows(); ++d) normal(d, d) += corner_weight;
      const Eigen::MatrixXd keep = Eigen::MatrixXd::Identity(rows, rows) -
                                   free * normal.ldlt().solve(Eigen::MatrixXd(free.transpose()));
      std::vector<Eigen::VectorXd> moves;
      std::vector<double> squares;
      std::vector<size_t> which;
      for (size_t c = 0; c < lists_[i].size(); ++c) {
        const BranchValue& value = lists_[i][c].value;
        if (std::gcd(value.c0, value.c1) > 1 && p_.branches[i].kind == Branch::Kind::corner) continue;
        moves.push_back(shape(lists_[i][c]) - nominal[i]);
        squares.push_back(moves.back().dot(keep * moves.back()));
        which.push_back(c);
      }
      struct Next {
        double cost;
        std::uint32_t from, candidate;
      };
      std::vector<Next> next;
      next.reserve(states.size() * moves.size());
      for (const bool any_gain : {false, true}) {
        if (!next.empty()) break;
        for (size_t from = 0; from < states.size(); ++from) {
          const Eigen::VectorXd kept = keep * states[from].residual;
          const double base = states[from].residual.dot(kept);
          const double missing = partner_gain(i, states[from].choice, settled);
          const auto cost = [&](size_t c) { return base + 2.0 * moves[c].dot(kept) + squares[c]; };
          if (p_.branches[i].kind != Branch::Kind::corner) {
            // It has no shape: the value that gives its CAM the gain wanted of it, whatever that costs.
            const size_t c = by_gain(i, std::isnan(missing) ? -kUsualConstant : missing);
            next.push_back({cost(c), static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(c)});
            continue;
          }
          for (size_t c = 0; c < moves.size(); ++c) {
            // (Never true while the CAM's other branch is open: missing is NaN.)
            if (!any_gain && std::abs(missing + lists_[i][which[c]].log_gain) > kCamGainWindow) continue;
            next.push_back({cost(c), static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(c)});
          }
        }
      }
      settled[i] = true;
      const size_t width = std::min(next.size(), static_cast<size_t>(effort_.beam));
      const auto less = [](const Next& x, const Next& y) {
        return x.cost != y.cost   ? x.cost < y.cost
               : x.from != y.from ? x.from < y.from
                                  : x.candidate < y.candidate;
      };
      std::partial_sort(next.begin(), next.begin() + static_cast<std::ptrdiff_t>(width), next.end(), less);
      std::vector<State> chosen;
      for (size_t s = 0; s < width; ++s) {
        State state = states[next[s].from];
        state.residual += moves[next[s].candidate];
        state.choice[i] = which[next[s].candidate];
        state.cost = next[s].cost;
        chosen.push_back(std::move(state));
      }
      states = std::move(chosen);
    }
    std::vector<Choice> out;
    for (State& state : states) out.push_back(std::move(state.choice));
    return out;
  }

  /// By how much (nepers) the settled branches of a branch's CAM miss the gain wanted of it; when others of
  /// that CAM are still open, as if nothing were missed whatever this branch takes: NaN.
  double partner_gain(size_t branch, const Choice& choice, const std::vector<bool>& settled) const {
    double gain = -p_.cam_log_gain[static_cast<size_t>(p_.branches[branch].cam)];
    for (size_t other = 0; other < lists_.size(); ++other) {
      if (other == branch || p_.branches[other].cam != p_.branches[branch].cam) continue;
      if (!settled[other]) return std::numeric_limits<double>::quiet_NaN();
      gain += lists_[other][choice[other]].log_gain;
    }
    return gain;
  }

  /// The candidate that best makes up for a gain of `missing` nepers.
  size_t by_gain(size_t branch, double missing) const {
    size_t best = 0;
    for (size_t c = 1; c < lists_[branch].size(); ++c) {
      if (std::abs(missing + lists_[branch][c].log_gain) <
          std::abs(missing + lists_[branch][best].log_gain)) {
        best = c;
      }
    }
    return best;
  }

  /// How many multiples of its least capacitors reach a branch's corner: how finely it can be set.
  double multiples(size_t i) const {
    if (p_.branches[i].kind != Branch::Kind::corner) return 1e9;
    const double ratio = branch_ratio(p_.branches[i].corner.hz(), p_.clock);
    return p_.largest / std::max({ratio, 1.0 / ratio, 1.0});
  }

  /// ln(branch/imitated) with real capacitors that put its corner at `factor` times the wanted one.
  Eigen::VectorXd continuous(const Branch& branch, double factor) const {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(2 * points_));
    const double sign = branch.above ? 1.0 : -1.0;
    for (size_t k = 0; k < points_; ++k) {
      Complex got = 1.0;
      if (branch.kind == Branch::Kind::corner) {
        got += branch_ratio({branch.corner.hz().value * factor}, p_.clock) * one_minus_z_[k];
      } else if (branch.kind == Branch::Kind::differentiating) {
        got = one_minus_z_[k] * p_.clock.value;
      }
      const Complex value = sign * std::log(got / imitated(branch, k));
      u[static_cast<Eigen::Index>(k)] = value.real();
      u[static_cast<Eigen::Index>(points_ + k)] = value.imag();
    }
    return u;
  }

  /// The candidates of a branch around its present choice.
  std::pair<size_t, size_t> neighbours(size_t branch) const {
    const size_t half = static_cast<size_t>(effort_.neighbours) / 2;
    const size_t now = choice_[branch];
    size_t from = now > half ? now - half : 0;
    const size_t to = std::min(lists_[branch].size(), from + 2 * half + 1);
    from = to > 2 * half + 1 ? to - (2 * half + 1) : 0;
    return {from, to};
  }

  /// Exhaustive over all pairs and triples of branches among the neighbours of the present choice; only those
  /// whose gain fits are looked at closely.
  void polish() {
    const size_t n = lists_.size();
    double middle = 0.0;
    gain_window_ = std::clamp(shape_residual(middle), 2e-4, kWidestGainWindow);
    gain_target_ = total_gain() - middle;
    const size_t paired = std::min(n, kPolishedPairs);
    for (int round = 0; round < (n > kPolishedPairs ? 2 : effort_.polish_rounds); ++round) {
      const double before = energy_;
      for (size_t i = 0; i < n; ++i) {
        improve_single(finest_first_[i]);
        for (size_t j = i + 1; i < paired && j < paired; ++j) improve_with_pair(i, j);
      }
      if (!(energy_ < before * 0.998)) break;
    }
    set(choice_);  // sheds rounding
  }

  /// What is missing of the total gain after each branch in turn has made up for what it can within its own
  /// candidates (whose corners all but agree), in nepers.
  double gain_out_of_reach() const {
    double missing = total_gain() - p_.log_gain;
    for (const size_t i : finest_first_) {
      const double now = lists_[i][choice_[i]].log_gain;
      missing += lists_[i][by_gain(i, missing - now)].log_gain - now;
    }
    return std::abs(missing);
  }

  void improve_single(size_t i) {
    const size_t old = choice_[i];
    size_t best = old;
    for (size_t c = 0; c < lists_[i].size(); ++c) {
      replace(i, c);
      if (const double e = penalised(); e < energy_ - 1e-12) {
        energy_ = e;
        best = c;
      }
    }
    replace(i, best);
  }

  /// Branches at places `at_i` < `at_j` of finest_first_ together with each later one.
  void improve_with_pair(size_t at_i, size_t at_j) {
    const size_t i = finest_first_[at_i];
    const size_t j = finest_first_[at_j];
    struct Pair {
      double gain;
      std::uint32_t a, b;
    };
    static thread_local std::vector<Pair> pairs;
    pairs.clear();
    const auto [from_i, to_i] = neighbours(i);
    const auto [from_j, to_j] = neighbours(j);
    for (size_t a = from_i; a < to_i; ++a) {
      for (size_t b = from_j; b < to_j; ++b) {
        pairs.push_back({lists_[i][a].log_gain + lists_[j][b].log_gain, static_cast<std::uint32_t>(a),
                         static_cast<std::uint32_t>(b)});
      }
    }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) {
      return x.gain != y.gain ? x.gain < y.gain : x.a != y.a ? x.a < y.a : x.b < y.b;
    });
    const size_t n = lists_.size();
    const size_t last = at_j < kPolishedTriples ? std::min(n, kPolishedTriples) : n;
    for (size_t at_k = at_j + 1; at_k <= n; ++at_k) {
      if (at_k >= last) at_k = n;
      const bool alone = at_k == n;
      const size_t k = alone ? i : finest_first_[at_k];
      const auto [from_k, to_k] = alone ? std::pair<size_t, size_t>{0, 1} : neighbours(k);
      for (size_t c = from_k; c < to_k; ++c) {
        double rest = total_gain() - lists_[i][choice_[i]].log_gain - lists_[j][choice_[j]].log_gain;
        if (!alone) rest += lists_[k][c].log_gain - lists_[k][choice_[k]].log_gain;
        // A gain error counts fully at low frequency, where every branch is its C0.
        const double window = std::min(gain_window_, energy_);
        const double wanted = gain_target_ - rest;
        auto at = std::lower_bound(pairs.begin(), pairs.end(), wanted - window,
                                   [](const Pair& x, double g) { return x.gain < g; });
        for (; at != pairs.end() && at->gain <= wanted + window; ++at) {
          try_three(i, at->a, j, at->b, k, c);
        }
      }
    }
  }

  void try_three(size_t i, size_t a, size_t j, size_t b, size_t k, size_t c) {
    // Look at a few points first: most triples fail at once.
    const Candidate& ai = lists_[i][a];
    const Candidate& bj = lists_[j][b];
    const Candidate& oi = lists_[i][choice_[i]];
    const Candidate& oj = lists_[j][choice_[j]];
    const Candidate* ck = k == i ? nullptr : &lists_[k][c];
    const Candidate* ok = k == i ? nullptr : &lists_[k][choice_[k]];
    const double limit = energy_ * energy_;
    const auto fails = [&](size_t m) {
      double re = re_[m] + ai.re[m] + bj.re[m] - oi.re[m] - oj.re[m];
      double im = im_[m] + ai.im[m] + bj.im[m] - oi.im[m] - oj.im[m];
      if (ck != nullptr) {
        re += ck->re[m] - ok->re[m];
        im += ck->im[m] - ok->im[m];
      }
      return re * re + im * im >= limit;
    };
    if (fails(points_ - 1) || fails(points_ / 2) || fails(0)) return;
    for (size_t m = 1; m + 1 < points_; ++m) {
      if (fails(m)) return;
    }
    const size_t old_i = choice_[i];
    const size_t old_j = choice_[j];
    const size_t old_k = choice_[k];
    replace(i, a);
    replace(j, b);
    if (k != i) replace(k, c);
    const double e = penalised();
    if (e < energy_ - 1e-12) {
      energy_ = e;
    } else {
      replace(i, old_i);
      replace(j, old_j);
      if (k != i) replace(k, old_k);
    }
  }

  const ChainProblem& p_;
  SearchEffort effort_;
  size_t points_ = 0;
  std::vector<Complex> one_minus_z_;
  std::vector<std::vector<Candidate>> lists_;
  std::vector<int> unreachable_;
  std::vector<size_t> finest_first_;
  Choice choice_;
  std::vector<double> re_, im_;
  std::vector<double> cam_gain_;
  double energy_ = 0.0;
  double gain_window_ = 0.0;
  double gain_target_ = 0.0;  ///< total gain that is best for the shape at hand
};

}  // namespace

bool is_reachable(const Branch& branch, Hertz clock, int largest) {
  if (branch.kind != Branch::Kind::corner) return true;
  if (branch.corner.hz().value >= 0.5 * clock.value) return false;
  const double ratio = branch_ratio(branch.corner.hz(), clock);
  return ratio <= largest + 0.5 && ratio >= 1.0 / (largest + 0.5);
}

ChainSolution search_chain(const ChainProblem& problem, const SearchEffort& effort) {
  return Search(problem, effort).run();
}

}  // namespace bodesmith::fpaa
