#include <algorithm>
#include <cmath>
#include <vector>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/lu.hpp"
#include "numeric/parallel_for.hpp"
#include "numeric/random.hpp"
#include "tolerance/controller/trim.hpp"

namespace bodesmith::tolerance {
namespace {

/// The linear model of a controller's errors: what each cause (at one standard deviation) and each trim (at one
/// unit_setting) moves the tracking error's waveforms and the readings by.
class TrimModel {
 public:
  TrimModel(const generator::DisturbanceCircuit& controller, const tracking::Stage& stage,
            const StudyOptions& options, double reading_noise_v);

  /// Trims with readings, in the order in which turning one after the other settles fastest. `foreseen`: share of
  /// the mean square left after none, one, two, … of them.
  std::vector<TrimStep> choose(int count, int rounds, std::vector<double>& foreseen) const;

 private:
  struct Pick {
    std::size_t trim = 0, reading = 0;
  };
  double left(const std::vector<Pick>& picks) const;
  /// How far from settled the readings are after so many rounds, 0: settled.
  double unsettled(const std::vector<Pick>& picks, int rounds) const;
  double left_settled(std::vector<Pick> picks, int rounds, double bound) const;
  bool refine(std::vector<Pick>& picks, int rounds, double& best) const;
  bool usable(const std::vector<Pick>& picks, std::size_t except, std::size_t trim,
              std::size_t reading) const;
  /// The order and the giving of readings to trims that has settled best, and how well.
  double put_in_order(std::vector<Pick>& picks, int rounds) const;
  std::vector<double> settings(const std::vector<Pick>& picks, const std::vector<double>& readings) const;

