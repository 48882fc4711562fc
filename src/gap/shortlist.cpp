#include "gap/shortlist.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "numeric/parallel_for.hpp"

namespace bodesmith::gap {
namespace {

using Vector = Eigen::VectorXd;

Vector as_vector(const std::vector<double>& v) {
  return Eigen::Map<const Vector>(v.data(), static_cast<Eigen::Index>(v.size()));
}

/// Orthonormal directions built one at a time; nearly dependent ones are left out.
class Span {
 public:
  void add(Vector v) {
    const double size = v.norm();
    if (!(size > 0.0) || !std::isfinite(size)) return;
    v /= size;
    for (int twice = 0; twice < 2; ++twice) {
      for (const auto& d : directions_) v -= d * d.dot(v);
    }
    const double left = v.norm();
    if (left < 1e-5) return;
    directions_.push_back(v / left);
  }
  Vector without(Vector v) const {
    for (const auto& d : directions_) v -= d * d.dot(v);
    return v;
  }
  const std::vector<Vector>& directions() const { return directions_; }

 private:
  std::vector<Vector> directions_;
};

struct Look {
  std::size_t start = 0;
  double score = 0.0;
};

std::vector<Look> look_at(const Proposal& proposal, const Experiments& records, const Span& known,
                          const Vector& base, const Vector& residual, double energy) {
  std::vector<Look> looks;
  Runner runner(proposal.model, records);
  auto values = current_values(proposal.model);
  const auto& term = proposal.model.terms().back();
  const std::size_t own = term.unknowns.size();
  const std::size_t first = values.size() - own;
  std::vector<double> out;
  std::vector<double> moved;
  for (std::size_t s = 0; s < proposal.starts.size(); ++s) {
    std::copy(proposal.starts[s].begin(), proposal.starts[s].end(),
              values.begin() + static_cast<std::ptrdiff_t>(first));
    if (!runner(values, out)) continue;
    Span more = known;
    const std::size_t before = more.directions().size();
    const Vector here = as_vector(out);
    more.add(here - base);
    // With many starts the change itself is enough; with few, the unknowns' own directions are worth their
    // runs.
    if (proposal.starts.size() <= 6) {
      for (std::size_t k = 0; k < own; ++k) {
        const auto& u = term.unknowns[k];
        auto other = values;
        const double step = u.logarithmic ? 0.02 * values[first + k] : 0.02 * u.scale;
        other[first + k] =
            values[first + k] + step > u.high ? values[first + k] - step : values[first + k] + step;
        if (runner(other, moved)) more.add(as_vector(moved) - here);
      }
    }
    double explained = 0.0;
    for (std::size_t d = before; d < more.directions().size(); ++d) {
      const double part = more.directions()[d].dot(residual);
      explained += part * part;
    }
    looks.push_back({s, energy > 0.0 ? explained / energy : 0.0});
  }
  std::stable_sort(looks.begin(), looks.end(),
                   [](const Look& a, const Look& b) { return a.score > b.score; });
  return looks;
}

}  // namespace

std::vector<Promising> shortlist(const Model& model, std::vector<Proposal> proposals, const Experiments& look,
                                 int threads) {
  Runner runner(model, look);
  const auto values = current_values(model);
  std::vector<double> out;
  std::vector<Promising> all;
  if (!runner(values, out)) return all;
  const Vector base = as_vector(out);
  Span known;
  for (const auto& column : sensitivities(
           model.unknowns(), [&](std::span<const double> v, std::vector<double>&o) { return runner(v, o); },
           values)) {
    if (!column.empty()) known.add(as_vector(column));
  }
  const Vector residual = known.without(base);
  const double energy = base.squaredNorm();
  all.resize(proposals.size());
  parallel_for(proposals.size(), threads, [&](std::size_t i) {
    auto& p = all[i];
    try {
      const auto looks = look_at(proposals[i], look, known, base, residual, energy);
      for (const auto& l : looks) p.best_starts.push_back(l.start);
      p.score = looks.empty() ? 0.0 : looks.front().score;
    } catch (const std::exception&) {
      p.score = 0.0;  // a chain that cannot be run at its start values is no candidate
    }
    p.proposal = std::move(proposals[i]);
  });
  std::erase_if(all, [](const Promising& p) { return p.best_starts.empty(); });
  std::stable_sort(all.begin(), all.end(),
                   [](const Promising& a, const Promising& b) { return a.score > b.score; });
  return all;
}

}  // namespace bodesmith::gap
