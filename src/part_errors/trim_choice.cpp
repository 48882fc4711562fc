#include "part_errors/trim_choice.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/parallel_for.hpp"

namespace bodesmith::part_errors {
namespace {

/// An improvement that is not worth a step more.
constexpr double kWorth = 0.97;
/// Readings that are still off by more than this share of where they began, after all rounds, are not settled.
constexpr double kSettled = 0.05;

/// x with a x = b, by elimination with pivots; false when a is nearly singular.
bool solve_small(std::vector<std::vector<double>> a, std::vector<double>& b) {
  const std::size_t n = b.size();
  double greatest = 0.0;
  for (const auto& row : a)
    for (const double value : row) greatest = std::max(greatest, std::abs(value));
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    if (!(std::abs(a[pivot][k]) > 1e-6 * greatest)) return false;
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return true;
}

/// Without what a delay of r would make.
void remove_lag(std::vector<double>& e, const std::vector<double>& r) {
  const std::size_t n = e.size();
  double along = 0.0, slopes = 0.0;
  const auto slope = [&](std::size_t i) { return r[(i + 1) % n] - r[(i + n - 1) % n]; };
  for (std::size_t i = 0; i < n; ++i) {
    along += e[i] * slope(i);
    slopes += slope(i) * slope(i);
  }
  if (!(slopes > 0.0)) return;
  for (std::size_t i = 0; i < n; ++i) e[i] -= along / slopes * slope(i);
}

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

}  // namespace

TrimModel::TrimModel(const controller::AnalogController& controller, const tracking::Stage& stage,
                     const StudyOptions& options, double reading_noise_v)
    : trims_(trims_of(controller)),
      readings_(all_readings(controller.slope.has_value())),
      noise_v_(reading_noise_v) {
  StudyOptions coarse = options;
  coarse.samples = 64;
  const Bench bench(controller, stage, coarse);
  const std::vector<Cause> causes = causes_of(controller, options.errors);
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
  see(Board(bench.wiring(), copy_of(controller, {}, {})), good, expected_v_);
  const std::size_t columns = causes_ + trims_.size();
  std::vector<std::vector<double>> waves(columns);
  moved_.resize(columns);
  parallel_for(columns, thread_count(options.threads), [&](std::size_t i) {
    Copy copy = copy_of(controller, {}, {});
    if (i < causes_) {
      causes[i].apply(copy, causes[i].deviation);
    } else {
      trims_[i - causes_].apply(copy, trims_[i - causes_].unit_setting);
    }
    see(Board(bench.wiring(), copy), waves[i], moved_[i]);
    for (std::size_t k = 0; k < good.size(); ++k) waves[i][k] -= good[k];
    for (std::size_t k = 0; k < expected_v_.size(); ++k) moved_[i][k] -= expected_v_[k];
    std::vector<double> all;
    for (std::size_t f = 0, at = 0; f < bench.frequencies(); ++f) {
      const std::vector<double>& r = bench.input(f).r;
      std::vector<double> one(waves[i].begin() + static_cast<std::ptrdiff_t>(at),
                              waves[i].begin() + static_cast<std::ptrdiff_t>(at + r.size()));
      remove_lag(one, r);
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
  std::vector<std::vector<double>> a;
  for (const Pick& row : picks) {
    std::vector<double> line;
    for (const Pick& column : picks) line.push_back(moved_[causes_ + column.trim][row.reading]);
    a.push_back(std::move(line));
  }
  std::vector<double> b;
  for (const double value : readings) b.push_back(-value);
  if (!solve_small(std::move(a), b)) return {};
  return b;
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
    std::sort(given.begin(), given.end());
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

}  // namespace bodesmith::part_errors
