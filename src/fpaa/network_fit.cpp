#include "fpaa/network_fit.hpp"

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "fpaa/grid_arithmetic.hpp"
#include "fpaa/stage_view.hpp"
#include "numeric/least_squares.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;
using Stage = NetworkStage;

constexpr double kLeastContinuous = 0.02;  ///< units, before the stage is scaled up
/// The free capacitors as unknowns.
struct FreeCapacitor {
  std::size_t stage = 0;
  std::size_t capacitor = 0;
};
std::vector<FreeCapacitor> free_capacitors(const Network& network) {
  std::vector<FreeCapacitor> out;
  for (std::size_t s = 0; s < network.stages.size(); ++s) {
    for (std::size_t c = 0; c < network.stages[s].c.size(); ++c) {
      if (network.stages[s].free[c] != 0 && network.stages[s].c[c] > 0.0) out.push_back({s, c});
    }
  }
  return out;
}

/// One run of the least squares with these weights on top of the target's.
void fit_once(Network& network, const NetworkResponse& response, const std::vector<double>& lean,
              int iterations) {
  const std::vector<FreeCapacitor> list = free_capacitors(network);
  if (list.empty()) return;
  const NetworkTarget& target = response.target();
  const auto points = static_cast<Eigen::Index>(target.grid.size());
  std::vector<SearchVariable> unknowns;
  for (const FreeCapacitor& f : list) {
    const double value = network.stages[f.stage].c[f.capacitor];
    const double most = 4.0 * target.max_capacitor;  // rounding scales stages down
    unknowns.push_back({.value = std::clamp(value, kLeastContinuous, most),
                        .min = kLeastContinuous,
                        .max = most,
                        .logarithmic = true});
  }
  Network trial = network;
  const auto set = [&](const Eigen::VectorXd& values) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      trial.stages[list[i].stage].c[list[i].capacitor] = values[static_cast<Eigen::Index>(i)];
    }
  };
  const auto residuals = [&](const Eigen::VectorXd& values, Eigen::VectorXd& out) {
    stop_if_interrupted();
    set(values);
    const std::vector<Complex> e = response.errors(trial);
    out.resize(2 * points);
    for (Eigen::Index k = 0; k < points; ++k) {
      const Complex v = e[static_cast<std::size_t>(k)] * lean[static_cast<std::size_t>(k)];
      out[2 * k] = v.real();
      out[2 * k + 1] = v.imag();
    }
    return out.allFinite();
  };
  LeastSquaresOptions options;
  options.max_iterations = iterations;
  options.broyden = false;
  options.jacobian = [&](const Eigen::VectorXd& values, Eigen::MatrixXd& out) {
    set(values);
    out.setZero(2 * points, static_cast<Eigen::Index>(list.size()));
    for (const CapacitorEffect& effect : capacitor_effects(trial, response, true)) {
      const auto at = std::find_if(list.begin(), list.end(), [&](const FreeCapacitor& f) {
        return f.stage == effect.stage && f.capacitor == effect.capacitor;
      });
      if (at == list.end()) continue;
      const auto column = static_cast<Eigen::Index>(at - list.begin());
      for (Eigen::Index k = 0; k < points; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const Complex v =
            effect.values[i] * target.weight[i] * target.reciprocal[i] * lean[i] / values[column];
        out(2 * k, column) = v.real();
        out(2 * k + 1, column) = v.imag();
      }
    }
  };
  const LeastSquaresResult result = least_squares(unknowns, residuals, options);
  if (result.values.size() != static_cast<Eigen::Index>(list.size())) return;
  set(result.values);
  network = std::move(trial);
}

}  // namespace

std::vector<CapacitorEffect> capacitor_effects(const Network& network, const NetworkResponse& response,
                                               bool only_free) {
  std::vector<CapacitorEffect> out;
  const auto transfers = response.transfers(network);
  const auto nodes = response.nodes(network, transfers);
  const auto onward = response.onward(network, transfers);
  const std::size_t points = response.target().grid.size();
  for (std::size_t s = 0; s < network.stages.size(); ++s) {
    const Stage& stage = network.stages[s];
    const bool any = std::any_of(stage.free.begin(), stage.free.end(), [](char f) { return f != 0; });
    if (only_free && !any) continue;
    const StageOnGrid on_grid(stage, response.d_of(stage.divisor));
    std::vector<std::vector<Complex>> own,
        ways;  // of each input: the stage's response; from there to the output
    for (std::size_t i = 0; i < stage.from.size(); ++i) {
      own.push_back(on_grid.response(i));
      ways.push_back(onward[s]);
      if (stage.from[i] == Stage::kBoardInput) continue;
      const auto source = static_cast<std::size_t>(stage.from[i]);
      const std::vector<Complex>& read = response.read_of(network.stages[source].divisor, stage.divisor);
      GridValues reads = nodes[source];
      multiply(reads, read);
      multiply(ways.back(), reads);
    }
    for (std::size_t c = 0; c < stage.c.size(); ++c) {
      if (!(stage.c[c] > 0.0) || (only_free && stage.free[c] == 0)) continue;
      CapacitorEffect effect{s, c, std::vector<Complex>(points, 0.0)};
      const bool of_one = stage.kind == Stage::Kind::first && c < 2 * stage.from.size();
      for (std::size_t i = 0; i < stage.from.size(); ++i) {
        if (of_one && i != c / 2) continue;
        add_product(effect.values, on_grid.derivative(i, c, own[i]), ways[i]);
      }
      out.push_back(std::move(effect));
    }
  }
  return out;
}