  std::vector<Trim> trims_;
  std::vector<Reading> readings_;
  std::vector<double> expected_v_;
  double noise_v_;
  std::size_t causes_ = 0;
  std::vector<std::vector<double>> gram_;   ///< waveforms of causes, then trims
  std::vector<std::vector<double>> moved_;  ///< [cause or trim][reading]
};

/// An improvement that is not worth a step more.
constexpr double kWorth = 0.97;
/// Readings that are still off by more than this share of where they began, after all rounds, are not settled.
constexpr double kSettled = 0.05;

std::vector<Reading> all_readings(bool slope) {
  using Kind = Reading::Kind;
  std::vector<Reading> out;
  for (const double r : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    for (const Kind kind : {Kind::mean, Kind::rising, Kind::falling, Kind::difference})
      out.push_back({kind, r});
  }
  if (slope) out.push_back({Kind::slope, 0.0});
  return out;
}

TrimModel::TrimModel(const generator::DisturbanceCircuit& controller, const tracking::Stage& stage,
                     const StudyOptions& options, double reading_noise_v)
    : trims_(trims_of(controller)),
      readings_(all_readings(controller.slope.has_value())),
      noise_v_(reading_noise_v) {
  StudyOptions coarse = options;
  coarse.samples = 64;
  const Bench bench(controller, stage, coarse);
  const std::vector<generator::Cause> causes = causes_of(controller, options.errors);
  causes_ = causes.size();
  const Input& fastest = bench.input(bench.frequencies() - 1);
  const auto see = [&](const Board& board, std::vector<double>& waves, std::vector<double>& readings) {
    for (std::size_t f = 0; f < bench.frequencies(); ++f) {
      const std::vector<double> y = bench.displacement(board, f);
      waves.insert(waves.end(), y.begin(), y.end());
    }
    for (const Reading& one : readings_) readings.push_back(read(one, board, fastest));
  };
  std::vector<double> good;
  const Board nominal(bench.wiring(), copy_of(controller, {}, {}));
  see(nominal, good, expected_v_);
  const std::size_t columns = causes_ + trims_.size();
  std::vector<std::vector<double>> waves(columns);
  moved_.resize(columns);
  parallel_for(columns, thread_count(options.threads), [&](std::size_t i) {
    generator::Copy copy = copy_of(controller, {}, {});
    if (i < causes_) {
      causes[i].apply(copy, causes[i].departure.deviation());
    } else {
      trims_[i - causes_].apply(copy, trims_[i - causes_].unit_setting);
    }
    see(Board(bench.wiring(), copy, &nominal), waves[i], moved_[i]);
    for (std::size_t k = 0; k < good.size(); ++k) waves[i][k] -= good[k];
    for (std::size_t k = 0; k < expected_v_.size(); ++k) moved_[i][k] -= expected_v_[k];
    std::vector<double> all;
    for (std::size_t f = 0, at = 0; f < bench.frequencies(); ++f) {
      const std::vector<double>& r = bench.input(f).r;
      std::vector<double> one(waves[i].begin() + static_cast<std::ptrdiff_t>(at),
                              waves[i].begin() + static_cast<std::ptrdiff_t>(at + r.size()));
      one = without_lag(std::move(one), r);
      all.insert(all.end(), one.begin(), one.end());
      at += r.size();
    }
    waves[i] = std::move(all);
  });
  gram_.assign(columns, std::vector<double>(columns, 0.0));
  for (std::size_t i = 0; i < columns; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      double sum = 0.0;
      for (std::size_t j = 0; j < waves[i].size(); ++j) sum += waves[i][j] * waves[k][j];
      gram_[i][k] = gram_[k][i] = sum;
    }
  }
}

/// Settings that put the picked readings right; empty when they cannot.
std::vector<double> TrimModel::settings(const std::vector<Pick>& picks,
                                        const std::vector<double>& readings) const {
  constexpr double kNearlySingular = 1e-6;
  const auto n = eigen_index(picks.size());
  Eigen::MatrixXd a(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      a(i, j) = moved_[causes_ + picks[std_index(j)].trim][picks[std_index(i)].reading];
  }
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(a);
  if (!(lu.matrixLU().diagonal().cwiseAbs().minCoeff() > kNearlySingular * a.cwiseAbs().maxCoeff()))
    return {};
  std::vector<double> out(picks.size());
  as_eigen(out) = -lu.solve(as_eigen(readings));
  return out;
}

/// Sum over the causes of |e_i + sum_k p_k t_k|^2, and what noise in the readings adds.
double TrimModel::left(const std::vector<Pick>& picks) const {
  double out = 0.0;
  std::vector<double> square(picks.size(), 0.0);
  const auto add = [&](const std::vector<double>& p, std::size_t cause, bool alone) {
    if (!alone) out += gram_[cause][cause];
    for (std::size_t k = 0; k < picks.size(); ++k) {
      const std::size_t t = causes_ + picks[k].trim;
      if (!alone) out += 2.0 * p[k] * gram_[cause][t];
      for (std::size_t j = 0; j < picks.size(); ++j) out += p[k] * p[j] * gram_[t][causes_ + picks[j].trim];
    }
  };
  for (std::size_t i = 0; i < causes_; ++i) {
    std::vector<double> readings, p;
    for (const Pick& one : picks) readings.push_back(moved_[i][one.reading]);
    if (!picks.empty()) p = settings(picks, readings);
    if (p.size() != picks.size()) return 1e300;
    add(p, i, false);
    for (std::size_t k = 0; k < picks.size(); ++k) square[k] += p[k] * p[k];
  }
  // Three standard deviations of what copies need must be within reach.
  for (std::size_t k = 0; k < picks.size(); ++k) {
    const Trim& trim = trims_[picks[k].trim];
    if (3.0 * std::sqrt(square[k]) * trim.unit_setting > trim.limit) return 1e300;
  }
  for (std::size_t k = 0; k < picks.size(); ++k) {
    std::vector<double> readings(picks.size(), 0.0);
    readings[k] = noise_v_;
    add(settings(picks, readings), 0, true);
  }
  return out;
}

bool TrimModel::usable(const std::vector<Pick>& picks, std::size_t except, std::size_t trim,
                       std::size_t reading) const {
  for (std::size_t k = 0; k < picks.size(); ++k) {
    if (k != except && (picks[k].trim == trim || picks[k].reading == reading)) return false;
  }
  return true;
}

/// What is left, beyond all bounds when turning one after the other does not settle in whatever order.
double TrimModel::left_settled(std::vector<Pick> picks, int rounds, double bound) const {
  const double value = left(picks);
  if (!(value < bound)) return value;
  return put_in_order(picks, rounds) <= kSettled ? value : 1e300;
}

/// The best other trim and reading for one place; true when it is better.
bool TrimModel::refine(std::vector<Pick>& picks, int rounds, double& best) const {
  bool better = false;
  for (std::size_t k = 0; k < picks.size(); ++k) {
    std::vector<Pick> trial = picks;
    for (std::size_t t = 0; t < trims_.size(); ++t) {
      for (std::size_t r = 0; r < readings_.size(); ++r) {
        if (!usable(picks, k, t, r)) continue;
        trial[k] = {t, r};
        const double value = left_settled(trial, rounds, best * (1.0 - 1e-9));
        if (!(value < best * (1.0 - 1e-9))) continue;
        best = value;
        picks[k] = trial[k];
        better = true;
      }
    }
  }
  return better;
}

double TrimModel::unsettled(const std::vector<Pick>& picks, int rounds) const {
  // From a copy whose picked readings are each a standard deviation off, in turn.
  double out = 0.0;
  for (std::size_t start = 0; start < picks.size(); ++start) {
    std::vector<double> m(picks.size(), 0.0);
    m[start] = 1.0;
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t k = 0; k < picks.size(); ++k) {
        const std::vector<double>& by = moved_[causes_ + picks[k].trim];
        if (by[picks[k].reading] == 0.0) return 1e300;
        const double p = -m[k] / by[picks[k].reading];
        for (std::size_t j = 0; j < picks.size(); ++j) m[j] += p * by[picks[j].reading];
      }
    }
    for (const double value : m) out = std::max(out, std::abs(value));
  }
  return out;
}

