#include "gap/runner.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>
#include <variant>

#include "base/error.hpp"
#include "gap/records/lines.hpp"
#include "signal/statistics.hpp"
#include "simulate/record/record_simulator.hpp"

namespace bodesmith::gap {

namespace {

simulate::RecordOptions engine_options(const TimeExperiment& experiment) {
  simulate::RecordOptions o;
  o.start_s = experiment.record().start_s;
  o.oversample = experiment.holds();
  o.same_input = true;
  // A search need not follow wild values to their end, nor leading ones to the last digit.
  o.max_parts = 3.0;
  o.newton_tolerance = experiment.coarse() ? 1e-8 : 1e-10;
  if (experiment.coarse()) o.max_turn_rad = 1.6;
  return o;
}

void copy_values(const Model& model, chain::Chain& chain) {
  for (std::size_t i = 0; i < model.size(); ++i) {
    const auto& from = model.at(i).parameters();
    auto& to = chain.blocks[i].parameters();
    for (std::size_t k = 0; k < from.size(); ++k) to[k].value = from[k].value;
  }
}

}  // namespace

// A bench runs one chain structure against one record, again and again with other parameter values. residuals() appends (model - measured)
// at every scored sample; false when the chain cannot be run with its present values (it runs away).

class TimeBench {
 public:
  /// `lines`: places of blocks whose size and phase are the record's own.
  TimeBench(const chain::Chain& chain, std::vector<std::size_t> lines, const TimeExperiment& experiment)
      : experiment_(experiment),
        simulator_(chain, experiment.record().step_s, engine_options(experiment)),
        lines_(std::move(lines)) {}

  chain::Chain& chain() { return simulator_.chain(); }

  bool residuals(std::vector<double>& append) {
    const auto& record = experiment_.record();
    const auto y = simulator_.run(std::span<const double>(record.u).first(experiment_.end()));
    const std::size_t before = append.size();
    append.resize(before + experiment_.scored());
    const auto mine = std::span(append).subspan(before);
    double sum_of_squares = 0.0;
    for (std::size_t i = 0, k = experiment_.first(); k < experiment_.end(); ++i, ++k) {
      mine[i] = y[k] - record.y[k];
      sum_of_squares += mine[i] * mine[i];
    }
    take_out_lines(mine);
    return !simulator_.diverged() && std::isfinite(sum_of_squares);
  }

 private:
  /// What the lines of the mains explain, which each record has of its own.
  void take_out_lines(std::span<double> residual) {
    if (lines_.empty()) return;
    std::vector<double> frequencies;
    for (std::size_t at : lines_) frequencies.push_back(simulator_.chain().blocks[at].get("frequency_hz"));
    if (frequencies != frequencies_hz_) {
      frequencies_hz_ = frequencies;
      lines_of_record_ =
          directions_of_lines(frequencies, experiment_.record(), experiment_.first(), experiment_.end());
    }
    lines_of_record_.take_out(residual);
  }

  TimeExperiment experiment_;
  simulate::RecordSimulator simulator_;
  std::vector<std::size_t> lines_;
  std::vector<double> frequencies_hz_;  ///< of
  Directions lines_of_record_;
};

class FrequencyBench {
 public:
  FrequencyBench(const chain::Chain& chain, const FrequencyExperiment& experiment)
      : chain_(chain), experiment_(experiment) {}

  chain::Chain& chain() { return chain_; }

  bool residuals(std::vector<double>& append) {
    const auto& record = experiment_.record();
    const auto& weights = experiment_.weights();
    for (std::size_t i = 0; i < record.frequency.size(); ++i) {
      const auto h = chain_.response(record.frequency[i].rad_s());
      if (!h) return false;
      const auto ratio = *h / record.response[i];
      const auto difference = experiment_.logarithmic() ? std::log(ratio) : ratio - 1.0;
      const auto e = difference * (weights.empty() ? 1.0 : weights[i]);
      if (!std::isfinite(e.real()) || !std::isfinite(e.imag())) return false;
      append.push_back(e.real());
      append.push_back(e.imag());
    }
    return true;
  }

