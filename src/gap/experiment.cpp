#include "gap/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "gap/statistics.hpp"
#include "simulate/record_simulator.hpp"

namespace bodesmith::gap {
namespace {

class TimeBench final : public Bench {
 public:
  TimeBench(const chain::Chain& chain, const TimeRecord& record, std::size_t from, std::size_t to,
            bool coarse)
      : record_(record), from_(from), to_(to), simulator_(chain, record.step_s, options(record, coarse)) {}
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
    o.most_parts = 3.0;
    o.newton_tolerance = coarse ? 1e-8 : 1e-10;
    if (coarse) o.most_turn_rad = 1.6;
    return o;
  }
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
  return std::make_unique<TimeBench>(chain, record_, skip_, to_, coarse_);
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
  // What was known beforehand counts as one more sample each, in units of the residual at the start.
  double unit = 0.0;
  {
    std::vector<double> out;
    if (runner(current_values(model), out)) unit = rms(out);
  }
  const auto result = least_squares(
      unknowns,
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
  if (result.usable) model.set_values(result.values);
  return result;
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
