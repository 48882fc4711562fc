#include <fmt/format.h>

#include <algorithm>

#include "base/documents/json.hpp"
#include "base/hertz_values.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "identify/stage_disturbance.hpp"
#include "signal/csv.hpp"

namespace bodesmith::identify {

Json StageDisturbance::to_json() const {
  Json out = disturbance.to_json();
  Json found;
  const LoopAtFrequency& base = loops.front();
  found["input"] = {{"low", -input.offset / input.gain}, {"high", (1.0 - input.offset) / input.gain}};
  found["output"] = {{"offset", base.offset}, {"stroke", base.stroke}};
  found["lag"] = {{"kind", std::string(to_string(lag.kind))},
                  {"lag_s", lag.seconds},
                  {"standard_deviation_s", lag.deviation_s}};
  found["reading"] = reading == GainReading::as_printed ? "as_printed" : "basis_times_gain";
  found["varying_branch"] = std::string(to_string(varying()));
  found["loops"] = Json::array();
  for (const LoopAtFrequency& one : loops) {
    found["loops"].push_back({{"file", one.file},
                              {"frequency_hz", one.frequency.value},
                              {"offset", one.offset},
                              {"stroke", one.stroke},
                              {"stroke_standard_deviation", one.stroke_deviation},
                              {"ascending", one.polynomial[0]},
                              {"descending", one.polynomial[1]},
                              {"gain", one.gain},
                              {"standard_deviation", one.deviation},
                              {"gain_as_printed", one.as_printed},
                              {"training_turns", one.training_turns},
                              {"held_out_turns", one.held_out_turns},
                              {"own_polynomials_percent", one.own_percent},
                              {"gain_percent", one.gain_percent},
                              {"gain_as_printed_percent", one.as_printed_percent}});
  }
  found["strokes"] = Json::array();
  for (const LoopAtStroke& one : strokes)
    found["strokes"].push_back({{"alpha", one.alpha},
                                {"gain", one.gain},
                                {"standard_deviation", one.deviation},
                                {"slope", one.slope},
                                {"line_percent", one.line_percent},
                                {"turns", one.turns}});
  found["notes"] = notes;
  out["identified"] = std::move(found);
  return out;
}

std::string StageDisturbance::gains_csv() const {
  const std::size_t branch = branch_index(varying());
  double largest_db = 0.0;
  for (const LoopAtFrequency& one : loops)
    largest_db = std::max(largest_db, to_decibel(1.0 + one.deviation[branch] / gain(one)[branch]));
  CsvWriter csv;
  csv.add("frequency_hz", hertz_values(disturbance.rate.frequency));
  csv.add("gain", disturbance.rate.of(varying()));
  return fmt::format(
             "# gains of the {} branch, relative to the lowest frequency, known to {} dB (one deviation)\n"
             "# a fit closer than {} dB follows noise: a fit of the fewest bands may stop there\n",
             to_string(varying()), rounded_text(largest_db, 2), rounded_text(largest_db, 2)) +
         csv.text();
}

}  // namespace bodesmith::identify
