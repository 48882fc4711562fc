#include "fpaa/streams/plan_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/device/clock_tree.hpp"
#include "fpaa/device/router.hpp"
#include "fpaa/streams/lookup_stage.hpp"

namespace bodesmith::fpaa::an231 {
namespace {

/// Divisors of clocks that nothing uses, as vendor streams have them: Clock 0 to 3.
constexpr std::array<int, 4> kIdleDivisorBytes = {0x02, 0x00, 0x04, 0x20};

template <class... Values>
[[noreturn]] void refuse(fmt::format_string<Values...> text, Values&&... values) {
  throw DesignError(fmt::format(text, std::forward<Values>(values)...));
}

/// A CAM of the chip with its switches, and where it stands in its CAB.
struct ChipStage {
  const PlacedCam* cam = nullptr;
  std::string name;                  ///< as wires have it
  StageSwitches switches;            ///< of a look-up stage: how its output stands
  std::vector<std::string> sources;  ///< where the wire to each input begins; empty: nothing is wired to it
  std::optional<LookupTable> lookup = {};
  int first_opamp = 1;
  int first_capacitor = 1;
  int clock_code = kByClockA;

  int output_opamp() const { return first_opamp + switches.output - 1; }
  /// A capacitor that is never switched reads this input: it sees every change of it, in both phases.
  bool has_static_branch(int input) const {
    return std::ranges::any_of(switches.capacitors, [&](const StageCapacitor& c) {
      return c.near.is_static() && c.near.phase1 == PlateNode::input(input);
    });
  }
  /// An input is read in no other phase than this one.
  bool reads_only_in(int phase, int input) const {
    return std::ranges::none_of(switches.capacitors, [&](const StageCapacitor& c) {
      return (phase == 1 ? c.near.phase2 : c.near.phase1) == PlateNode::input(input);
    });
  }
};

/// One chip: its stages, clocks and pins when it is made, then its memory. Throws DesignError where it cannot be.
class ChipWriter {
 public:
  ChipWriter(const Plan& plan, const ChipPlan& chip, std::vector<std::string>& warnings)
      : chip_(chip), notes_(warnings) {
    for (const PlacedCam& cam : chip.cams) stages_.push_back(read_stage(cam));
    read_clocks();
    read_wires(plan);
  }

  bool has_pin(const std::string& name) const {
    return std::ranges::find(inputs_, name) != inputs_.end() ||
           std::ranges::find(outputs_, name, &Output::name) != outputs_.end();
  }

  MemoryImage write(const PinCells& wanted) {
    reserve_lookup();
    for (ChipStage& stage : stages_) {
      if (!stage.lookup) place_stage(stage);
    }
    check_signals();
    route(wanted);
    write_chip();
    write_pins();
    for (const ChipStage& stage : stages_) write_stage(stage);
    return memory_;
  }
  const PinCells& cells() const { return routed_.cells; }

 private:
  /// An output pin, and where the wire to it begins.
  struct Output {
    std::string name, source;
  };

  ChipStage read_stage(const PlacedCam& cam) const {
    ChipStage out{&cam, fmt::format("chip{}.{}", chip_.chip, cam.name), {}, {}};
    out.sources.resize(cam.input_count());
    if (cam.cam == &transfer_function_cam()) {
      if (!cam.requested.number("cout"))
        refuse("{} has no look-up table, expected one (table_hex and cout)", out.name);
      // Its output stands in phase 1 and is 0 in phase 2.
      out.lookup = LookupTable::from(cam.requested);
      out.switches.opamps = {{.reset_phase = 2}};
      out.switches.output_phase = 1;
      return out;
    }
    auto switches = cam.cam->switches(cam);
    if (!switches) {
      refuse(
          "{} is a {}, whose switches are not publicly known; expected CAMs of known topology for a stream (update "
          "streams for a project of your own still work)",
          out.name, cam.cam_name());
    }
    out.switches = *std::move(switches);
    return out;
  }

