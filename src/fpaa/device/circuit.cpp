#include "fpaa/device/circuit.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "fpaa/device/routes.hpp"

namespace bodesmith::fpaa::an231 {
namespace {

using Clock = SwitchWord::Clock;

int divisor_of_byte(int byte) {
  return byte == 0 ? 1 : 2 * byte;
}

std::optional<int> clock_of_nibble(int nibble) {
  if (nibble >= 0xC) return nibble - 0xC;
  if (nibble >= 0xA) return 4 + nibble - 0xA;
  return std::nullopt;
}

/// Reads the memory byte by byte and remembers which were looked at: the others are listed.
class CircuitReader {
 public:
  CircuitReader(const MemoryImage& memory, int address1) : memory_(memory), routes_(memory) {
    out_.address1 = address1;
  }

  ChipCircuit read() {
    constants();
    clocks();
    for (int cab = 1; cab <= kCabs; ++cab) cab_cell(cab);
    for (int cell = 1; cell <= kIoCells; ++cell) io_cell(cell);
    check_references();
    lookup_table();
    rest();
    return std::move(out_);
  }

 private:
  int take(Address at) {
    seen_[seen_index(at)] = true;
    return memory_.at(at.bank, at.byte);
  }
  static std::size_t seen_index(Address at) {
    return static_cast<std::size_t>(MemoryImage::kBankBytes * at.bank + at.byte);
  }
  void unexplained(Address at, std::string what) {
    seen_[seen_index(at)] = true;
    out_.unexplained.push_back({at, memory_.at(at.bank, at.byte), std::move(what)});
  }
  static void add_new(std::vector<std::string>& lines, std::string text) {
    if (std::ranges::find(lines, text) == lines.end()) lines.push_back(std::move(text));
  }
  void problem(std::string text) { add_new(out_.problems, std::move(text)); }
  void note(std::string text) { add_new(out_.notes, std::move(text)); }

  void constants() {
    for (const Constant& c : kConstants) {
      const int value = take(c.address);
      if (value == c.value) {
        out_.constants.push_back({c.address, value, c.what});
      } else {
        unexplained(c.address, fmt::format("usually {:02X}: {}", c.value, c.what));
      }
    }
  }

  void clocks() {
    for (int k = 0; k < kClocks; ++k) {
      const auto index = static_cast<std::size_t>(k);
      out_.divisors[index] = divisor_of_byte(take(clock_divisor_at(k)));
      out_.powered[index] = (take(kClockPower) >> (2 + k) & 1) != 0;
    }
    if ((take(kClockPower) & 0x03) != 0x01) {
      unexplained(kClockPower, "bit 0 is always 1 and bit 1 always 0 in public streams");
    }
    out_.system1_divisor = divisor_of_byte(take(kSystem1));
    out_.system2_divisor = divisor_of_byte(take(kSystem2));
    if (out_.system1_divisor != out_.system2_divisor) {
      problem(
          fmt::format("system clocks are divided by {} and {}: which of them feeds a chip clock is not "
                      "publicly known, expected equal divisors",
                      out_.system1_divisor, out_.system2_divisor));
    } else if (out_.system1_divisor != 1) {
      out_.notes.push_back(fmt::format(
          "the system clocks are divided by {}: no public stream does that, the coding is inferred "
          "from that of the chip clocks",
          out_.system1_divisor));
    }
  }

  SwitchWord word(Address at, int cab, bool near) {
    SwitchWord out;
    const int clock = take(at);
    const Address nibbles_at{at.bank, at.byte + 1};
    const int nibbles = take(nibbles_at);
    const auto node = [&](int nibble) {
      return near ? routes_.node(cab, nibble) : far_node(cab, nibble, nibbles_at);
    };
    const int high = nibbles >> 4;
    const int low = nibbles & 0xF;
    if (clock == kStatic) {
      out.at = {node(high), node(high)};
      if (low != 0) unexplained(nibbles_at, "low nibble of a static switch word, expected 0");
    } else if (clock == kByClockA || clock == kByClockB) {
      out.clock = clock == kByClockA ? Clock::a : Clock::b;
      out.at = {node(low), node(high)};
    } else {
      out.clock = Clock::other;
      unexplained(at, "clock byte of a switch word: controlled by a comparator or SAR");
    }
    return out;
  }

  CircuitNode far_node(int cab, int nibble, Address at) {
    using Is = CircuitNode::Kind;
    if (nibble == 0) return {};
    if (nibble == kFarGround) return {Is::ground, 0, 0};
    if (nibble <= kOpAmps) return {Is::virtual_ground, cab, nibble};
    unexplained(at, fmt::format("far switch {:X}", nibble));
    return {Is::undriven, 0, 0};
  }