/// All orders and all ways to give the readings to the trims: the one that has settled best.
double TrimModel::put_in_order(std::vector<Pick>& picks, int rounds) const {
  std::vector<std::size_t> order(picks.size()), given(picks.size());
  for (std::size_t k = 0; k < picks.size(); ++k) order[k] = given[k] = k;
  std::vector<Pick> best = picks;
  double least = 1e301;
  do {
    std::ranges::sort(given);
    do {
      std::vector<Pick> trial;
      for (std::size_t k = 0; k < picks.size(); ++k)
        trial.push_back({picks[order[k]].trim, picks[given[k]].reading});
      const double value = unsettled(trial, rounds);
      if (value < least * (1.0 - 1e-9)) {
        least = value;
        best = trial;
      }
    } while (std::next_permutation(given.begin(), given.end()));
  } while (std::next_permutation(order.begin(), order.end()));
  picks = best;
  return least;
}

std::vector<TrimStep> TrimModel::choose(int count, int rounds, std::vector<double>& foreseen) const {
  std::vector<Pick> picks;
  const double none = left({});
  foreseen = {1.0};
  if (!(none > 0.0)) return {};
  double best = none;
  while (static_cast<int>(picks.size()) < count) {
    std::vector<Pick> trial = picks;
    trial.push_back({});
    double value = 1e300;
    Pick first;
    for (std::size_t t = 0; t < trims_.size(); ++t) {
      for (std::size_t r = 0; r < readings_.size(); ++r) {
        if (!usable(picks, picks.size(), t, r)) continue;
        trial.back() = {t, r};
        const double here = left_settled(trial, rounds, value);
        if (here < value) {
          value = here;
          first = trial.back();
        }
      }
    }
    trial.back() = first;
    for (int i = 0; i < 4 && refine(trial, rounds, value); ++i) {
    }
    if (!(value < kWorth * best)) break;
    picks = trial;
    best = value;
    foreseen.push_back(value / none);
  }
  put_in_order(picks, rounds);
  std::vector<TrimStep> out;
  for (std::size_t k = 0; k < picks.size(); ++k) {
    const Trim& trim = trims_[picks[k].trim];
    const double by = moved_[causes_ + picks[k].trim][picks[k].reading];
    out.push_back({trim, readings_[picks[k].reading], expected_v_[picks[k].reading], by / trim.unit_setting,
                   trim.limit});
  }
  return out;
}

