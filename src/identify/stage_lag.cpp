#include "identify/stage_lag.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "hysteresis/identification/record_tools.hpp"
#include "identify/stage_model.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/optimisation/least_squares.hpp"
#include "numeric/optimisation/minimum.hpp"

namespace bodesmith::identify {
namespace {

constexpr double kSameLevel = 0.03;   ///< of a stroke
constexpr double kSameLength = 0.05;  ///< of a turn

std::vector<Turn> turns_of(const TimeRecord& record) {
  // Moves of less than 2 % of the range are noise of a drive that was measured.
  const std::vector<hysteresis::Branch> branches = hysteresis::branches(record.u, 0.02);
  std::vector<Turn> out;
  for (std::size_t i = 0; i + 1 < branches.size(); ++i) {
    if (!branches[i].rising || branches[i + 1].rising) continue;
    Turn turn{branches[i].first, branches[i].last, branches[i + 1].last, 0.0, 0.0};
    turn.low = 0.5 * (record.u[turn.first] + record.u[turn.last]);
    turn.high = record.u[turn.top];
    if (std::abs(record.u[turn.last] - record.u[turn.first]) <= kSameLevel * (turn.high - turn.low))
      out.push_back(turn);
  }
  if (out.empty())
    throw InputError(
        record.file, 0,
        "holds no turn of the input from a lowest value up and back to it, expected at least one");
  return out;
}

/// The number of three digits that the sampling cannot tell from it, or the number itself.
double as_it_was_set(double frequency_hz, double resolution) {
  const double digit = std::pow(10.0, std::floor(std::log10(frequency_hz)) - 2.0);
  const double set = std::round(frequency_hz / digit) * digit;
  return std::abs(set / frequency_hz - 1.0) <= resolution ? set : frequency_hz;
}

Hertz frequency_of(const TimeRecord& record, const std::vector<Turn>& turns) {
  double mean = 0.0;
  for (const Turn& turn : turns)
    mean += static_cast<double>(turn.last - turn.first) / static_cast<double>(turns.size());
  for (const Turn& turn : turns) {
    const auto length = static_cast<double>(turn.last - turn.first);
    if (std::abs(length - mean) > kSameLength * mean + 2.0)
      throw InputError(
          record.file, 0,
          fmt::format("its turns last from {} s on and {} s on the average, expected one frequency "
                      "a record",
                      rounded_text(length * record.step_s), rounded_text(mean * record.step_s)));
  }
  const auto samples = static_cast<double>(turns.back().last - turns.front().first);
  const double whole = std::round(samples / mean);
  return Hertz{as_it_was_set(whole / (samples * record.step_s), 2.0 / samples)};
}

/// Full strokes, less the first one where there are three or more.
void share_out(std::vector<Turn> full, TurnedRecord& to) {
  if (full.size() >= 3) full.erase(full.begin());
  for (std::size_t i = 0; i < full.size(); ++i) (i % 2 == 0 ? to.training : to.held_out).push_back(full[i]);
}

using Kind = StageLag::Kind;

/// 1/(1 + τ s) from sample to sample for an input that is straight between them, at rest under the first.
std::vector<double> behind_a_pole(const std::vector<double>& in, double step_s, double tau_s) {
  if (tau_s <= 0.0 || in.empty()) return in;
  const double h = step_s / tau_s;
  const double kept = std::exp(-h);
  const double mean = -std::expm1(-h) / h;  // of the weight e^(−t) over the step
  std::vector<double> out(in.size());
  out[0] = in[0];
  for (std::size_t i = 1; i < in.size(); ++i)
    out[i] = kept * out[i - 1] + (mean - kept) * in[i - 1] + (1.0 - mean) * in[i];
  return out;
}

double cubic(const std::array<double, 3>& a, double x) {
  return x * (a[0] + x * (a[1] + x * a[2]));
}

/// True where the input rises, every sample (bits would cost a call each); what turns within 2 % of the range is noise.
std::vector<char> rising_samples(const std::vector<double>& u) {
  std::vector<char> out(u.size(), true);
  for (const hysteresis::Branch& branch : hysteresis::branches(u, 0.02))
    std::fill(out.begin() + static_cast<std::ptrdiff_t>(branch.first),
              out.begin() + static_cast<std::ptrdiff_t>(branch.last) + 1, branch.rising);
  return out;
}

/// Residual squares of all records, each relative to its own range and samples.
double cost_of(const TurnedRecords& records, const StageLag& lag, double* samples = nullptr) {
  double out = 0.0;
  for (const TurnedRecord& one : records.all) {
    if (one.training.empty()) continue;
    const StageSolution solved =
        solve_stage(StageColumns{}.of(one, records.input, lag), *one.record, one.training);
    const double gain = solved.c(1);
    if (gain == 0.0 || solved.samples == 0) return INFINITY;
    out += solved.squares / (gain * gain) / static_cast<double>(solved.samples);
    if (samples != nullptr) *samples += static_cast<double>(solved.samples);
  }
  return out;
}

}  // namespace

TurnedRecords cut_into_turns(std::span<const TimeRecord> records) {
  TurnedRecords out;
  std::vector<std::vector<Turn>> turns;
  double widest = 0.0;
  for (const TimeRecord& record : records) {
    turns.push_back(turns_of(record));
    for (const Turn& turn : turns.back()) widest = std::max(widest, turn.high - turn.low);
  }
  double low = 0.0, high = 0.0, count = 0.0;
  for (const auto& list : turns) {
    for (const Turn& turn : list) {
      if (turn.high - turn.low <= (1.0 - kSameLevel) * widest) continue;
      low += turn.low;
      high += turn.high;
      count += 1.0;
    }
  }
  low /= count;
  high /= count;
  out.input = {1.0 / (high - low), -low / (high - low)};
  for (std::size_t i = 0; i < records.size(); ++i) {
    TurnedRecord one;
    one.record = &records[i];
    one.frequency = frequency_of(records[i], turns[i]);
    std::vector<Turn> strokes;
    for (const Turn& turn : turns[i]) {
      const bool full = turn.high - turn.low > (1.0 - kSameLevel) * widest;
      if (full && std::abs(turn.low - low) > kSameLevel * widest)
        throw InputError(
            records[i].file, 0,
            fmt::format("its full stroke begins at {}, those of the other records at {}, expected one "
                        "range of the drive",
                        rounded_text(turn.low), rounded_text(low)));
      (full ? strokes : one.partial).push_back(turn);
    }
    share_out(std::move(strokes), one);
    out.all.push_back(std::move(one));
  }
  return out;
}

Eigen::MatrixXd StageColumns::of(const TurnedRecord& turned, const Scaling& input,
                                 const StageLag& lag) const {
  const TimeRecord& record = *turned.record;
  const std::size_t n = record.size();
  std::vector<double> u = record.u;
  for (double& value : u) value = (input(value) - origin) / stroke;
  std::vector<char> rising = rising_samples(u);
  if (lag.kind == Kind::amplifier) {
    const std::vector<double> late = behind_a_pole(u, record.step_s, lag.seconds);
    for (std::size_t i = 0; i < n; ++i) rising[i] = u[i] > late[i] || (u[i] == late[i] && rising[i]);
    u = late;
  }
  Eigen::MatrixXd out(eigen_index(n), kCount);
  const double middle = 0.5 * static_cast<double>(n - 1);
  const auto put = [&](Eigen::Index column, std::vector<double> values) {
    if (lag.kind == Kind::delay) values = later_by(values, lag.seconds / record.step_s);
    if (lag.kind == Kind::sensor) values = behind_a_pole(values, record.step_s, lag.seconds);
    for (std::size_t i = 0; i < n; ++i) out(eigen_index(i), column) = values[i];
  };
  put(1, u);
  for (std::size_t k = 0; k < 2; ++k) {
    std::vector<double> up(n, 0.0), down(n, 0.0);
    for (std::size_t i = 0; i < n; ++i)
      (rising[i] ? up : down)[i] = cubic(rising[i] ? ascending[k] : descending[k], u[i]);
    put(2 + eigen_index(k), std::move(up));
    put(4 + eigen_index(k), std::move(down));
  }
  for (std::size_t i = 0; i < n; ++i) {
    out(eigen_index(i), 0) = 1.0;
    out(eigen_index(i), 6) = (static_cast<double>(i) - middle) / std::max(middle, 1.0);
  }
  return out;
}

StageSolution solve_stage(const Eigen::MatrixXd& columns, const TimeRecord& record,
                          std::span<const Turn> turns) {
  std::size_t rows = 0;
  for (const Turn& turn : turns) rows += turn.last - turn.first;
  const Eigen::Index used = turns.size() > 1 ? StageColumns::kCount : StageColumns::kCount - 1;
  Eigen::MatrixXd a(eigen_index(rows), used);
  Eigen::VectorXd y(eigen_index(rows));
  Eigen::Index row = 0;
  for (const Turn& turn : turns) {
    for (std::size_t i = turn.first; i < turn.last; ++i, ++row) {
      a.row(row) = columns.row(eigen_index(i)).head(used);
      y(row) = record.y[i];
    }
  }
  const Eigen::MatrixXd normal = gram(a);
  StageSolution out;
  out.samples = rows;
  const Eigen::VectorXd c = solve_ldlt(normal, transpose_times(a, y));
  const Eigen::VectorXd residual = times(a, c) - y;
  out.squares = residual.squaredNorm();
  out.c = Eigen::VectorXd::Zero(StageColumns::kCount);
  out.deviation = Eigen::VectorXd::Zero(StageColumns::kCount);
  out.c.head(used) = c;
  out.deviation.head(used) = parameter_deviation(normal, residual);
  return out;
}

double StageSolution::rms(const Eigen::MatrixXd& columns, const Eigen::VectorXd& values,
                          const TimeRecord& record, std::span<const Turn> turns) {
  const Eigen::VectorXd got = times(columns, values);
  double sum = 0.0, count = 0.0;
  for (const Turn& turn : turns) {
    for (std::size_t i = turn.first; i < turn.last; ++i, count += 1.0) {
      const double error = got(eigen_index(i)) - record.y[i];
      sum += error * error;
    }
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

StageLag find_lag(const TurnedRecords& records) {
  double fastest = 0.0;
  for (const TurnedRecord& one : records.all)
    if (!one.training.empty()) fastest = std::max(fastest, one.frequency.value);
  const double longest = 0.1 / fastest;
  double samples = 0.0;
  const double without = cost_of(records, {}, &samples);
  StageLag best;
  double least = without;
  for (const Kind kind : {Kind::delay, Kind::sensor, Kind::amplifier}) {
    const auto cost = [&](double seconds) { return cost_of(records, {kind, seconds, 0.0}); };
    // A coarse look first: of a loop with noise the cost may have more than one dip.
    constexpr int kLooks = 12;
    int at = 0;
    double dip = without;
    for (int i = 1; i <= kLooks; ++i) {
      const double here = cost(longest * i / kLooks);
      if (!(here < dip)) continue;
      dip = here;
      at = i;
    }
    const double low = longest * std::max(at - 1, 0) / kLooks;
    const double high = longest * std::min(at + 1, kLooks) / kLooks;
    const double seconds = minimum_between(low, high, 1e-5 * longest, cost);
    const double left = cost(seconds);
    if (!(left < least)) continue;
    // Cost is a mean of squares: its second difference tells how sharp the dip is.
    const double step = std::max(0.05 * seconds, 1e-4 * longest);
    const double curvature =
        (cost(seconds + step) - 2.0 * left + cost(std::max(seconds - step, 0.0))) / (step * step);
    StageLag found{kind, seconds, INFINITY};
    if (curvature > 0.0) found.deviation_s = std::sqrt(2.0 * left / (curvature * samples));
    if (seconds <= 3.0 * found.deviation_s) continue;
    best = found;
    least = left;
  }
  return best;
}

}  // namespace bodesmith::identify