  /// Both system divisors are the same, the smallest that lets every clock be made.
  void read_clocks() {
    std::map<int, int> totals;
    for (const PlacedCam& cam : chip_.cams) {
      const int total = nearest_whole<int>(chip_.master_clock.value / cam.clock_a.value);
      const double off = std::abs(chip_.master_clock.value / total / cam.clock_a.value - 1.0);
      const auto [at, fresh] = totals.try_emplace(cam.clock_index, total);
      if (off > 1e-9 || (!fresh && at->second != total)) {
        refuse("chip {}: Clock {} cannot be {} Hz for {}", chip_.chip, cam.clock_index,
               rounded_text(cam.clock_a.value, 8), cam.name);
      }
      if (cam.cam == &transfer_function_cam()) add_converter_clock(cam, total, totals);
    }
    std::vector<std::int64_t> all;
    std::vector<std::string> list;
    for (const auto& [clock, total] : totals) {
      all.push_back(total);
      list.push_back(rounded_text(chip_.master_clock.value / total, 6));
    }
    const std::optional<int> system = common_system_divisor(all);
    const std::string lowest = rounded_text(chip_.master_clock.value / kLargestDivisor, 6);
    if (!system) {
      refuse(
          "chip {}: no one system divisor makes all of its clocks ({} Hz), and which of two feeds a chip clock is not "
          "publicly known; expected clocks from {} Hz up, which need none, or none more than {} times as fast as "
          "another",
          chip_.chip, join(list, ", "), lowest, kLargestDivisor);
    }
    system_divisor_ = *system;
    for (const auto& [clock, total] : totals) clock_divisors_[clock] = total / *system;
    if (*system == 1) return;
    const auto slowest = static_cast<double>(*std::ranges::max_element(all));
    notes_.push_back(fmt::format(
        "chip {}: its slowest clock, {} Hz, lies below {} Hz, so the system clocks are divided by {} (both: which "
        "of them feeds a chip clock is not known). No public stream does that; should the coding differ, every "
        "clock and corner is off by one common factor, which a scope shows.",
        chip_.chip, rounded_text(chip_.master_clock.value / slowest, 6), lowest, *system));
  }

  /// The converter's clock, 16 times that of its CAM.
  void add_converter_clock(const PlacedCam& cam, int total, std::map<int, int>& totals) const {
    const auto [at, fresh] = totals.try_emplace(kLookupFastClock, total / kLookupClockRatio);
    if (total % kLookupClockRatio == 0 && (fresh || at->second * kLookupClockRatio == total)) return;
    refuse(
        "chip {}: {} needs Clock {} at {} Hz for its converter, which another CAM has or the master clock does not "
        "give",
        chip_.chip, cam.name, kLookupFastClock, rounded_text(kLookupClockRatio * cam.clock_a.value, 8));
  }

  const ChipStage* stage_at(const std::string& end) const {
    const auto at = std::ranges::find(stages_, end, &ChipStage::name);
    return at == stages_.end() ? nullptr : &*at;
  }

  void read_wires(const Plan& plan) {
    std::set<std::string> inputs;
    for (const Wire& wire : plan.wires) {
      for (const std::string& end : {wire.from, wire.to}) {
        if (WireEnd(end).chip == chip_.chip && WireEnd(end).is_input_pin()) inputs.insert(end);
      }
      const WireEnd to(wire.to);
      if (to.chip != chip_.chip || to.is_input_pin()) continue;
      if (WireEnd(wire.from).chip != chip_.chip)
        refuse("the wire from {} to {} leaves its chip without a pin", wire.from, wire.to);
      if (to.is_output_pin()) {
        outputs_.push_back({wire.to, wire.from});
        continue;
      }
      const auto stage = std::ranges::find(stages_, wire.to, &ChipStage::name);
      const auto number = static_cast<std::size_t>(wire.input - 1);
      if (stage == stages_.end() || number >= stage->sources.size())
        refuse("the wire from {} to {} ends nowhere", wire.from, wire.to);
      stage->sources[number] = wire.from;
    }
    inputs_.assign(inputs.begin(), inputs.end());
  }

  /// The look-up stage has its place, and its CAB both clocks.
  void reserve_lookup() {
    const auto is_lookup = [](const ChipStage& stage) { return stage.lookup.has_value(); };
    const auto first = std::ranges::find_if(stages_, is_lookup);
    if (first == stages_.end()) return;
    if (std::ranges::count_if(stages_, is_lookup) > 1 || first->cam->cab != kLookupCab ||
        first->cam->clock_index != kLookupSlowClock) {
      refuse(
          "{} stands in CAB {} at Clock {}; the bytes of a look-up stage are known for one a chip, in CAB {} at Clock "
          "{}",
          first->name, first->cam->cab, first->cam->clock_index, kLookupCab, kLookupSlowClock);
    }
    const auto cab = static_cast<std::size_t>(kLookupCab - 1);
    opamps_[cab] = kLookupOpAmps;
    capacitors_[cab] = kLookupCapacitors;
    last_capacitor_[cab] = kLookupFreeUpTo;
    cab_clocks_[cab] = {kLookupFastClock, kLookupSlowClock};
  }

