#include "identify/turns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "hysteresis/record_tools.hpp"

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

}  // namespace bodesmith::identify