  void capacitor(CabCell& cab, int number) {
    CapacitorCell out;
    out.number = number;
    out.units = take(capacitor_at(cab.cab, number));
    const Address at = switches_at(cab.cab, number);
    const bool switched = (memory_.at(at.bank, at.byte) | memory_.at(at.bank, at.byte + 1) |
                           memory_.at(at.bank, at.byte + 2) | memory_.at(at.bank, at.byte + 3)) != 0;
    const std::size_t before = out_.unexplained.size();
    out.near = word(at, cab.cab, true);
    out.far = word({at.bank, at.byte + 2}, cab.cab, false);
    out.is_understood = out_.unexplained.size() == before;
    if (out.units == 0 && switched) {
      problem(fmt::format("CAB {} C{} is switched but has zero units", cab.cab, number));
    }
    if (out.units > 0 || switched) cab.capacitors.push_back(out);
  }

  OpAmpCell opamp(int cab, int number) {
    const Address at = opamp_at(cab, number);
    const int reset = take(at);
    const Address power_at{at.bank, at.byte + 1};
    const int power = take(power_at);
    OpAmpCell out;
    out.on = power != 0;
    if (power != 0 && power != kOpAmpOn) unexplained(power_at, "op-amp option, usually 05");
    if (reset == 0) return out;
    const int by = reset & 0x0F;
    const int phase = reset & 0xF0;
    if ((by == kByClockA || by == kByClockB) && (phase == kResetPhase1 || phase == kResetPhase2)) {
      out.reset_phase = phase == kResetPhase1 ? 1 : 2;
      out.reset_clock = by == kByClockA ? Clock::a : Clock::b;
    } else {
      unexplained(at, "op-amp's feedback switch");
    }
    return out;
  }

  void cab_cell(int number) {
    CabCell& cab = out_.cabs[static_cast<std::size_t>(number - 1)];
    cab.cab = number;
    const int clocks = take(cab_clocks_at(number));
    cab.clock_a = clock_of_nibble(clocks & 0xF);
    cab.clock_b = clock_of_nibble(clocks >> 4);
    if (((clocks & 0xF) != 0 && !cab.clock_a) || ((clocks >> 4) != 0 && !cab.clock_b)) {
      unexplained(cab_clocks_at(number), "clock choice of the CAB");
    }
    for (int o = 1; o <= kOpAmps; ++o) cab.opamps[static_cast<std::size_t>(o - 1)] = opamp(number, o);
    for (int c = 1; c <= kCapacitors; ++c) capacitor(cab, c);
    if ((take(line_drivers_at(number)) & ~0x1B) != 0) {
      unexplained(line_drivers_at(number), "driver of a column line");
    }
    for (int i = 1; i <= kLines; ++i) {
      if (take(local_input_at(number, i)) > kLines) {
        unexplained(local_input_at(number, i), "choice of a local input");
      }
    }
  }

  void io_cell(int number) {
    const CellBytes bytes = cell_bytes(number);
    IoCell& cell = out_.cells[static_cast<std::size_t>(number - 1)];
    cell = routes_.cell(number);
    for (const Column column : kColumns) {
      const Nibble at = route_nibble(number, column);
      const int byte = take({kIoBank, at.byte});
      if (cell.mode == IoCell::Mode::off && (at.high ? byte >> 4 : byte & 0xF) != 0) {
        note(fmt::format("IO{} is off, but has a route", number));
      }
    }
    take({kIoBank, bytes.mode});
    if (cell.mode == IoCell::Mode::unknown) unexplained({kIoBank, bytes.mode}, "mode of an I/O cell");
    if (cell.mode == IoCell::Mode::amplifier_input) {
      out_.notes.push_back(
          fmt::format("IO{} has its input amplifier on, whose gain is not known: taken as 1", number));
    }
    if (cell.is_output() && cell.source.kind == CircuitNode::Kind::undriven) {
      problem(fmt::format("IO{} is an output that nothing drives", number));
    }
    if (bytes.option1 < 0) return;
    if (cell.mode == IoCell::Mode::sampled_output) take({kIoBank, bytes.option2});
    for (const int option : {bytes.option1, bytes.option2}) {
      const Address at{kIoBank, option};
      if (!seen_[seen_index(at)] && memory_.at(at.bank, at.byte) != 0) {
        unexplained(at, fmt::format("option of IO{}", number));
      }
    }
  }

