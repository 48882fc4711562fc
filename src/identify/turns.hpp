#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/units.hpp"
#include "hysteresis/identification.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::identify {

using hysteresis::Scaling;

/// The input from its lowest value up and back down: samples first … top … last.
struct Turn {
  std::size_t first = 0;
  std::size_t top = 0;
  std::size_t last = 0;
  double low = 0.0;   ///< of the input, at both ends
  double high = 0.0;  ///< at the top
};

/// A record of a drive that goes up and down at one frequency.
struct TurnedRecord {
  const TimeRecord* record = nullptr;
  Hertz frequency;
  std::vector<Turn> training;  ///< of the full stroke
  std::vector<Turn> held_out;  ///< of the full stroke, every second one
  std::vector<Turn> partial;   ///< of less than 97 % of it
};

/// Records of one stage, and the input's full stroke in all of them.
struct TurnedRecords {
  std::vector<TurnedRecord> all;
  Scaling input;  ///< x = input(u), 0 … 1 over the full stroke
};

/// Turns begin and end at one level (within 3 % of their height); what comes before the first and after the last is left
/// out. Of three turns or more at one height the first is left out too: a stage that starts at rest comes up another way.
/// The frequency is that of the turns, rounded to three digits where the sampling cannot tell the difference. Throws
/// InputError naming the record when there is no turn in it, or when its turns differ in length by more than 5 %.
TurnedRecords cut_into_turns(std::span<const TimeRecord> records);

}  // namespace bodesmith::identify
