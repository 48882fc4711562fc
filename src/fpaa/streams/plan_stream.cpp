#include "fpaa/streams/plan_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/streams/lookup_stage.hpp"

namespace bodesmith::fpaa::an231 {
namespace {

constexpr int kLargestStreamDivisor = 510;

/// Divisor of ACLK that a CAM's clock is made with.
int total_divisor(const PlacedCam& cam, const ChipPlan& chip) {
  return nearest_whole<int>(chip.master_clock.value / cam.clock_a.value);
}

/// One plan as chips that are still to be placed.
class PlanReader {
 public:
  PlanReader(const Plan& plan, const PlanStreamOptions& options) : plan_(plan), options_(options) {}

  Outcome<std::vector<WantedChip>> read() {
    for (const ChipPlan& chip : plan_.chips) {
      if (auto refusal = read_chip(chip)) return *refusal;
    }
    if (auto refusal = read_wires()) return *refusal;
    return std::move(out_);
  }
  std::vector<std::string> warnings() const { return warnings_; }

 private:
  std::optional<Refusal> read_chip(const ChipPlan& chip) {
    WantedChip out;
    out.address1 = chip.chip;
    for (const PlacedCam& cam : chip.cams) {
      const std::string name = fmt::format("chip{}.{}", chip.chip, cam.name);
      if (cam.cam == &transfer_function_cam()) {
        if (!cam.requested.number("cout")) {
          return Refusal{fmt::format("{} has no look-up table, expected one (table_hex and cout)", name)};
        }
        out.stages.push_back(lookup_stage(name, cam));
        continue;
      }
      auto switches = cam.cam->switches(cam);
      if (!switches) {
        return Refusal{
            fmt::format("{} is a {}, whose switches are not publicly known; expected CAMs of known "
                        "topology for a stream (update streams for a project of your own still work)",
                        name, cam.cam_name())};
      }
      WantedStage stage{name, std::move(*switches), cam.cab, cam.clock_index, {}};
      stage.inputs.resize(cam.input_count());
      out.stages.push_back(std::move(stage));
    }
    if (auto refusal = read_clocks(chip, out)) return refusal;
    out_.push_back(std::move(out));
    return std::nullopt;
  }

  /// Its output stands in phase 1 and is 0 in phase 2.
  static WantedStage lookup_stage(const std::string& name, const PlacedCam& cam) {
    WantedStage out;
    out.name = name;
    out.cab = cam.cab;
    out.clock = cam.clock_index;
    out.lookup = LookupTable::from(cam.requested);
    out.switches.opamps = {{.reset_phase = 2}};
    out.switches.output_phase = 1;
    out.inputs.resize(1);
    return out;
  }

  /// Both system divisors are the same, the smallest that lets every clock be made.
  std::optional<Refusal> read_clocks(const ChipPlan& chip, WantedChip& out) {
    std::map<int, int> totals;
    for (const PlacedCam& cam : chip.cams) {
      const int total = total_divisor(cam, chip);
      const double off = std::abs(chip.master_clock.value / total / cam.clock_a.value - 1.0);
      const auto [at, fresh] = totals.try_emplace(cam.clock_index, total);
      if (off > 1e-9 || (!fresh && at->second != total)) {
        return Refusal{fmt::format("chip {}: Clock {} cannot be {} Hz for {}", chip.chip, cam.clock_index,
                                   rounded_text(cam.clock_a.value, 8), cam.name)};
      }
      if (auto refusal = add_converter_clock(chip, cam, total, totals)) return refusal;
    }
    std::vector<std::int64_t> all;
    for (const auto& [clock, total] : totals) all.push_back(total);
    if (const std::optional<int> system = common_system_divisor(all)) {
      out.system_divisor = *system;
      for (const auto& [clock, total] : totals) out.clock_divisors[clock] = total / *system;
      warn_of_system_divisor(chip, *system, totals);
      return std::nullopt;
    }
    return Refusal{fmt::format(
        "chip {}: no one system divisor makes all of its clocks ({} Hz), and which of two feeds a chip clock is not "
        "publicly known; expected clocks from {} Hz up, which need none, or none more than "
        "{} times as fast as another",
        chip.chip, clock_list(chip, totals), rounded_text(chip.master_clock.value / kLargestStreamDivisor, 6),
        kLargestStreamDivisor)};
  }

