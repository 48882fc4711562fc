#include "fpaa/streams/chip_layout.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/whole_number.hpp"
#include "fpaa/device/clock_tree.hpp"
#include "fpaa/device/router.hpp"
#include "fpaa/streams/lookup_stage.hpp"

namespace bodesmith::fpaa::an231 {
namespace {

/// Divisors of clocks that nothing uses, as vendor streams have them: Clock 0 to 3.
constexpr std::array<int, 4> kIdleDivisorBytes = {0x02, 0x00, 0x04, 0x20};

/// Where a stage stands in its CAB.
struct StagePlace {
  int first_opamp = 1;
  int first_capacitor = 1;
  int clock_code = kByClockA;
  int output_opamp(const StageSwitches& switches) const { return first_opamp + switches.output - 1; }
};

bool is_input(const PlateNode& node, int number) {
  return node == PlateNode::input(number);
}

/// A capacitor that is never switched reads this input: it sees every change of it, in both phases.
bool has_static_branch(const StageSwitches& switches, int input) {
  for (const StageCapacitor& c : switches.capacitors) {
    if (c.near.is_static() && is_input(c.near.phase1, input)) return true;
  }
  return false;
}

/// An input is read in no other phase than this one.
bool is_read_only_in(const StageSwitches& switches, int input, int phase) {
  for (const StageCapacitor& c : switches.capacitors) {
    if (is_input(phase == 1 ? c.near.phase2 : c.near.phase1, input)) return false;
  }
  return true;
}

class ChipWriter {
 public:
  explicit ChipWriter(const WantedChip& chip) : chip_(chip) {}

  Outcome<BuiltChip> build() {
    for (const auto step : {&ChipWriter::place_stages, &ChipWriter::check_signals, &ChipWriter::route}) {
      if (auto refusal = (this->*step)()) return *refusal;
    }
    write_chip();
    write_pins();
    for (std::size_t i = 0; i < chip_.stages.size(); ++i) write_stage(i);
    return std::move(out_);
  }

 private:
  using Step = std::optional<Refusal>;

  Step place_stages() {
    if (auto refusal = reserve_lookup()) return refusal;
    for (const WantedStage& stage : chip_.stages) {
      StagePlace place;
      if (!stage.lookup) {
        if (auto refusal = place_stage(stage, place)) return refusal;
      }
      places_.push_back(place);
    }
    return std::nullopt;
  }

  /// The look-up stage has its place, and its CAB both clocks.
  Step reserve_lookup() {
    const auto is_lookup = [](const WantedStage& stage) { return stage.lookup.has_value(); };
    const auto first = std::find_if(chip_.stages.begin(), chip_.stages.end(), is_lookup);
    if (first == chip_.stages.end()) return std::nullopt;
    if (std::count_if(chip_.stages.begin(), chip_.stages.end(), is_lookup) > 1 || first->cab != kLookupCab ||
        first->clock != kLookupSlowClock) {
      return Refusal{fmt::format(
          "{} stands in CAB {} at Clock {}; the bytes of a look-up stage are known for one a chip, "
          "in CAB {} at Clock {}",
          first->name, first->cab, first->clock, kLookupCab, kLookupSlowClock)};
    }
    const auto cab = static_cast<std::size_t>(kLookupCab - 1);
    opamps_[cab] = kLookupOpAmps;
    capacitors_[cab] = kLookupCapacitors;
    last_capacitor_[cab] = kLookupFreeUpTo;
    cab_clocks_[cab] = {kLookupFastClock, kLookupSlowClock};
    return std::nullopt;
  }

  Step place_stage(const WantedStage& stage, StagePlace& place) {
    const auto cab = static_cast<std::size_t>(stage.cab - 1);
    place = {opamps_[cab] + 1, capacitors_[cab] + 1, kByClockA};
    opamps_[cab] += static_cast<int>(stage.switches.opamps.size());
    capacitors_[cab] += static_cast<int>(stage.switches.capacitors.size());
    if (opamps_[cab] > kOpAmps || capacitors_[cab] > last_capacitor_[cab]) {
      return Refusal{fmt::format(
          "CAB {} of chip {} has {} op-amps and {} capacitors to hold, expected at most {} "
          "and {}",
          stage.cab, chip_.address1, opamps_[cab], capacitors_[cab], kOpAmps, last_capacitor_[cab])};
    }
    for (const StageCapacitor& c : stage.switches.capacitors) {
      if (c.units < 1 || c.units > 255) {
        return Refusal{
            fmt::format("capacitor {} of {} is {} units, expected 1 to 255", c.name, stage.name, c.units)};
      }
    }
    return give_clock(stage, place);
  }

  Step give_clock(const WantedStage& stage, StagePlace& place) {
    auto& clocks = cab_clocks_[static_cast<std::size_t>(stage.cab - 1)];
    for (std::size_t i = 0; i < clocks.size(); ++i) {
      if (clocks[i] && *clocks[i] != stage.clock) continue;
      clocks[i] = stage.clock;
      place.clock_code = i == 0 ? kByClockA : kByClockB;
      return std::nullopt;
    }
    return Refusal{
        fmt::format("CAB {} of chip {} would need three clocks, expected at most ClockA and ClockB",
                    stage.cab, chip_.address1)};
  }

