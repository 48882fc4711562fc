#include "fpaa/beam.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numeric>
#include <optional>

#include "numeric/dense.hpp"
#include "numeric/index.hpp"
#include "numeric/log_ratio.hpp"

namespace bodesmith::fpaa {
namespace {

/// How far (nepers) one CAM's gain may stray from what is wanted of it.
constexpr double kCamGainWindow = 0.25;
/// ln of the units that a constant branch starts from: the middle of 1 to 255, in ratio.
constexpr double kUsualConstant = 2.77;
/// Step of a corner, relative, by which its slope is taken.
constexpr double kCornerStep = 0.001;

/// A partial choice: the branches that are settled, the others continuous.
struct BeamState {
  Eigen::VectorXd
      residual;  ///< ln(got/wanted) over the grid: real parts, then imaginary parts; gain left out
  Choice choice;
};

/// The candidates of a branch as changes to its continuous value.
struct BeamMoves {
  std::vector<Eigen::VectorXd> change;
  std::vector<double> square;  ///< of what is left of the change
  std::vector<std::size_t> candidate;
};

/// A state of the next step, not yet worked out.
struct BeamSuccessor {
  double cost;
  std::uint32_t from, move;
};

class BeamSearch {
 public:
  BeamSearch(const CandidateLists& lists, double corner_weight, std::size_t width)
      : lists_(lists),
        problem_(lists.problem()),
        corner_weight_(corner_weight),
        width_(width),
        order_(lists.finest_first().rbegin(), lists.finest_first().rend()),
        settled_(lists.branches(), false) {
    for (const Branch& branch : problem_.branches) {
      nominal_.push_back(continuous(branch, 1.0));
      slopes_.push_back((continuous(branch, 1.0 + kCornerStep) - continuous(branch, 1.0 - kCornerStep)) /
                        (2.0 * kCornerStep));
    }
  }

  std::vector<Choice> run() {
    std::vector<BeamState> states{start()};
    for (std::size_t step = 0; step < order_.size(); ++step) {
      const std::size_t branch = order_[step];
      const Eigen::MatrixXd keep = unrepairable(step);
      const BeamMoves moves = moves_of(branch, keep);
      states = best_of(successors(branch, states, moves, keep), branch, states, moves);
      settled_[branch] = true;
    }
    std::vector<Choice> out;
    for (BeamState& state : states) out.push_back(std::move(state.choice));
    return out;
  }

 private:
  Eigen::Index rows() const { return eigen_index(2 * lists_.points()); }

  BeamState start() const {
    BeamState out{Eigen::VectorXd::Zero(rows()), Choice(lists_.branches(), 0)};
    for (std::size_t k = 0; k < problem_.others.size(); ++k) {
      out.residual[eigen_index(k)] = problem_.others[k].real();
      out.residual[eigen_index(lists_.points() + k)] = problem_.others[k].imag();
    }
    for (const Eigen::VectorXd& nominal : nominal_) out.residual += nominal;
    return out;
  }

  /// ln(branch/imitated) with real capacitors that put its corner at `factor` times the wanted one.
  Eigen::VectorXd continuous(const Branch& branch, double factor) const {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(rows());
    const double sign = branch.above ? 1.0 : -1.0;
    for (std::size_t k = 0; k < lists_.points(); ++k) {
      std::complex<double> got = 1.0;
      if (branch.kind == Branch::Kind::corner) {
        got += branch_ratio({branch.corner.hz().value * factor}, problem_.clock) * lists_.one_minus_z(k);
      } else if (branch.kind == Branch::Kind::differentiating) {
        got = lists_.one_minus_z(k) * problem_.clock.value;
      }
      const std::complex<double> value = sign * log_ratio(got, branch.imitated(problem_.grid[k]));
      u[eigen_index(k)] = value.real();
      u[eigen_index(lists_.points() + k)] = value.imag();
    }
    return u;
  }

  /// The projection on what neither the gain nor the branches after `step` can take away.
  Eigen::MatrixXd unrepairable(std::size_t step) const {
    const std::size_t n = order_.size();
    Eigen::MatrixXd free = Eigen::MatrixXd::Zero(rows(), eigen_index(n - step));
    free.col(0).head(eigen_index(lists_.points())).setOnes();
    for (std::size_t later = step + 1; later < n; ++later) {
      free.col(eigen_index(later - step)) = slopes_[order_[later]];
    }
    Eigen::MatrixXd normal = free.transpose() * free;
    for (Eigen::Index d = 1; d < normal.rows(); ++d) normal(d, d) += corner_weight_;
    return Eigen::MatrixXd::Identity(rows(), rows()) -
           free * solve_ldlt_columns(normal, Eigen::MatrixXd(free.transpose()));
  }