  void place_stage(ChipStage& stage) {
    const auto cab = static_cast<std::size_t>(stage.cam->cab - 1);
    stage.first_opamp = opamps_[cab] + 1;
    stage.first_capacitor = capacitors_[cab] + 1;
    opamps_[cab] += static_cast<int>(stage.switches.opamps.size());
    capacitors_[cab] += static_cast<int>(stage.switches.capacitors.size());
    if (opamps_[cab] > kOpAmps || capacitors_[cab] > last_capacitor_[cab]) {
      refuse("CAB {} of chip {} has {} op-amps and {} capacitors to hold, expected at most {} and {}",
             stage.cam->cab, chip_.chip, opamps_[cab], capacitors_[cab], kOpAmps, last_capacitor_[cab]);
    }
    for (const StageCapacitor& c : stage.switches.capacitors) {
      if (c.units < 1 || c.units > kMostUnits)
        refuse("capacitor {} of {} is {} units, expected 1 to {}", c.name, stage.name, c.units, kMostUnits);
    }
    auto& clocks = cab_clocks_[cab];
    for (std::size_t i = 0; i < clocks.size(); ++i) {
      if (clocks[i] && *clocks[i] != stage.cam->clock_index) continue;
      clocks[i] = stage.cam->clock_index;
      stage.clock_code = i == 0 ? kByClockA : kByClockB;
      return;
    }
    refuse("CAB {} of chip {} would need three clocks, expected at most ClockA and ClockB", stage.cam->cab,
           chip_.chip);
  }

  /// The vendor's rules for half-period outputs.
  void check_signals() {
    for (const ChipStage& stage : stages_) {
      for (std::size_t i = 0; i < stage.sources.size(); ++i) {
        const int number = static_cast<int>(i) + 1;
        const bool is_static = stage.has_static_branch(number);
        const ChipStage* source = stage_at(stage.sources[i]);
        if (source == nullptr && is_static) {
          notes_.push_back(fmt::format(
              "{} reads pin {} through a capacitor that is never switched: in phase 2 it passes what the input does "
              "in between (the samples at the end of phase 1 are not changed by it); a hold or a low pass in front "
              "would remove that at the price of an op-amp.",
              stage.name, WireEnd(stage.sources[i]).name));
        }
        const int valid = source == nullptr ? 0 : source->switches.output_phase;
        if (valid == 0) continue;
        if (stage.lookup) {
          refuse(
              "the half-period output of {} feeds the converter of {}, which reads all the time; expected a Hold in "
              "between",
              source->name, stage.name);
        }
        if (is_static) {
          refuse(
              "the half-period output of {} feeds a static branch of {}, which would see it return to zero; expected "
              "a Hold in between",
              source->name, stage.name);
        }
        if (!stage.reads_only_in(valid, number) || stage.cam->clock_index != source->cam->clock_index) {
          refuse(
              "the output of {} is valid in phase {} of its clock only, and {} reads it in another; expected a Hold "
              "in between",
              source->name, valid, stage.name);
        }
      }
    }
  }

  void route(const PinCells& wanted) {
    std::vector<PinNeed> pins;
    for (const std::string& name : inputs_) {
      PinNeed& need = pins.emplace_back();
      need.name = name;
      for (const ChipStage& stage : stages_) {
        if (std::ranges::find(stage.sources, name) != stage.sources.end() &&
            std::ranges::find(need.cabs, stage.cam->cab) == need.cabs.end())
          need.cabs.push_back(stage.cam->cab);
      }
    }
    for (const Output& pin : outputs_) {
      PinNeed& need = pins.emplace_back();
      need.name = pin.name;
      need.is_input = false;
      const ChipStage* stage = stage_at(pin.source);
      if (stage == nullptr)
        refuse("{} is wired to pin {}, expected a CAM that drives it", pin.name, pin.source);
      need.cab = stage->cam->cab;
      need.opamp = stage->output_opamp();
      need.sampled = stage->switches.output_phase != 0;
      if (need.sampled && stage->cam->clock_index > 3) {
        refuse(
            "the half-period output of {} needs an output cell that samples by Clock 0 to 3, its clock is {}",
            stage->name, stage->cam->clock_index);
      }
    }
    bool asked = false;
    for (PinNeed& pin : pins) {
      const auto cell = wanted.find(pin.name);
      if (cell == wanted.end()) continue;
      pin.wanted_cell = cell->second;
      asked = true;
    }
    auto routed = route_pins(pins);
    if (!routed) {
      refuse("chip {}: no choice of I/O cells has lines enough for its {} pins{}", chip_.chip, pins.size(),
             asked ? " with the cells that were asked for" : "");
    }
    routed_ = *std::move(routed);
  }

