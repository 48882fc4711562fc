#include <fmt/format.h>

#include <algorithm>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "fpaa/gains/gain_schedule.hpp"

namespace bodesmith::fpaa {
namespace {

/// What the templates are filled with.
Json host_data(const GainSchedule& schedule, const std::string& file) {
  Json data;
  data["file"] = file;
  data["sets"] = Json::array();
  std::size_t chips = 0;
  for (const GainSet& set : schedule.sets) {
    Json packets = Json::array();
    for (const auto& [address1, bytes] : set.streams) packets.push_back({{"hex", hex_text(bytes)}});
    chips = std::max(chips, set.streams.size());
    Json gains = Json::array();
    for (std::size_t b = 0; b < set.gains.size(); ++b) {
      gains.push_back({{"branch", to_string(schedule.branches[b].branch)},
                       {"over", set.gains[b].over},
                       {"under", set.gains[b].under},
                       {"wanted", rounded_text(set.gains[b].wanted, 6)},
                       {"gain", rounded_text(set.gains[b].realised(), 6)}});
    }
    data["sets"].push_back({{"frequency", number_text(set.frequency.value)},
                            {"shown", rounded_text(set.frequency.value, 5)},
                            {"to", number_text(set.to.value)},
                            {"keep_from", number_text(set.keep_from.value)},
                            {"keep_to", number_text(set.keep_to.value)},
                            {"gains", gains},
                            {"packets", packets}});
  }
  data["set_count"] = schedule.sets.size();
  data["chip_count"] = chips;
  data["branches"] = Json::array();
  for (const GainBranch& b : schedule.branches) {
    data["branches"].push_back(
        {{"branch", to_string(b.branch)}, {"place", b.place.words}, {"at_one", rounded_text(b.at_one)}});
  }
  data["from"] = rounded_text(schedule.sets.front().frequency.value);
  data["to"] = rounded_text(schedule.sets.back().frequency.value);
  data["step"] = rounded_text(schedule.step_percent, 3);
  data["ratio_error"] = rounded_text(schedule.max_ratio_error_percent, 2);
  data["gain_error"] = rounded_text(schedule.max_gain_error_percent, 2);
  data["tracking_error"] = rounded_text(schedule.max_tracking_error_percent, 2);
  data["update_ms"] = rounded_text(1e3 * schedule.update_s, 2);
  return data;
}

}  // namespace

Json GainSchedule::to_json() const {
  Json out;
  out["branches"] = Json::array();
  for (const GainBranch& b : branches) {
    Json over = Json::array(), under = Json::array();
    for (const MemoryPlace& p : b.place.over) over.push_back({{"bank", p.bank}, {"byte", p.byte}});
    for (const MemoryPlace& p : b.place.under) under.push_back({{"bank", p.bank}, {"byte", p.byte}});
    out["branches"].push_back({{"branch", to_string(b.branch)},
                               {"place", b.place.words},
                               {"address1", b.place.address1},
                               {"over", over},
                               {"under", under},
                               {"gain_at_one", b.at_one}});
    if (b.better_at_one > 0.0) {
      out["branches"].back()["better_gain_at_one"] = b.better_at_one;
      out["branches"].back()["better_ratio_error_percent"] = b.better_error_percent;
    }
    if (b.place.fixed_under > 0) out["branches"].back()["under_units"] = b.place.fixed_under;
  }
  out["sets"] = Json::array();
  for (const GainSet& set : sets) {
    Json gains = Json::array();
    for (std::size_t b = 0; b < set.gains.size(); ++b) {
      const GainCapacitors& c = set.gains[b];
      gains.push_back({{"branch", to_string(branches[b].branch)},
                       {"wanted", c.wanted},
                       {"realised", c.realised()},
                       {"over_units", c.over},
                       {"under_units", c.under}});
    }
    out["sets"].push_back({{"frequency_hz", set.frequency.value}, {"gains", gains}});
  }
  out["error"] = {{"max_ratio_percent", max_ratio_error_percent},
                  {"max_gain_percent", max_gain_error_percent},
                  {"max_tracking_percent", max_tracking_error_percent}};
  out["update_s"] = update_s;
  return out;
}

std::string GainSchedule::csv() const {
  std::string out = "frequency_hz";
  for (const GainBranch& b : branches) {
    const std::string_view word = to_string(b.branch);
    out += fmt::format(",{0}_gain,{0}_realised,{0}_over_units,{0}_under_units", word);
  }
  out += "\n";
  for (const GainSet& set : sets) {
    out += number_text(set.frequency.value);
    for (const GainCapacitors& c : set.gains) {
      out += fmt::format(",{},{},{},{}", number_text(c.wanted), number_text(c.realised()), c.over, c.under);
    }
    out += "\n";
  }
  return out;
}

std::string gain_host_c(const GainSchedule& schedule, const std::string& file) {
  return render_template("fpaa/gain_host.c", host_data(schedule, file));
}

std::string gain_host_python(const GainSchedule& schedule, const std::string& file) {
  return render_template("fpaa/gain_host.py", host_data(schedule, file));
}

std::string gain_sheet(const GainSchedule& schedule, const std::string& file) {
  return render_template("fpaa/gains.md", host_data(schedule, file));
}

}  // namespace bodesmith::fpaa