void fit_network(Network& network, const NetworkResponse& response, int iterations, int passes) {
  std::vector<double> lean(response.target().grid.size(), 1.0);
  Network best = network;
  double least = 1e300;
  for (int pass = 0; pass < passes; ++pass) {
    fit_once(network, response, lean, iterations);
    const std::vector<Complex> e = response.errors(network);
    const double worst = largest_error(e);
    if (worst < least) {
      least = worst;
      best = network;
    }
    if (pass + 1 == passes || !(worst > 0.0)) break;
    double mean = 0.0;
    for (std::size_t k = 0; k < lean.size(); ++k) {
      lean[k] *= std::sqrt(0.05 + std::abs(e[k]) / worst);
      mean += lean[k] / static_cast<double>(lean.size());
    }
    for (double& l : lean) l /= mean;
  }
  network = std::move(best);
}

std::vector<double> mismatch_sigma(const Network& network, const NetworkResponse& response,
                                   const MismatchModel& mismatch) {
  const NetworkTarget& target = response.target();
  std::vector<double> variance(target.grid.size(), 0.0);
  for (const CapacitorEffect& effect : capacitor_effects(network, response)) {
    const double sigma = mismatch.relative_sigma(network.stages[effect.stage].c[effect.capacitor]);
    for (std::size_t k = 0; k < variance.size(); ++k) {
      variance[k] += std::norm(effect.values[k] * target.reciprocal[k] * sigma);
    }
  }
  for (double& v : variance) v = std::sqrt(v);
  return variance;
}

double clipping_of(const Network& network, const NetworkResponse& response) {
  const auto nodes = response.nodes(network);
  double ends = 1.0;
  for (const Complex& h : nodes.back()) ends = std::max(ends, std::abs(h));
  double most = 0.0;
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    const Stage& stage = network.stages[s];
    const bool second = stage.kind != Stage::Kind::first;
    const std::vector<Complex>& d = response.d_of(stage.divisor);
    for (std::size_t k = 0; k < nodes[s].size(); ++k) {
      most = std::max(most, std::abs(nodes[s][k]));
      if (!second) continue;
      const int from = stage.from[0];
      const double in = from == Stage::kBoardInput ? 1.0 : std::abs(nodes[static_cast<std::size_t>(from)][k]);
      most = std::max(most, in * stage.inner_gain(d[k]));
    }
  }
  return most / ends;
}

double clipping_cost(double clipping) {
  constexpr double kOfTwo = 0.5;
  return clipping > 1.0 ? 1.0 + kOfTwo * std::log2(clipping) : 1.0;
}

NetworkScore network_score(const Network& network, const NetworkResponse& response,
                           const MismatchModel& mismatch, double mismatch_weight) {
  NetworkScore out;
  const std::vector<Complex> e = response.errors(network);
  const std::vector<double> sigma = mismatch_sigma(network, response, mismatch);
  const NetworkTarget& target = response.target();
  out.error = largest_error(e);
  for (std::size_t k = 0; k < e.size(); ++k) {
    const double spread = target.weight[k] * sigma[k];
    if (target.weight[k] >= 1.0) out.in_band = std::max(out.in_band, std::abs(e[k]));
    out.sigma = std::max(out.sigma, spread);
    out.total = std::max(out.total, error_of_95_percent(e[k], mismatch_weight * spread));
  }
  if (out.error > 1e200) out.total = out.error;
  return out;
}

void polish_network(Network& network, const NetworkResponse& response, const MismatchModel& mismatch,
                    double mismatch_weight, int passes) {
  const bool spread = mismatch_weight > 0.0;
  double best = spread ? network_score(network, response, mismatch, mismatch_weight).total
                       : largest_error(response.errors(network));
  for (int pass = 0; pass < passes; ++pass) {
    const double before = best;
    for (std::size_t s = 0; s < network.stages.size(); ++s) {
      Stage& stage = network.stages[s];
      std::vector<StageView> view;
      if (!spread) view.emplace_back(network, s, response);
      const auto judge = [&] {
        return spread ? network_score(network, response, mismatch, mismatch_weight).total
                      : view.front().largest_error_with(stage);
      };
      for (std::size_t c = 0; c < stage.c.size(); ++c) {
        if (!(stage.c[c] > 0.0)) continue;
        for (const double step : {1.0, -1.0, 2.0, -2.0, 5.0, -5.0}) {
          const double old = stage.c[c];
          const double next = old + step;
          if (next < 1.0 || next > stage.largest_units(c, response.target().max_capacitor)) continue;
          stage.c[c] = next;
          const double got = stage.is_stable() ? judge() : 1e300;
          if (got < best) {
            best = got;
          } else {
            stage.c[c] = old;
          }
        }
      }
    }
    if (best > 0.999 * before) break;
  }
}

}  // namespace bodesmith::fpaa