  void set(Address at, int value) { memory_.set(at.bank, at.byte, value); }
  void set_bits(Address at, int bits) { memory_.set(at.bank, at.byte, memory_.at(at.bank, at.byte) | bits); }

  void write_chip() {
    for (const Constant& c : kConstants) set(c.address, c.value);
    for (int k = 0; k < 4; ++k) set(clock_divisor_at(k), kIdleDivisorBytes[static_cast<std::size_t>(k)]);
    set(kClockPower, 0x01);
    for (const auto& [clock, divisor] : clock_divisors_) {
      set(clock_divisor_at(clock), divisor_byte(divisor));
      set_bits(kClockPower, 1 << (2 + clock));
    }
    set(kSystem1, divisor_byte(system_divisor_));
    set(kSystem2, divisor_byte(system_divisor_));
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
    for (const std::string& name : inputs_) {
      const int cell = routed_.cells.at(name);
      set({kIoBank, cell_bytes(cell).mode}, cell > 4 ? kModeBypass : kModeInput);
    }
    for (const Output& pin : outputs_) {
      const int cell = routed_.cells.at(pin.name);
      const ChipStage* stage = stage_at(pin.source);
      const int valid = stage->switches.output_phase;
      if (valid == 0) {
        set({kIoBank, cell_bytes(cell).mode}, cell > 4 ? kModeBypass : kModeOutput);
        continue;
      }
      set({kIoBank, cell_bytes(cell).mode}, kModeSampled);
      set({kIoBank, cell_bytes(cell).option2},
          kSampledBase + 8 * stage->cam->clock_index + (valid == 1 ? kSampledPhase1 : 0));
      notes_.push_back(
          fmt::format("{} has a half-period output: I/O cell {} of pin {} samples it in phase {}.",
                      stage->name, cell, WireEnd(pin.name).name, valid));
    }
  }

  int near_nibble(const ChipStage& stage, const PlateNode& node) const {
    using Plate = PlateNode::Kind;
    switch (node.kind) {
      case Plate::open:
      case Plate::virtual_ground:
        return 0;
      case Plate::ground:
        return kNearGround;
      case Plate::opamp:
        return opamp_selector(stage.cam->cab, stage.cam->cab, stage.first_opamp + node.number - 1);
      case Plate::input:
        break;
    }
    const auto number = static_cast<std::size_t>(node.number - 1);
    if (number >= stage.sources.size() || stage.sources[number].empty()) return kNearGround;
    if (const ChipStage* source = stage_at(stage.sources[number]))
      return opamp_selector(stage.cam->cab, source->cam->cab, source->output_opamp());
    return routed_.selectors.at({stage.sources[number], stage.cam->cab});
  }

  static int far_nibble(const ChipStage& stage, const PlateNode& node) {
    using Plate = PlateNode::Kind;
    if (node.kind == Plate::ground) return kFarGround;
    return node.kind == Plate::virtual_ground ? stage.first_opamp + node.number - 1 : 0;
  }

  void write_word(Address at, const Plate& plate, int first, int second, int clock_code) {
    set(at, !plate.is_static() ? clock_code : kStatic);
    set({at.bank, at.byte + 1}, !plate.is_static() ? second << 4 | first : first << 4);
  }