  /// The vendor's rules for half-period outputs.
  Step check_signals() {
    for (const WantedStage& stage : chip_.stages) {
      for (std::size_t i = 0; i < stage.inputs.size(); ++i) {
        const int number = static_cast<int>(i) + 1;
        const bool is_static = has_static_branch(stage.switches, number);
        if (!stage.inputs[i].stage) {
          if (is_static) {
            out_.notes.push_back(fmt::format(
                "{} reads pin {} through a capacitor that is never switched: in phase 2 it passes what the input "
                "does in between (the samples at the end of phase 1 are not changed by it); a hold or a low pass "
                "in front would remove that at the price of an op-amp.",
                stage.name, stage.inputs[i].pin));
          }
          continue;
        }
        const WantedStage& source = chip_.stages[*stage.inputs[i].stage];
        const int valid = source.switches.output_phase;
        if (valid == 0) continue;
        if (stage.lookup) {
          return Refusal{
              fmt::format("the half-period output of {} feeds the converter of {}, which reads all the time; "
                          "expected a Hold in between",
                          source.name, stage.name)};
        }
        if (is_static) {
          return Refusal{
              fmt::format("the half-period output of {} feeds a static branch of {}, which would see "
                          "it return to zero; expected a Hold in between",
                          source.name, stage.name)};
        }
        if (!is_read_only_in(stage.switches, number, valid) || stage.clock != source.clock) {
          return Refusal{
              fmt::format("the output of {} is valid in phase {} of its clock only, and {} reads it in "
                          "another; expected a Hold in between",
                          source.name, valid, stage.name)};
        }
      }
    }
    return std::nullopt;
  }

  Step route() {
    std::vector<PinNeed> pins;
    for (const std::string& name : chip_.inputs) {
      PinNeed need;
      need.name = name;
      for (const WantedStage& stage : chip_.stages) {
        for (const SignalRef& input : stage.inputs) {
          const bool reads = !input.stage && input.pin == name;
          if (reads && std::find(need.cabs.begin(), need.cabs.end(), stage.cab) == need.cabs.end()) {
            need.cabs.push_back(stage.cab);
          }
        }
      }
      for (const WantedPin& pin : chip_.outputs) {
        if (!pin.from.stage && pin.from.pin == name) need.loops.push_back(pin.name);
      }
      pins.push_back(std::move(need));
    }
    for (const WantedPin& pin : chip_.outputs) {
      PinNeed need;
      need.name = pin.name;
      need.is_input = false;
      if (pin.from.stage) {
        const WantedStage& stage = chip_.stages[*pin.from.stage];
        need.cab = stage.cab;
        need.opamp = places_[*pin.from.stage].output_opamp(stage.switches);
        need.sampled = stage.switches.output_phase != 0;
        if (need.sampled && stage.clock > 3) {
          return Refusal{
              fmt::format("the half-period output of {} needs an output cell that samples by Clock 0 to "
                          "3, its clock is {}",
                          stage.name, stage.clock)};
        }
      }
      pins.push_back(std::move(need));
    }
    for (PinNeed& pin : pins) {
      if (const auto cell = chip_.cells.find(pin.name); cell != chip_.cells.end())
        pin.wanted_cell = cell->second;
    }
    const auto routed = route_pins(pins);
    if (!routed) {
      return Refusal{fmt::format("chip {}: no choice of I/O cells has lines enough for its {} pins{}",
                                 chip_.address1, pins.size(),
                                 chip_.cells.empty() ? "" : " with the cells that were asked for")};
    }
    routed_ = *routed;
    out_.pins = routed_.cells;
    return std::nullopt;
  }

  void set(Address at, int value) { out_.memory.set(at.bank, at.byte, value); }
  void set_bits(Address at, int bits) {
    out_.memory.set(at.bank, at.byte, out_.memory.at(at.bank, at.byte) | bits);
  }

  void write_chip() {
    for (const Constant& c : kConstants) set(c.address, c.value);
    for (int k = 0; k < 4; ++k) set(clock_divisor_at(k), kIdleDivisorBytes[static_cast<std::size_t>(k)]);
    set(kClockPower, 0x01);
    for (const auto& [clock, divisor] : chip_.clock_divisors) {
      set(clock_divisor_at(clock), divisor_byte(divisor));
      set_bits(kClockPower, 1 << (2 + clock));
    }
    set(kSystem1, divisor_byte(chip_.system_divisor));
    set(kSystem2, divisor_byte(chip_.system_divisor));
    for (int cab = 1; cab <= kCabs; ++cab) {
      const auto index = static_cast<std::size_t>(cab - 1);
      const auto nibble = [](const std::optional<int>& clock) { return clock ? clock_nibble(*clock) : 0; };
      set(cab_clocks_at(cab), nibble(cab_clocks_[index][0]) | nibble(cab_clocks_[index][1]) << 4);
      set(line_drivers_at(cab), routed_.line_drivers[index]);
      for (int i = 1; i <= kLines; ++i) {
        set(local_input_at(cab, i), routed_.local_inputs[index][static_cast<std::size_t>(i - 1)]);
      }
    }
  }