  /// Everything that reads something reads one driver that is on.
  void check_references() {
    for (const std::string& text : routes_.collisions()) problem(text);
    for (const CabCell& cab : out_.cabs) {
      for (const CapacitorCell& c : cab.capacitors) check_capacitor(cab, c);
      for (std::size_t o = 0; o < cab.opamps.size(); ++o) {
        const OpAmpCell& amp = cab.opamps[o];
        if (amp.reset_phase != 0) check_clock(cab, amp.reset_clock, fmt::format("op-amp {}", o + 1));
      }
    }
    for (const IoCell& cell : out_.cells) {
      if (cell.is_output()) check_on(cell.source, fmt::format("IO{}", cell.number));
      if (cell.mode == IoCell::Mode::sampled_output &&
          (cell.sample_clock < 0 || !out_.powered[static_cast<std::size_t>(cell.sample_clock)])) {
        problem(fmt::format("IO{} samples by a clock that is off", cell.number));
      }
    }
  }

  void check_capacitor(const CabCell& cab, const CapacitorCell& c) {
    if (!c.is_understood) return;
    const std::string name = fmt::format("CAB {} C{}", cab.cab, c.number);
    for (const SwitchWord* w : {&c.near, &c.far}) {
      if (w->clock == Clock::a || w->clock == Clock::b)
        check_clock(cab, w->clock, fmt::format("C{}", c.number));
      for (const CircuitNode& node : w->at) {
        check_on(node, name);
        if (node.kind == CircuitNode::Kind::reference) {
          note(fmt::format("{} is switched to {}, which responses leave out", name, node.text()));
        }
      }
    }
  }

  void check_clock(const CabCell& cab, Clock by, const std::string& who) {
    const std::optional<int> clock = cab.clock(by);
    const char letter = by == Clock::a ? 'A' : 'B';
    if (!clock) {
      problem(fmt::format("CAB {} {} is switched by Clock{}, which is not chosen", cab.cab, who, letter));
    } else if (!out_.powered[static_cast<std::size_t>(*clock)]) {
      problem(fmt::format("CAB {} {} is switched by Clock {}, which is off", cab.cab, who, *clock));
    }
  }

  void check_on(const CircuitNode& node, const std::string& who) {
    using Is = CircuitNode::Kind;
    if (node.kind == Is::undriven) problem(who + " reads a line that nothing drives");
    const bool amp = node.kind == Is::opamp || node.kind == Is::virtual_ground;
    if (amp && !out_.cab(node.cab).opamps[static_cast<std::size_t>(node.number - 1)].on) {
      problem(fmt::format("{} is joined to op-amp {} of CAB {}, which is off", who, node.number, node.cab));
    }
  }

  void lookup_table() {
    std::vector<int> bytes;
    for (int bank = kLookupBank; bank < MemoryImage::kBanks; ++bank) {
      for (int byte = 0; byte < MemoryImage::kBankBytes; ++byte) bytes.push_back(take({bank, byte}));
    }
    if (std::ranges::all_of(bytes, [](int b) { return b == 0; })) return;
    out_.lookup_table = std::move(bytes);
    out_.notes.push_back(fmt::format("the look-up table is written: {:02X} at -3 V to {:02X} at 3 V",
                                     out_.lookup_table.front(), out_.lookup_table.back()));
  }

  void rest() {
    for (int bank = 0; bank < MemoryImage::kBanks; ++bank) {
      for (int byte = 0; byte < MemoryImage::kBankBytes; ++byte) {
        const Address at{bank, byte};
        if (memory_.at(bank, byte) == 0 || seen_[seen_index(at)]) continue;
        unexplained(at, bank == 1    ? "digital pins, comparator routing, look-up counter"
                        : bank == 0  ? "clock delay or unknown"
                        : bank == 2  ? "unknown"
                        : bank >= 11 ? "beyond the CABs"
                                     : "comparator, SAR or look-up option of the CAB");
      }
    }
  }

  const MemoryImage& memory_;
  Routes routes_;
  ChipCircuit out_;
  std::array<bool, MemoryImage::kBytes> seen_{};
};

}  // namespace

Hertz ChipCircuit::clock(int number, Hertz master) const {
  return {master.value / system1_divisor / divisors.at(static_cast<std::size_t>(number))};
}

ChipCircuit read_circuit(const MemoryImage& memory, int address1) {
  return CircuitReader(memory, address1).read();
}

}  // namespace bodesmith::fpaa::an231
