#include "tolerance/controller/study.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/statistics.hpp"
#include "synthesis/controller/as_built.hpp"

namespace bodesmith::tolerance {
namespace {

using generator::DisturbanceCircuit;

double largest(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::ranges::max_element(values);
}

/// Each cause alone, at one standard deviation: what it moves y by, at every frequency.
struct OneAtATime {
  std::vector<double> mean_square;  ///< over the frequencies, each cause
  std::vector<double> worst_rms;
};

OneAtATime one_at_a_time(const Bench& bench, const DisturbanceCircuit& controller,
                         const std::vector<generator::Cause>& causes, int threads) {
  const Board nominal(bench.wiring(), copy_of(controller, {}, {}));
  std::vector<std::vector<double>> y;
  for (std::size_t f = 0; f < bench.frequencies(); ++f) y.push_back(bench.displacement(nominal, f));
  OneAtATime out{std::vector<double>(causes.size()), std::vector<double>(causes.size())};
  parallel_for(causes.size(), threads, [&](std::size_t i) {
    std::vector<double> values(causes.size(), 0.0);
    values[i] = causes[i].departure.deviation();
    const Board board(bench.wiring(), copy_of(controller, causes, values), &nominal);
    for (std::size_t f = 0; f < bench.frequencies(); ++f) {
      std::vector<double> moved = bench.displacement(board, f);
      for (std::size_t k = 0; k < moved.size(); ++k) moved[k] -= y[f][k];
      double square = 0.0;
      for (const double e : without_lag(std::move(moved), bench.input(f).r))
        square += e * e / static_cast<double>(y[f].size());
      out.mean_square[i] += square / static_cast<double>(bench.frequencies());
      out.worst_rms[i] = std::max(out.worst_rms[i], 100.0 * std::sqrt(square));
    }
  });
  return out;
}

void take_shares(const OneAtATime& alone, const std::vector<generator::Cause>& causes, Study& out) {
  double total = 0.0;
  for (const double square : alone.mean_square) total += square;
  if (!(total > 0.0)) return;
  std::map<std::string, Share> groups;
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const double share = alone.mean_square[i] / total;
    out.parts.push_back({causes[i].name, causes[i].group, share, alone.worst_rms[i]});
    Share& group = groups[causes[i].group];
    group.name = group.group = causes[i].group;
    group.share += share;
    group.rms_percent = std::hypot(group.rms_percent, alone.worst_rms[i]);
  }
  for (const auto& [name, group] : groups) out.groups.push_back(group);
  const auto larger = [](const Share& a, const Share& b) { return a.share > b.share; };
  std::ranges::stable_sort(out.parts, larger);
  std::ranges::stable_sort(out.groups, larger);
}

}  // namespace

std::vector<double> without_lag(std::vector<double> e, const std::vector<double>& r) {
  const std::size_t n = e.size();
  const auto slope = [&](std::size_t i) { return r[(i + 1) % n] - r[(i + n - 1) % n]; };
  double along = 0.0, slopes = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    along += e[i] * slope(i);
    slopes += slope(i) * slope(i);
  }
  if (slopes > 0.0)
    for (std::size_t i = 0; i < n; ++i) e[i] -= along / slopes * slope(i);
  return e;
}

ErrorSpread spread_of(std::vector<double> percent, double nominal) {
  std::ranges::sort(percent);
  return {nominal, quantile_of_sorted(percent, 0.5), quantile_of_sorted(percent, 0.95),
          percent.empty() ? 0.0 : percent.back()};
}

std::vector<double> switch_delays_s(const DisturbanceCircuit& controller,
                                    const std::vector<Hertz>& frequencies) {
  std::vector<double> out(frequencies.size(), 0.0);
  for (std::size_t i = 0; i < out.size() && controller.switched(); ++i)
    out[i] = generator::switch_delay_s(controller, tracking::Reference(), frequencies[i]);
  return out;
}

Bench::Bench(const DisturbanceCircuit& controller, const tracking::Stage& stage, const StudyOptions& options)
    : wiring_(controller), stage_(stage), frequencies_(options.frequencies) {
  if (frequencies_.empty()) throw InputError("no frequency to track, expected at least one");
  const std::size_t samples = options.samples * options.reference.periods();
  const std::vector<double> delays =
      options.switch_delays_s.empty() ? switch_delays_s(controller, frequencies_) : options.switch_delays_s;
  for (std::size_t i = 0; i < frequencies_.size(); ++i) {
    inputs_.push_back(input_of(options.reference, frequencies_[i], samples));
    inputs_.back().switch_delay_s = delays[i];
  }
}