  void write_pins() {
    for (const RoutedPins::CellNibble& n : routed_.nibbles) {
      const Nibble at = route_nibble(n.cell, n.column);
      set_bits({kIoBank, at.byte}, at.high ? n.nibble << 4 : n.nibble);
    }
    for (const std::string& name : chip_.inputs) {
      const int cell = routed_.cells.at(name);
      set({kIoBank, cell_bytes(cell).mode}, cell > 4 ? kModeBypass : kModeInput);
    }
    for (const WantedPin& pin : chip_.outputs) {
      const int cell = routed_.cells.at(pin.name);
      const WantedStage* stage = pin.from.stage ? &chip_.stages[*pin.from.stage] : nullptr;
      const int valid = stage == nullptr ? 0 : stage->switches.output_phase;
      if (valid == 0) {
        set({kIoBank, cell_bytes(cell).mode}, cell > 4 ? kModeBypass : kModeOutput);
        continue;
      }
      set({kIoBank, cell_bytes(cell).mode}, kModeSampled);
      set({kIoBank, cell_bytes(cell).option2},
          kSampledBase + 8 * stage->clock + (valid == 1 ? kSampledPhase1 : 0));
      out_.notes.push_back(
          fmt::format("{} has a half-period output: I/O cell {} of pin {} samples it in phase {}.",
                      stage->name, cell, pin.name, valid));
    }
  }

  int near_nibble(std::size_t index, const PlateNode& node) const {
    const WantedStage& stage = chip_.stages[index];
    using Plate = PlateNode::Kind;
    switch (node.kind) {
      case Plate::open:
      case Plate::virtual_ground:
        return 0;
      case Plate::ground:
        return kNearGround;
      case Plate::opamp:
        return opamp_selector(stage.cab, stage.cab, places_[index].first_opamp + node.number - 1);
      case Plate::input:
        break;
    }
    const auto number = static_cast<std::size_t>(node.number - 1);
    if (number >= stage.inputs.size()) return kNearGround;  // an input that nothing is wired to
    const SignalRef& from = stage.inputs[number];
    if (!from.stage) {
      return from.pin.empty() ? kNearGround : routed_.selectors.at({from.pin, stage.cab});
    }
    const WantedStage& source = chip_.stages[*from.stage];
    return opamp_selector(stage.cab, source.cab, places_[*from.stage].output_opamp(source.switches));
  }

  int far_nibble(std::size_t index, const PlateNode& node) const {
    using Plate = PlateNode::Kind;
    if (node.kind == Plate::ground) return kFarGround;
    return node.kind == Plate::virtual_ground ? places_[index].first_opamp + node.number - 1 : 0;
  }

  void write_word(Address at, const Plate& plate, int first, int second, int clock_code) {
    set(at, !plate.is_static() ? clock_code : kStatic);
    set({at.bank, at.byte + 1}, !plate.is_static() ? second << 4 | first : first << 4);
  }

  void write_stage(std::size_t index) {
    const WantedStage& stage = chip_.stages[index];
    if (stage.lookup) {
      const int selector = near_nibble(index, PlateNode::input());
      write_lookup(out_.memory, *stage.lookup, selector);
      out_.notes.push_back(lookup_note(stage.name, selector));
      return;
    }
    const StagePlace& place = places_[index];
    int number = place.first_capacitor;
    for (const StageCapacitor& c : stage.switches.capacitors) {
      set(capacitor_at(stage.cab, number), nearest_whole<int>(c.units));
      const Address at = switches_at(stage.cab, number++);
      write_word(at, c.near, near_nibble(index, c.near.phase1), near_nibble(index, c.near.phase2),
                 place.clock_code);
      write_word({at.bank, at.byte + 2}, c.far, far_nibble(index, c.far.phase1),
                 far_nibble(index, c.far.phase2), place.clock_code);
    }
    for (int o = 0; o < static_cast<int>(stage.switches.opamps.size()); ++o) {
      const Address at = opamp_at(stage.cab, place.first_opamp + o);
      const int reset = stage.switches.opamps[static_cast<std::size_t>(o)].reset_phase;
      if (reset != 0) set(at, (reset == 1 ? kResetPhase1 : kResetPhase2) | place.clock_code);
      set({at.bank, at.byte + 1}, kOpAmpOn);
    }
  }

  const WantedChip& chip_;
  std::vector<StagePlace> places_;
  std::array<int, kCabs> opamps_{};      ///< taken, of each CAB
  std::array<int, kCabs> capacitors_{};  ///< the last one taken
  std::array<int, kCabs> last_capacitor_{kCapacitors, kCapacitors, kCapacitors, kCapacitors};
  std::array<std::array<std::optional<int>, 2>, kCabs> cab_clocks_;
  RoutedPins routed_;
  BuiltChip out_;
};

}  // namespace

Outcome<BuiltChip> build_chip(const WantedChip& chip) {
  return ChipWriter(chip).build();
}

}  // namespace bodesmith::fpaa::an231
