#include "gap/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>

#include "signal/statistics.hpp"
#include "simulate/record_simulator.hpp"

namespace bodesmith::gap {
namespace {

class TimeBench final : public Bench {
 public:
  TimeBench(const chain::Chain& chain, const TimeExperiment& experiment, bool coarse)
      : experiment_(experiment),
        record_(experiment.record()),
        from_(experiment.skip()),
        to_(experiment.to()),
        simulator_(chain, record_.step_s, options(record_, coarse)) {}
  chain::Chain& chain() override { return simulator_.chain(); }
  bool residuals(std::vector<double>& append) override {
    const auto y = simulator_.run(std::span<const double>(record_.u).first(to_));
    const double limit = 1e12;
    const std::size_t start = append.size();
    append.resize(start + (to_ - from_));
    double check = 0.0;
    for (std::size_t i = from_; i < to_; ++i) {
      const double e = y[i] - record_.y[i];
      append[start + i - from_] = e;
      check += e * e;
    }
    experiment_.take_out_free_start(std::span(append).subspan(start));
    return !simulator_.diverged() && std::isfinite(check) && check < limit * limit;
  }
  std::vector<double> output() override {
    const auto y = simulator_.run(record_.u);
    return {y.begin(), y.end()};
  }

 private:
  static simulate::RecordOptions options(const TimeRecord& record, bool coarse) {
    simulate::RecordOptions o;
    o.start_s = record.start_s;
    o.max_parts = 3.0;
    o.newton_tolerance = coarse ? 1e-8 : 1e-10;
    if (coarse) o.max_turn_rad = 1.6;
    return o;
  }
  const TimeExperiment& experiment_;
  const TimeRecord& record_;
  std::size_t from_;
  std::size_t to_;
  simulate::RecordSimulator simulator_;
};

class FrequencyBench final : public Bench {
 public:
  FrequencyBench(const chain::Chain& chain, const FrequencyRecord& record) : chain_(chain), record_(record) {}
  chain::Chain& chain() override { return chain_; }
  bool residuals(std::vector<double>& append) override {
    for (std::size_t i = 0; i < record_.frequency.size(); ++i) {
      const auto h = chain_.response(record_.frequency[i].rad_s());
      if (!h) return false;
      const auto e = *h / record_.response[i] - 1.0;
      if (!std::isfinite(e.real()) || !std::isfinite(e.imag())) return false;
      append.push_back(e.real());
      append.push_back(e.imag());
    }
    return true;
  }
  std::vector<double> output() override { return {}; }