  /// A candidate with its gain taken off: only the shape counts here.
  Eigen::VectorXd shape_of(const Candidate& c) const {
    Eigen::VectorXd u(rows());
    for (std::size_t k = 0; k < lists_.points(); ++k) {
      u[eigen_index(k)] = c.re[k] - c.log_gain;
      u[eigen_index(lists_.points() + k)] = c.im[k];
    }
    return u;
  }

  BeamMoves moves_of(std::size_t branch, const Eigen::MatrixXd& keep) const {
    BeamMoves out;
    const std::vector<Candidate>& list = lists_[branch];
    for (std::size_t c = 0; c < list.size(); ++c) {
      const BranchValue& value = list[c].value;
      const bool has_corner = problem_.branches[branch].kind == Branch::Kind::corner;
      if (has_corner && std::gcd(value.c0, value.c1) > 1) continue;  // the same shape as its lowest terms
      out.change.push_back(shape_of(list[c]) - nominal_[branch]);
      out.square.push_back(out.change.back().dot(keep * out.change.back()));
      out.candidate.push_back(c);
    }
    return out;
  }

  /// By how much (nepers) the settled branches of a branch's CAM miss the gain wanted of it; nothing while
  /// others of that CAM are still open.
  std::optional<double> partner_gain(std::size_t branch, const Choice& choice) const {
    const std::size_t cam = problem_.branches[branch].cam;
    double gain = -problem_.cam_log_gain[cam];
    for (std::size_t other = 0; other < lists_.branches(); ++other) {
      if (other == branch || problem_.branches[other].cam != cam) continue;
      if (!settled_[other]) return std::nullopt;
      gain += lists_[other][choice[other]].log_gain;
    }
    return gain;
  }

  /// Every state with every move whose CAM has the gain wanted of it, or with every move when there is none.
  std::vector<BeamSuccessor> successors(std::size_t branch, const std::vector<BeamState>& states,
                                        const BeamMoves& moves, const Eigen::MatrixXd& keep) const {
    std::vector<BeamSuccessor> out;
    out.reserve(states.size() * moves.change.size());
    for (const bool any_gain : {false, true}) {
      if (!out.empty()) break;
      for (std::size_t from = 0; from < states.size(); ++from) {
        const Eigen::VectorXd kept = keep * states[from].residual;
        const double base = states[from].residual.dot(kept);
        const std::optional<double> missing = partner_gain(branch, states[from].choice);
        const auto add = [&](std::size_t m) {
          const double cost = base + 2.0 * moves.change[m].dot(kept) + moves.square[m];
          out.push_back({cost, static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(m)});
        };
        if (problem_.branches[branch].kind != Branch::Kind::corner) {
          // It has no shape: the value that gives its CAM the gain wanted of it, whatever that costs.
          add(lists_.nearest_by_gain(branch, missing.value_or(-kUsualConstant)));
          continue;
        }
        for (std::size_t m = 0; m < moves.change.size(); ++m) {
          const bool fits =
              !missing || std::abs(*missing + lists_[branch][moves.candidate[m]].log_gain) <= kCamGainWindow;
          if (fits || any_gain) add(m);
        }
      }
    }
    return out;
  }

  /// The cheapest `width` of them, worked out.
  std::vector<BeamState> best_of(std::vector<BeamSuccessor> next, std::size_t branch,
                                 const std::vector<BeamState>& states, const BeamMoves& moves) const {
    const std::size_t width = std::min(next.size(), width_);
    const auto cheaper = [](const BeamSuccessor& x, const BeamSuccessor& y) {
      return x.cost != y.cost ? x.cost < y.cost : x.from != y.from ? x.from < y.from : x.move < y.move;
    };
    std::partial_sort(next.begin(), next.begin() + static_cast<std::ptrdiff_t>(width), next.end(), cheaper);
    std::vector<BeamState> out;
    for (std::size_t s = 0; s < width; ++s) {
      BeamState state = states[next[s].from];
      state.residual += moves.change[next[s].move];
      state.choice[branch] = moves.candidate[next[s].move];
      out.push_back(std::move(state));
    }
    return out;
  }

  const CandidateLists& lists_;
  const ChainProblem& problem_;
  double corner_weight_;
  std::size_t width_;
  std::vector<std::size_t> order_;  ///< coarsest first
  std::vector<Eigen::VectorXd> nominal_, slopes_;
  std::vector<bool> settled_;
};

}  // namespace

std::vector<Choice> beam_search(const CandidateLists& lists, double corner_weight, std::size_t width) {
  return BeamSearch(lists, corner_weight, width).run();
}

}  // namespace bodesmith::fpaa