  void write_stage(const ChipStage& stage) {
    if (stage.lookup) {
      const int selector = near_nibble(stage, PlateNode::input());
      write_lookup(memory_, *stage.lookup, selector);
      notes_.push_back(lookup_note(stage.name, selector));
      return;
    }
    int number = stage.first_capacitor;
    for (const StageCapacitor& c : stage.switches.capacitors) {
      set(capacitor_at(stage.cam->cab, number), nearest_whole<int>(c.units));
      const Address at = switches_at(stage.cam->cab, number++);
      write_word(at, c.near, near_nibble(stage, c.near.phase1), near_nibble(stage, c.near.phase2),
                 stage.clock_code);
      write_word({at.bank, at.byte + 2}, c.far, far_nibble(stage, c.far.phase1),
                 far_nibble(stage, c.far.phase2), stage.clock_code);
    }
    int opamp = stage.first_opamp;
    for (const StageOpAmp& one : stage.switches.opamps) {
      const Address at = opamp_at(stage.cam->cab, opamp++);
      if (one.reset_phase != 0)
        set(at, (one.reset_phase == 1 ? kResetPhase1 : kResetPhase2) | stage.clock_code);
      set({at.bank, at.byte + 1}, kOpAmpOn);
    }
  }

  const ChipPlan& chip_;
  std::vector<std::string>& notes_;
  std::vector<ChipStage> stages_;
  std::vector<std::string> inputs_;  ///< pins
  std::vector<Output> outputs_;
  int system_divisor_ = 1;
  std::map<int, int> clock_divisors_;    ///< chip clock -> divisor behind the system divisor
  std::array<int, kCabs> opamps_{};      ///< taken, of each CAB
  std::array<int, kCabs> capacitors_{};  ///< the last one taken
  std::array<int, kCabs> last_capacitor_{kCapacitors, kCapacitors, kCapacitors, kCapacitors};
  std::array<std::array<std::optional<int>, 2>, kCabs> cab_clocks_;
  RoutedPins routed_;
  MemoryImage memory_;
};

PlanStreams written(const Plan& plan, const PinCells& wanted) {
  PlanStreams out;
  std::vector<ChipWriter> writers;
  for (const ChipPlan& chip : plan.chips) writers.emplace_back(plan, chip, out.warnings);
  for (const auto& one : wanted) {
    const std::string& pin = one.first;
    if (std::ranges::none_of(writers, [&](const ChipWriter& w) { return w.has_pin(pin); }))
      refuse("an I/O cell is asked for {}, which is no pin of the plan", pin);
  }
  for (std::size_t i = 0; i < writers.size(); ++i) {
    out.chips.push_back({plan.chips[i].chip, writers[i].write(wanted)});
    out.cells.insert(writers[i].cells().begin(), writers[i].cells().end());
  }
  return out;
}

}  // namespace

std::map<std::string, std::string> PlanStreams::pins_of(int chip) const {
  std::map<std::string, std::string> out;
  for (const auto& [pin, cell] : cells) {
    if (const WireEnd end(pin); end.chip == chip) out[end.name] = fmt::format("IO{}", cell);
  }
  return out;
}

Outcome<PlanStreams> plan_streams(const Plan& plan, const PinCells& wanted) {
  try {
    return written(plan, wanted);
  } catch (const DesignError& refused) {
    return Refusal{refused.what()};
  }
}

void add_links(BoardCircuit& board, const Plan& plan, const PinCells& cells) {
  for (const Wire& wire : plan.wires) {
    const WireEnd from(wire.from);
    if (!WireEnd(wire.to).is_input_pin() || (!from.is_output_pin() && !from.is_input_pin())) continue;
    const auto a = board_pin(cells, wire.from);
    const auto b = board_pin(cells, wire.to);
    if (a && b && board.index_of(a->chip) && board.index_of(b->chip)) board.links.push_back({*a, *b});
  }
}

BoardCircuit read_back(const Plan& plan, const PlanStreams& streams) {
  BoardCircuit out;
  out.master = plan.chips.empty() ? Hertz{16e6} : plan.chips.front().master_clock;
  for (const PlanStreams::Chip& chip : streams.chips)
    out.chips.push_back(read_circuit(chip.memory, chip.chip));
  add_links(out, plan, streams.cells);
  return out;
}

std::optional<BoardPin> board_pin(const PinCells& cells, const std::string& pin) {
  const auto cell = cells.find(pin);
  return cell == cells.end() ? std::nullopt : std::optional(BoardPin{WireEnd(pin).chip, cell->second});
}

std::optional<SignalPins> end_pins(const Plan& plan, const PinCells& cells) {
  const auto input = board_pin(cells, plan.input_pin());
  const auto output = board_pin(cells, plan.output_pin());
  if (!input || !output) return std::nullopt;
  return SignalPins{*input, *output};
}

}  // namespace bodesmith::fpaa::an231
