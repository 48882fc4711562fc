#include "part_errors/trim.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/parallel_for.hpp"
#include "numeric/random.hpp"
#include "part_errors/trim_choice.hpp"

namespace bodesmith::part_errors {
namespace {

/// Someone with a voltmeter in front of one copy: sees noisy readings, turns potentiometers, knows the design.
class BlindUser {
 public:
  BlindUser(const Bench& bench, const Copy& copy, const TrimOptions& options, std::uint64_t seed)
      : bench_(bench), copy_(copy), options_(options), noise_(seed) {}

  /// The copy as it is left behind.
  Copy trim(const std::vector<TrimStep>& steps) {
    std::vector<double> settings(steps.size(), 0.0);
    for (int round = 0; round < options_.rounds; ++round) {
      for (std::size_t k = 0; k < steps.size(); ++k) turn(steps, settings, k);
    }
    return with(steps, settings);
  }

 private:
  Copy with(const std::vector<TrimStep>& steps, const std::vector<double>& settings) const {
    Copy out = copy_;
    for (std::size_t k = 0; k < steps.size(); ++k) steps[k].trim.apply(out, settings[k]);
    return out;
  }
  void turn(const std::vector<TrimStep>& steps, std::vector<double>& settings, std::size_t k) {
    const TrimStep& step = steps[k];
    const double grain = 2.0 * step.range * options_.setting_resolution;
    for (int turn = 0; turn < options_.turns; ++turn) {
      const Board board(bench_.wiring(), with(steps, settings));
      const double seen = read(step.reading, board, bench_.input(bench_.frequencies() - 1)) +
                          options_.reading_noise_v * noise_.normal();
      const double off = step.expected_v - seen;
      if (std::abs(off) < options_.reading_noise_v) return;
      double wanted = settings[k] + off / step.volts_per_setting;
      wanted = std::clamp(wanted, -step.range, step.range);
      settings[k] = grain > 0.0 ? grain * std::round(wanted / grain) : wanted;
    }
  }

  const Bench& bench_;
  const Copy& copy_;
  const TrimOptions& options_;
  Random noise_;
};

double greatest(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

}  // namespace

TrimStudy study_trims(const controller::AnalogController& controller, const tracking::Stage& stage,
                      const StudyOptions& options, const TrimOptions& trims, const Study* untrimmed) {
  TrimStudy out;
  const TrimModel model(controller, stage, options, trims.reading_noise_v);
  out.steps = model.choose(trims.trims, trims.rounds, out.foreseen_share);
  out.rounds = out.steps.size() > 1 ? trims.rounds : 1;
  const Bench bench(controller, stage, options);
  const std::vector<Cause> causes = causes_of(controller, options.errors);
  std::vector<std::vector<double>> before(trims.draws), after(trims.draws);
  parallel_for(trims.draws, thread_count(options.threads), [&](std::size_t i) {
    const Copy copy = copy_of(controller, causes, draw_values(causes, options.seed, i));
    before[i] = untrimmed != nullptr && i < untrimmed->percent.size()
                    ? untrimmed->percent[i]
                    : bench.errors_percent(Board(bench.wiring(), copy));
    BlindUser user(bench, copy, trims, mixed_bits(options.seed + Random::kGolden * (i + 1)));
    after[i] = bench.errors_percent(Board(bench.wiring(), user.trim(out.steps)));
  });
  const std::vector<double> nominal =
      bench.errors_percent(Board(bench.wiring(), copy_of(controller, {}, {})));
  std::vector<double> worst_before, worst_after;
  for (std::size_t f = 0; f < nominal.size(); ++f) {
    std::vector<double> a, b;
    for (std::size_t i = 0; i < before.size(); ++i) {
      a.push_back(before[i][f]);
      b.push_back(after[i][f]);
    }
    out.before_at.push_back(spread_of(std::move(a), nominal[f]));
    out.after_at.push_back(spread_of(std::move(b), nominal[f]));
  }
  for (std::size_t i = 0; i < before.size(); ++i) {
    worst_before.push_back(greatest(before[i]));
    worst_after.push_back(greatest(after[i]));
  }
  out.before = spread_of(std::move(worst_before), greatest(nominal));
  out.after = spread_of(std::move(worst_after), greatest(nominal));
  return out;
}

}  // namespace bodesmith::part_errors