std::vector<double> Bench::displacement(const Board& board, std::size_t frequency) const {
  const Input& input = inputs_[frequency];
  return stage_.response(board.drive(input), input.step_s, frequencies_[frequency],
                         tracking::DriveKind::smooth);
}

double Bench::error_percent(const Board& board, std::size_t frequency) const {
  const Input& input = inputs_[frequency];
  const double repeat_s = input.step_s * static_cast<double>(input.r.size());
  return tracking::tracking_error(displacement(board, frequency), input.r, repeat_s).rms_percent_without_lag;
}

std::vector<double> Bench::errors_percent(const Board& board) const {
  std::vector<double> out;
  for (std::size_t f = 0; f < inputs_.size(); ++f) out.push_back(error_percent(board, f));
  return out;
}

Study study_errors(const DisturbanceCircuit& controller, const tracking::Stage& stage,
                   const StudyOptions& options) {
  const Bench bench(controller, stage, options);
  const std::vector<generator::Cause> causes = causes_of(controller, options.errors);
  const int threads = thread_count(options.threads);
  Study out;
  out.frequencies = options.frequencies;
  out.draws = options.draws;
  const std::vector<double> nominal =
      bench.errors_percent(Board(bench.wiring(), copy_of(controller, {}, {})));
  out.percent.resize(options.draws);
  parallel_for(options.draws, threads, [&](std::size_t i) {
    const Board board(bench.wiring(), copy_of(controller, causes, draw_values(causes, options.seed, i)));
    out.percent[i] = bench.errors_percent(board);
  });
  std::vector<double> worst;
  double drawn = 0.0;
  for (std::size_t f = 0; f < nominal.size(); ++f) {
    std::vector<double> column;
    for (const std::vector<double>& one : out.percent) {
      column.push_back(one[f]);
      drawn += one[f] * one[f] - nominal[f] * nominal[f];
    }
    out.at.push_back(spread_of(std::move(column), nominal[f]));
  }
  for (const std::vector<double>& one : out.percent) worst.push_back(largest(one));
  out.worst = spread_of(std::move(worst), largest(nominal));
  const OneAtATime alone = one_at_a_time(bench, controller, causes, threads);
  take_shares(alone, causes, out);
  double explained = 0.0;
  for (const double square : alone.mean_square) explained += 1e4 * square;
  const double mean = drawn / static_cast<double>(std::max<std::size_t>(nominal.size() * options.draws, 1));
  out.explained = mean > 0.0 ? explained / mean : 0.0;
  return out;
}

std::vector<DrawCheck> check_draws(const generator::DisturbanceCircuit& controller,
                                   const tracking::Stage& stage, const StudyOptions& options, int count) {
  const Bench bench(controller, stage, options);
  const std::vector<generator::Cause> causes = causes_of(controller, options.errors);
  std::vector<DrawCheck> out(static_cast<std::size_t>(count));
  parallel_for(out.size(), thread_count(options.threads), [&](std::size_t i) {
    DrawCheck& one = out[i];
    const std::size_t f = i % bench.frequencies();
    one.draw = i;
    one.frequency = options.frequencies[f];
    const generator::Copy copy = copy_of(controller, causes, draw_values(causes, options.seed, i));
    const Board board(bench.wiring(), copy);
    generator::DisturbanceCircuit built = controller;
    const auto faster = [&](schematic::OpAmpModel& type) {
      type.gain_bandwidth.value *= 1.0 + copy.speed;
      type.slew_v_per_s *= 1.0 + copy.speed;
    };
    faster(built.opamp);
    std::ranges::for_each(built.other_opamps, faster);
    generator::NgspiceRun run = generator::NgspiceRun::of_many();
    run.off = &copy.off;
    run.samples = options.samples;
    const generator::SteadyState settled =
        generator::run_in_ngspice(built, options.reference, one.frequency, run);
    one.percent = bench.error_percent(board, f);
    const std::vector<double> y =
        stage.response(settled.v, settled.step_s, one.frequency, tracking::DriveKind::smooth);
    one.ngspice_percent =
        tracking::tracking_error(y, bench.input(f).r, settled.period_s()).rms_percent_without_lag;
    const std::vector<double> v = board.drive(bench.input(f));
    double sum = 0.0;
    for (std::size_t k = 0; k < v.size(); ++k) sum += (v[k] - settled.v[k]) * (v[k] - settled.v[k]);
    one.drive_rms_percent = 100.0 * std::sqrt(sum / static_cast<double>(v.size()));
  });
  return out;
}

}  // namespace bodesmith::tolerance
