#include "fpaa/plan_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/whole_number.hpp"

namespace bodesmith::fpaa {
namespace {

/// No filter is asked for more than this gain; what is left over goes to gain stages of their own.
constexpr double kMaxGainOfFilter = 8.0;
constexpr double kMaxGainOfStage = 50.0;
/// Points of the band at which the peak of a node is looked for.
constexpr int kPeakPoints = 64;

/// ln of the highest magnitude of the first `count` tasks, their gain left out, over the band.
double log_peak(const TaskChain& chain, std::size_t count, Band band) {
  double peak = -std::numeric_limits<double>::infinity();
  for (const Hertz f : log_grid(band, kPeakPoints)) {
    double magnitude = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      magnitude += std::log(std::abs(chain.tasks[i]->response(f.rad_s())));
    }
    peak = std::max(peak, magnitude);
  }
  return peak;
}

CamTaskPtr make_gain_stage(const std::string& name) {
  for (const Cam* cam : cam_registry().all()) {
    if (CamTaskPtr task = cam->gain_stage(name)) return task;
  }
  throw std::logic_error("no CAM of the registry is a gain stage");
}

/// Gain of each task so that the peaks of the nodes are evenly spaced in ratio: ln.
std::vector<double> spread_gain(const TaskChain& chain, Band band) {
  std::vector<double> out;
  const std::size_t count = chain.tasks.size();
  const double end = log_peak(chain, count, band) + chain.log_gain;
  double before = 0.0;
  for (std::size_t c = 0; c < count; ++c) {
    const double wanted_peak = end * static_cast<double>(c + 1) / static_cast<double>(count);
    const double node = wanted_peak - log_peak(chain, c + 1, band);  // ln of all gain up to this node
    out.push_back(node - before);
    before = node;
  }
  return out;
}

/// Joins ln(got/wanted) of a CAM that is settled to what the other branches must make up for.
void add_settled(const CamTask& task, const PlacedCam& cam, ChainProblem& chain) {
  chain.others.resize(chain.grid.size());
  const double sign = task.inverts() ? -1.0 : 1.0;
  for (std::size_t k = 0; k < chain.grid.size(); ++k) {
    const RadPerSecond w = chain.grid[k];
    chain.others[k] += std::log(sign * cam.z.response(w, chain.clock) / task.response(w));
  }
}

TaskSetting setting_of(const PlanProblem& problem, std::size_t task) {
  return {problem.wanted_gain[task], problem.chain.clock, problem.chain.grid, problem.chain.max_capacitor};
}

}  // namespace

TaskChain with_gain_stages(TaskChain chain, Band band, std::size_t extra) {
  const std::size_t filters = chain.tasks.size();
  const double total = std::abs(log_peak(chain, filters, band) + chain.log_gain);
  const double by_filters = std::log(kMaxGainOfFilter) * static_cast<double>(filters);
  std::size_t stages = 0;
  if (total > by_filters) {
    stages = whole_number<std::size_t>(std::ceil((total - by_filters) / std::log(kMaxGainOfStage)));
  }
  const auto inverting = static_cast<std::size_t>(std::count_if(
      chain.tasks.begin(), chain.tasks.end(), [](const CamTaskPtr& task) { return task->inverts(); }));
  const bool inverts = (inverting + stages) % 2 == 1;
  if (inverts != chain.negative) ++stages;
  for (std::size_t s = 0; s < stages + extra; ++s) {
    chain.tasks.push_back(make_gain_stage(fmt::format("Gain{}", chain.tasks.size() + 1)));
  }
  return chain;
}

std::optional<PlanProblem> plan_problem(const TaskChain& tasks, Hertz clock, Band band, int points,
                                        int max_capacitor) {
  PlanProblem out;
  ChainProblem& chain = out.chain;
  chain.clock = clock;
  chain.log_gain = tasks.log_gain;
  chain.max_capacitor = max_capacitor;
  for (const Hertz f : log_grid(band, points)) chain.grid.push_back(f.rad_s());
  const std::vector<double> log_gains = spread_gain(tasks, band);
  for (std::size_t c = 0; c < tasks.tasks.size(); ++c) {
    const CamTask& task = *tasks.tasks[c];
    out.wanted_gain.push_back(std::exp(log_gains[c]));
    if (task.is_settled_alone()) {
      auto settled = task.settle(setting_of(out, c));
      if (!settled) return std::nullopt;
      add_settled(task, *settled, chain);
      out.first_branch.emplace_back();
      out.settled.push_back(std::move(settled));
      chain.cam_log_gain.push_back(0.0);
    } else {
      out.first_branch.emplace_back(chain.branches.size());
      out.settled.emplace_back();
      chain.cam_log_gain.push_back(log_gains[c]);
      for (Branch branch : task.branches()) {
        branch.cam = c;
        chain.branches.push_back(branch);
      }
    }
  }
  return out;
}

std::vector<PlacedCam> realised_cams(const TaskChain& chain, const PlanProblem& problem,
                                     const ChainSolution& solution) {
  std::vector<PlacedCam> out;
  const std::span<const BranchValue> values(solution.values);
  for (std::size_t c = 0; c < chain.tasks.size(); ++c) {
    if (problem.settled[c]) {
      out.push_back(*problem.settled[c]);
    } else {
      const std::size_t count = chain.tasks[c]->branches().size();
      out.push_back(
          chain.tasks[c]->realise(values.subspan(*problem.first_branch[c], count), setting_of(problem, c)));
    }
  }
  return out;
}

Band possible_clocks(const TaskChain& chain, int max_capacitor) {
  Band out{{0.0}, {std::numeric_limits<double>::infinity()}};
  for (const CamTaskPtr& task : chain.tasks) {
    const Band own = task->possible_clocks(max_capacitor);
    out = {std::max(out.from, own.from), std::min(out.to, own.to)};
  }
  return out;
}

}  // namespace bodesmith::fpaa