/// Someone with a voltmeter in front of one copy: sees noisy readings, turns potentiometers, knows the design.
class BlindUser {
 public:
  /// `untrimmed`: that copy's board.
  BlindUser(const Bench& bench, const generator::Copy& copy, const Board& untrimmed,
            const TrimOptions& options, std::uint64_t seed)
      : bench_(bench), copy_(copy), untrimmed_(untrimmed), options_(options), noise_(seed) {}

  /// The board as it is left behind.
  Board trim(const std::vector<TrimStep>& steps) {
    std::vector<double> settings(steps.size(), 0.0);
    for (int round = 0; round < options_.rounds; ++round) {
      for (std::size_t k = 0; k < steps.size(); ++k) turn(steps, settings, k);
    }
    return with(steps, settings);
  }

 private:
  Board with(const std::vector<TrimStep>& steps, const std::vector<double>& settings) const {
    generator::Copy trimmed = copy_;
    for (std::size_t k = 0; k < steps.size(); ++k) steps[k].trim.apply(trimmed, settings[k]);
    return Board(bench_.wiring(), trimmed, &untrimmed_);
  }
  void turn(const std::vector<TrimStep>& steps, std::vector<double>& settings, std::size_t k) {
    const TrimStep& step = steps[k];
    const double grain = 2.0 * step.range * options_.setting_resolution;
    for (int turn = 0; turn < options_.turns; ++turn) {
      const double seen = read(step.reading, with(steps, settings), bench_.input(bench_.frequencies() - 1)) +
                          options_.reading_noise_v * noise_.normal();
      const double off = step.expected_v - seen;
      if (std::abs(off) < options_.reading_noise_v) return;
      double wanted = settings[k] + off / step.volts_per_setting;
      wanted = std::clamp(wanted, -step.range, step.range);
      settings[k] = grain > 0.0 ? grain * std::round(wanted / grain) : wanted;
    }
  }

  const Bench& bench_;
  const generator::Copy& copy_;
  const Board& untrimmed_;
  const TrimOptions& options_;
  Random noise_;
};

double greatest(const std::vector<double>& values) {
  return *std::ranges::max_element(values);
}

}  // namespace

TrimStudy study_trims(const generator::DisturbanceCircuit& controller, const tracking::Stage& stage,
                      const StudyOptions& options, const TrimOptions& trims, const Study* untrimmed) {
  TrimStudy out;
  const TrimModel model(controller, stage, options, trims.reading_noise_v);
  out.steps = model.choose(trims.trims, trims.rounds, out.foreseen_share);
  out.rounds = out.steps.size() > 1 ? trims.rounds : 1;
  const Bench bench(controller, stage, options);
  const std::vector<generator::Cause> causes = causes_of(controller, options.errors);
  std::vector<std::vector<double>> before(trims.draws), after(trims.draws);
  parallel_for(trims.draws, thread_count(options.threads), [&](std::size_t i) {
    const generator::Copy copy = copy_of(controller, causes, draw_values(causes, options.seed, i));
    const Board board(bench.wiring(), copy);
    before[i] = untrimmed != nullptr && i < untrimmed->percent.size() ? untrimmed->percent[i]
                                                                      : bench.errors_percent(board);
    BlindUser user(bench, copy, board, trims, mixed_bits(options.seed + Random::kGolden * (i + 1)));
    after[i] = bench.errors_percent(user.trim(out.steps));
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

}  // namespace bodesmith::tolerance