 private:
  chain::Chain chain_;
  const FrequencyRecord& record_;
};

void copy_values(const Model& model, chain::Chain& chain) {
  for (std::size_t i = 0; i < model.size(); ++i) {
    const auto& from = model.at(i).parameters();
    auto& to = chain.blocks[i].parameters();
    for (std::size_t k = 0; k < from.size(); ++k) to[k].value = from[k].value;
  }
}

}  // namespace

std::unique_ptr<Bench> TimeExperiment::bench(const chain::Chain& chain) const {
  return std::make_unique<TimeBench>(chain, *this, coarse_);
}

void TimeExperiment::take_out_free_start(std::span<double> residual) const {
  for (const auto& direction : free_start_) {
    const double part = std::inner_product(residual.begin(), residual.end(), direction.begin(), 0.0);
    for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= part * direction[i];
  }
}

double TimeExperiment::range() const {
  if (record_.y.empty()) return 1.0;
  const auto [low, high] = std::minmax_element(record_.y.begin(), record_.y.end());
  return std::max(*high - *low, 1e-300);
}

std::unique_ptr<Bench> FrequencyExperiment::bench(const chain::Chain& chain) const {
  return std::make_unique<FrequencyBench>(chain, record_);
}

Runner::Runner(const Model& model, const Experiments& experiments) : model_(model) {
  const auto chain = model.chain();
  for (const auto* e : experiments) benches_.push_back(e->bench(chain));
}

bool Runner::apply(std::span<const double> values) {
  model_.set_values(values);
  if (!model_.complaint().empty()) return false;
  for (auto& b : benches_) copy_values(model_, b->chain());
  return true;
}

bool Runner::operator()(std::span<const double> values, std::vector<double>& out) {
  out.clear();
  // A trial value outside what an engine can run is an outcome of the search, not an error of the user.
  try {
    if (!apply(values)) return false;
    for (auto& b : benches_) {
      if (!b->residuals(out)) return false;
    }
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

std::vector<std::vector<double>> Runner::outputs(std::span<const double> values) {
  std::vector<std::vector<double>> all;
  if (!apply(values)) return all;
  for (auto& b : benches_) all.push_back(b->output());
  return all;
}

std::vector<double> current_values(const Model& model) {
  std::vector<double> values;
  for (const auto& u : model.unknowns()) values.push_back(u.value);
  return values;
}

LeastSquaresResult fit(Model& model, const Experiments& experiments, const LeastSquaresOptions& options) {
  Runner runner(model, experiments);
  const auto unknowns = model.unknowns();
  const auto known =
      std::count_if(unknowns.begin(), unknowns.end(), [](const Unknown& u) { return u.given_spread > 0.0; });
  // What was known beforehand counts as one more sample each, in units of the residual that is left in the
  // end: a fit that began far off is done again with the smaller unit.
  LeastSquaresResult result;
  double unit = 0.0;
  {
    std::vector<double> out;
    if (runner(current_values(model), out)) unit = rms(out);
  }
  for (int round = 0; round < 4; ++round) {
    result = least_squares(
        model.unknowns(),
        [&](std::span<const double> v, std::vector<double>& out) {
          if (!runner(v, out)) return false;
          for (std::size_t k = 0; k < unknowns.size(); ++k) {
            const auto& u = unknowns[k];
            if (!(u.given_spread > 0.0)) continue;
            const double off = u.logarithmic ? std::log(v[k] / u.given) : v[k] - u.given;
            out.push_back(unit * off / u.given_spread);
          }
          return true;
        },
        options);
    if (!result.usable) break;
    model.set_values(result.values);
    result.residuals.resize(result.residuals.size() - static_cast<std::size_t>(known));
    const double left = rms(result.residuals);
    if (known == 0 || left > 0.5 * unit || (options.stop && options.stop())) break;
    unit = left;
  }
  result.rms = rms(result.residuals);
  return result;
}

std::vector<std::vector<double>> free_responses(const Model& model, const TimeExperiment& experiment,
                                                std::size_t skip) {
  const auto& record = experiment.record();
  const auto input = std::span<const double>(record.u).first(experiment.to());
  simulate::RecordOptions options;
  options.start_s = record.start_s;
  simulate::RecordSimulator simulator(model.chain(), record.step_s, options);
  const auto plain = simulator.run(input);
  const std::vector<double> base(plain.begin() + static_cast<std::ptrdiff_t>(skip), plain.end());
  // Small against the output, so that nonlinear dynamics answer in proportion.
  const double nudge = 1e-5 * std::max(rms(base), 1e-300);
  std::vector<std::vector<double>> directions;
  for (std::size_t k = 0; k < simulator.initial_states().size(); ++k) {
    simulator.initial_states()[k] = nudge;
    const auto y = simulator.run(input);
    simulator.initial_states()[k] = 0.0;
    std::vector<double> d(base.size());
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = (y[i + skip] - base[i]) / nudge;
    const double size = rms(d);
    if (!(size > 0.0) || !std::isfinite(size)) continue;
    for (double& x : d) x /= size;
    for (int twice = 0; twice < 2; ++twice) {
      for (const auto& q : directions) {
        const double part = std::inner_product(d.begin(), d.end(), q.begin(), 0.0);
        for (std::size_t i = 0; i < d.size(); ++i) d[i] -= part * q[i];
      }
    }
    const double left = rms(d);
    if (left < 1e-3) continue;
    const double length = left * std::sqrt(static_cast<double>(d.size()));
    for (double& x : d) x /= length;
    directions.push_back(std::move(d));
  }
  return directions;
}

std::vector<double> residuals_of(const Model& model, const Experiments& experiments) {
  std::vector<double> out;
  try {
    Runner runner(model, experiments);
    if (!runner(current_values(model), out)) out.clear();
  } catch (const std::exception&) {
    out.clear();
  }
  return out;
}

}  // namespace bodesmith::gap