 private:
  chain::Chain chain_;
  FrequencyExperiment experiment_;
};

using Bench = std::variant<TimeBench, FrequencyBench>;

/// For one thread.
struct Runner::Benches {
  Model model;
  std::vector<Bench> of_each;

  Benches(const Model& of, const Experiments& experiments) : model(of) {
    const auto chain = model.chain();
    std::vector<std::size_t> lines;
    for (int id : model.line_blocks()) lines.push_back(model.position_of(id));
    for (const auto& one : experiments) {
      std::visit(
          Visitor{[&](const TimeExperiment& e) { of_each.emplace_back(TimeBench(chain, lines, e)); },
                  [&](const FrequencyExperiment& e) { of_each.emplace_back(FrequencyBench(chain, e)); }},
          one);
    }
  }

  bool residuals(std::span<const double> values, std::vector<double>& out) {
    out.clear();
    try {
      model.set_values(values);
      if (!model.validation_error().empty()) return false;
      const auto run = [&](auto& bench) {
        copy_values(model, bench.chain());
        return bench.residuals(out);
      };
      return std::ranges::all_of(of_each, [&](Bench& bench) { return std::visit(run, bench); });
    } catch (const InputError&) {
      return false;  // a relation between parameters that an engine needs and a trial value breaks
    }
  }
};

Runner::Runner(const Model& model, const Experiments& experiments)
    : model_(model), experiments_(experiments) {
  idle_.push_back(std::make_unique<Benches>(model_, experiments_));
}
Runner::~Runner() = default;

std::unique_ptr<Runner::Benches> Runner::take() {
  {
    const std::lock_guard lock(guard_);
    if (!idle_.empty()) {
      auto benches = std::move(idle_.back());
      idle_.pop_back();
      return benches;
    }
  }
  return std::make_unique<Benches>(model_, experiments_);
}

bool Runner::operator()(std::span<const double> values, std::vector<double>& out) {
  auto benches = take();
  const bool runnable = benches->residuals(values, out);
  const std::lock_guard lock(guard_);
  idle_.push_back(std::move(benches));
  return runnable;
}

std::vector<double> residuals_of(const Model& model, const Experiments& experiments) {
  std::vector<double> out;
  try {
    Runner runner(model, experiments);
    if (!runner(model.values(), out)) out.clear();
  } catch (const InputError&) {  // as in Runner: no outcome to compare
    out.clear();
  }
  return out;
}

Model with_lines_of(Model model, const Experiment& experiment) {
  const auto ids = model.line_blocks();
  const auto* time = std::get_if<TimeExperiment>(&experiment);
  if (ids.empty() || time == nullptr) return model;
  std::vector<double> frequencies;
  for (int id : ids) {
    frequencies.push_back(model.block(id).get("frequency_hz"));
    model.block(id).set("amplitude", 0.0);
  }
  const auto output = bare_output_of(model, *time);
  if (output.empty()) return model;
  const auto& record = time->record();
  std::vector<double> residual;
  for (std::size_t i = time->first(); i < time->end(); ++i) residual.push_back(record.y[i] - output[i]);
  const auto lines = fit_lines(frequencies, record, time->first(), residual);
  for (std::size_t k = 0; k < ids.size(); ++k)
    model.block(ids[k]).set("amplitude", lines[k].amplitude).set("phase_deg", lines[k].phase_deg);
  return model;
}

std::vector<double> output_of(const Model& model, const TimeExperiment& experiment) {
  return bare_output_of(with_lines_of(model, experiment), experiment);
}

std::vector<double> bare_output_of(const Model& model, const TimeExperiment& experiment) {
  if (!model.validation_error().empty()) return {};
  simulate::RecordSimulator simulator(model.chain(), experiment.record().step_s, engine_options(experiment));
  return simulator.run_once(experiment.record().u);
}

double rms_of(const Model& model, const Experiments& experiments) {
  const auto e = residuals_of(model, experiments);
  return e.empty() ? std::numeric_limits<double>::infinity() : rms(e);
}

}  // namespace bodesmith::gap