  static std::string clock_list(const ChipPlan& chip, const std::map<int, int>& totals) {
    std::vector<std::string> out;
    for (const auto& [clock, total] : totals) out.push_back(rounded_text(chip.master_clock.value / total, 6));
    return join(out, ", ");
  }

  /// The converter's clock, 16 times that of its CAM.
  std::optional<Refusal> add_converter_clock(const ChipPlan& chip, const PlacedCam& cam, int total,
                                             std::map<int, int>& totals) const {
    if (cam.cam != &transfer_function_cam()) return std::nullopt;
    const bool divides = total % kLookupClockRatio == 0;
    const auto [at, fresh] = totals.try_emplace(kLookupFastClock, total / kLookupClockRatio);
    if (divides && (fresh || at->second * kLookupClockRatio == total)) return std::nullopt;
    return Refusal{fmt::format(
        "chip {}: {} needs Clock {} at {} Hz for its converter, which another CAM has or the "
        "master clock does not give",
        chip.chip, cam.name, kLookupFastClock, rounded_text(kLookupClockRatio * cam.clock_a.value, 8))};
  }

  void warn_of_system_divisor(const ChipPlan& chip, int system, const std::map<int, int>& totals) {
    if (system == 1) return;
    int slowest = 1;
    for (const auto& [clock, total] : totals) slowest = std::max(slowest, total);
    warnings_.push_back(fmt::format(
        "chip {}: its slowest clock, {} Hz, lies below {} Hz, so the system clocks are divided by {} (both: which "
        "of them feeds a chip clock is not known). No public stream does that; should the coding differ, every "
        "clock and corner is off by one common factor, which a scope shows.",
        chip.chip, rounded_text(chip.master_clock.value / slowest, 6),
        rounded_text(chip.master_clock.value / kLargestStreamDivisor, 6), system));
  }

  WantedChip* chip_of(int number) {
    const auto at =
        std::find_if(out_.begin(), out_.end(), [&](const WantedChip& c) { return c.address1 == number; });
    return at == out_.end() ? nullptr : &*at;
  }

  std::optional<std::size_t> stage_of(const WantedChip& chip, const std::string& end) const {
    for (std::size_t i = 0; i < chip.stages.size(); ++i) {
      if (chip.stages[i].name == end) return i;
    }
    return std::nullopt;
  }

  std::optional<Refusal> read_wires() {
    std::set<std::string> inputs;
    for (const Wire& wire : plan_.wires) {
      for (const std::string& end : {wire.from, wire.to}) {
        if (WireEnd(end).is_input_pin()) inputs.insert(end);
      }
    }
    for (const std::string& pin : inputs) {
      const WireEnd end(pin);
      if (WantedChip* chip = chip_of(end.chip)) chip->inputs.push_back(end.name);
    }
    for (const Wire& wire : plan_.wires) {
      if (auto refusal = read_wire(wire)) return refusal;
    }
    for (const auto& [pin, cell] : options_.cells) {
      const WireEnd end(pin);
      WantedChip* chip = chip_of(end.chip);
      if (chip == nullptr || !has_pin(*chip, end.name)) {
        return Refusal{fmt::format("an I/O cell is asked for {}, which is no pin of the plan", pin)};
      }
      chip->cells[end.name] = cell;
    }
    return std::nullopt;
  }

  static bool has_pin(const WantedChip& chip, const std::string& name) {
    const bool in = std::find(chip.inputs.begin(), chip.inputs.end(), name) != chip.inputs.end();
    return in || std::any_of(chip.outputs.begin(), chip.outputs.end(),
                             [&](const WantedPin& pin) { return pin.name == name; });
  }

