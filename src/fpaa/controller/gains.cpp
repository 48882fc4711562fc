#include "fpaa/controller/gains.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "fpaa/controller/io.hpp"
#include "fpaa/controller/scale.hpp"
#include "fpaa/device/memory_image.hpp"
#include "fpaa/streams/stream_output.hpp"
#include "signal/csv.hpp"

namespace bodesmith::fpaa {
namespace {

using an231::PlanStreams;

/// What to do and to read when the board is switched on for the first time.
std::string power_on_text(const ControllerVariant& variant, const Disturbance& disturbance,
                          const ControllerStreams& streams) {
  using enum Disturbance::Branch;
  Json data = {{"status", an231::kStreamStatus},
               {"scale_v", rounded_text(variant.scale.volts_per_stroke)},
               {"pins", Json::array()},
               {"readings", Json::array()},
               {"multipliers", variant.by == PolynomialBy::outside},
               {"tables", variant.by == PolynomialBy::lookup},
               {"warnings", streams.warnings}};
  const auto signals = pin_signals(variant);
  const auto cell_of = [&](const std::string& pin) {
    return fmt::format("{} IO{}", pin.substr(0, pin.find('.')), streams.cells.at(pin));
  };
  std::map<std::string, std::string> wired;  // from chip to chip
  for (const Wire& wire : controller_plan(variant).wires) {
    if (streams.cells.count(wire.from) == 0 || streams.cells.count(wire.to) == 0) continue;
    wired[wire.to] = "wired to " + cell_of(wire.from);
    wired.try_emplace(wire.from, "wired to " + cell_of(wire.to));
  }
  for (const auto& [pin, cell] : streams.cells) {
    const auto signal = signals.find(pin);
    const auto wire = wired.find(pin);
    const std::string inside = wire == wired.end() ? pin : wire->second;
    data["pins"].push_back(
        {{"cell", cell_of(pin)}, {"signal", signal == signals.end() ? inside : signal->second}});
  }
  for (const double r : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const auto volts = [&](double x) { return fmt::format("{:.3f}", variant.scale.volts(x)); };
    data["readings"].push_back({{"r", volts(r)},
                                {"up", volts(settled_drive(disturbance, ascending, 1.0, r))},
                                {"down", volts(settled_drive(disturbance, descending, 1.0, r))}});
  }
  return render_template("fpaa/controller_power_on.md", data);
}

}  // namespace

Hertz serving_frequency(const std::vector<Hertz>& sets, Hertz operating) {
  const auto distance = [&](Hertz f) { return std::abs(std::log(f.value / operating.value)); };
  const auto at = std::ranges::min_element(sets, [&](Hertz a, Hertz b) { return distance(a) < distance(b); });
  return at == sets.end() ? operating : *at;
}

std::string gain_sets_csv(const ControllerVariant& variant, const Disturbance& disturbance) {
  std::vector<std::string> columns = {"frequency_hz"};
  for (const ControllerCam& cam : variant.cams) {
    if (!cam.scheduled) continue;
    for (const Capacitor& c : cam.capacitors) columns.push_back(fmt::format("{}_{}_units", cam.name, c.name));
  }
  if (columns.size() == 1) return {};
  CsvTable out(columns);
  for (const Hertz f : gain_set_frequencies(disturbance)) {
    std::vector<std::string> row = {number_text(f.value)};
    for (const ControllerCam& cam : variant.at(disturbance, f).cams) {
      if (!cam.scheduled) continue;
      for (const Capacitor& c : cam.capacitors) row.push_back(std::to_string(c.units));
    }
    out.add_row(row);
  }
  return out.text();
}

Outcome<ControllerStreams> controller_streams(const ControllerVariant& variant,
                                              const Disturbance& disturbance) {
  std::vector<PlanStreams> sets;
  std::vector<Hertz> frequencies = gain_set_frequencies(disturbance);
  if (frequencies.empty()) frequencies = {{1.0}};
  for (const Hertz f : frequencies) {
    const auto made = an231::plan_streams(controller_plan(variant.at(disturbance, f)));
    if (const Refusal* refusal = refusal_of(made)) return *refusal;
    sets.push_back(std::get<PlanStreams>(made));
  }
  ControllerStreams out;
  const PlanStreams& base = sets.front();
  out.warnings = base.warnings;
  out.cells = base.cells;
  out.files = an231::configuration_files(base, "controller.json");
  out.sets = sets.size() > 1 ? sets.size() : 0;
  for (std::size_t c = 0; c < base.chips.size(); ++c) {
    const PlanStreams::Chip& chip = base.chips[c];
    std::map<MemoryPlace, int> places;  // that differ in one of the sets
    for (const PlanStreams& set : sets) places.merge(changed_bytes(chip.memory, set.chips[c].memory));
    if (places.empty()) continue;
    for (std::size_t i = 0; i < sets.size(); ++i) {
      for (auto& [place, value] : places) value = sets[i].chips[c].memory.at(place.bank, place.byte);
      const Bytes bytes = encode(update_of(chip.chip, places));
      out.files.add(fmt::format("updates/set{:03}_address{}.ahf", i, chip.chip), to_ahf(bytes));
      out.files.add(fmt::format("updates/set{:03}_address{}.bin", i, chip.chip), to_packet(bytes, false));
    }
  }
  out.files.add("first_power_on.md", power_on_text(variant, disturbance, out));
  return out;
}

}  // namespace bodesmith::fpaa