  std::optional<Refusal> read_wire(const Wire& wire) {
    const WireEnd from(wire.from);
    const WireEnd to(wire.to);
    if (to.is_input_pin()) return std::nullopt;  // outside the chips
    WantedChip* chip = chip_of(to.chip);
    if (chip == nullptr || from.chip != to.chip) {
      return Refusal{fmt::format("the wire from {} to {} leaves its chip without a pin", wire.from, wire.to)};
    }
    SignalRef source;
    source.stage = stage_of(*chip, wire.from);
    if (!source.stage) source.pin = from.name;
    if (to.is_output_pin()) {
      chip->outputs.push_back({to.name, source});
      return std::nullopt;
    }
    const auto stage = stage_of(*chip, wire.to);
    const auto number = static_cast<std::size_t>(wire.input - 1);
    if (!stage || number >= chip->stages[*stage].inputs.size()) {
      return Refusal{fmt::format("the wire from {} to {} ends nowhere", wire.from, wire.to)};
    }
    chip->stages[*stage].inputs[number] = source;
    return std::nullopt;
  }

  const Plan& plan_;
  const PlanStreamOptions& options_;
  std::vector<WantedChip> out_;
  std::vector<std::string> warnings_;
};

}  // namespace

Outcome<PlanStreams> plan_streams(const Plan& plan, const PlanStreamOptions& options) {
  PlanReader reader(plan, options);
  const auto wanted = reader.read();
  if (const Refusal* refusal = refusal_of(wanted)) return *refusal;
  PlanStreams out;
  out.warnings = reader.warnings();
  for (const WantedChip& chip : std::get<std::vector<WantedChip>>(wanted)) {
    Outcome<BuiltChip> built = build_chip(chip);
    if (const Refusal* refusal = refusal_of(built)) return *refusal;
    auto& made = std::get<BuiltChip>(built);
    for (const std::string& note : made.notes) out.warnings.push_back(note);
    out.chips.push_back({chip.address1, std::move(made)});
  }
  return out;
}

std::vector<PinLink> pin_links(const Plan& plan, const std::vector<ChipCircuit>& chips,
                               const std::map<int, std::map<std::string, int>>& pins) {
  const auto index_of = [&](int address) {
    for (std::size_t i = 0; i < chips.size(); ++i) {
      if (chips[i].address1 == address) return static_cast<int>(i);
    }
    return -1;
  };
  const auto cell_of = [&](const WireEnd& end) {
    const auto chip = pins.find(end.chip);
    if (chip == pins.end()) return 0;
    const auto cell = chip->second.find(end.name);
    return cell == chip->second.end() ? 0 : cell->second;
  };
  std::vector<PinLink> out;
  for (const Wire& wire : plan.wires) {
    const WireEnd from(wire.from);
    const WireEnd to(wire.to);
    if (!to.is_input_pin() || (!from.is_output_pin() && !from.is_input_pin())) continue;
    const PinLink link{index_of(from.chip), cell_of(from), index_of(to.chip), cell_of(to)};
    if (link.from_chip >= 0 && link.to_chip >= 0 && link.from_cell > 0 && link.to_cell > 0)
      out.push_back(link);
  }
  return out;
}

BoardCircuit read_back(const Plan& plan, const PlanStreams& streams) {
  BoardCircuit out;
  out.master = plan.chips.empty() ? Hertz{16e6} : plan.chips.front().master_clock;
  std::map<int, std::map<std::string, int>> pins;
  for (const PlanStreams::Chip& chip : streams.chips) {
    out.chips.push_back(read_circuit(chip.built.memory, chip.chip));
    pins[chip.chip] = chip.built.pins;
  }
  out.links = pin_links(plan, out.chips, pins);
  return out;
}

Outcome<EndPins> end_pins(const Plan& plan) {
  EndPins out{plan.input_pin(), plan.output_pin()};
  if (out.input.empty() || out.output.empty()) {
    return Refusal{"the plan's wires have no input pin at their beginning or no output pin at their end"};
  }
  return out;
}

}  // namespace bodesmith::fpaa::an231
