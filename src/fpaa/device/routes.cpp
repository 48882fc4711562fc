#include "fpaa/device/routes.hpp"

#include <fmt/format.h>

namespace bodesmith::fpaa::an231 {
namespace {

using Kind = CircuitNode::Kind;
using Mode = IoCell::Mode;
constexpr int kFirstBypassCell = 5;

const char* column_name(Column column) {
  return column == Column::odd ? "odd" : "even";
}

bool is_column_nibble(int nibble) {
  return nibble == kNibbleColumnLine || nibble == kNibbleColumnLine + 1;
}
bool is_opamp_nibble(int nibble) {
  return nibble == kNibbleOpAmp1 || nibble == kNibbleOpAmp2;
}
bool is_direct_nibble(int nibble) {
  return nibble == kNibbleDirect || nibble == kNibbleDirect + 1;
}

}  // namespace

CircuitNode Routes::Line::driver() const {
  return drivers.empty() ? CircuitNode{Kind::undriven, 0, 0} : drivers.front();
}

int Routes::nibble(int cell, Column column) const {
  const Nibble at = route_nibble(cell, column);
  const int byte = memory_.at(kIoBank, at.byte);
  return at.high ? byte >> 4 : byte & 0xF;
}

Routes::Routes(const MemoryImage& memory) : memory_(memory) {
  for (int cab = 1; cab <= kCabs; ++cab) {
    const Address at = line_drivers_at(cab);
    for (int opamp = 1; opamp <= kOpAmps; ++opamp) {
      for (int line = 1; line <= kLines; ++line) {
        if ((memory.at(at.bank, at.byte) & line_driver_bit(opamp, line)) != 0) {
          column_line(column_of(cab), line).drivers.push_back({Kind::opamp, cab, opamp});
        }
      }
    }
  }
  read_modes();
  for (const bool bypass : {false, true}) {
    for (int cell = 1; cell <= kIoCells; ++cell) {
      IoCell& c = cells_[static_cast<std::size_t>(cell - 1)];
      if ((cell >= kFirstBypassCell) != bypass) continue;
      if (bypass && c.mode == Mode::input && drives_out(cell)) c.mode = Mode::output;
      if (c.is_input()) input_cell(cell);
    }
  }
  for (int cell = 1; cell <= kIoCells; ++cell) {
    if (cells_[static_cast<std::size_t>(cell - 1)].is_output()) output_cell(cell);
  }
  check_lines();
}

void Routes::read_modes() {
  for (int number = 1; number <= kIoCells; ++number) {
    IoCell& cell = cells_[static_cast<std::size_t>(number - 1)];
    cell.number = number;
    const int mode = memory_.at(kIoBank, cell_bytes(number).mode);
    if (mode == 0) continue;
    cell.mode = Mode::unknown;
    if (number >= kFirstBypassCell) {
      if (mode == kModeBypass) cell.mode = Mode::input;  // or output: drives_out()
      continue;
    }
    if (mode == kModeInput) cell.mode = Mode::input;
    if (mode == kModeAmplifier) cell.mode = Mode::amplifier_input;
    if (mode == kModeOutput) cell.mode = Mode::output;
    if (mode == kModeBypass) cell.mode = Mode::unconnected;
    if (mode == kModeSampled) sampling(cell);
  }
}

void Routes::sampling(IoCell& cell) {
  const int option = memory_.at(kIoBank, cell_bytes(cell.number).option2) - kSampledBase;
  if (option < 0 || option >= 8 * 4 || option % 4 != 0) return;
  cell.mode = Mode::sampled_output;
  cell.sample_phase = option % 8 == kSampledPhase1 ? 1 : 2;
  cell.sample_clock = option / 8;
}

bool Routes::drives_out(int number) {
  bool line_is_driven = false;
  for (const Column column : kColumns) {
    const int n = nibble(number, column);
    if (is_opamp_nibble(n)) return true;
    if (is_direct_nibble(n)) return false;
    if (is_column_nibble(n)) {
      line_is_driven = line_is_driven || !column_line(column, n - kNibbleColumnLine + 1).drivers.empty();
    }
  }
  return line_is_driven;
}

void Routes::input_cell(int number) {
  for (const Column column : kColumns) {
    const int n = nibble(number, column);
    const CircuitNode pin{Kind::pin, 0, number};
    if (is_direct_nibble(n)) {
      const auto cab = static_cast<std::size_t>(cab_next_to(number, column) - 1);
      direct_lines_[cab][static_cast<std::size_t>(n - kNibbleDirect)].drivers.push_back(pin);
    } else if (is_column_nibble(n)) {
      column_line(column, n - kNibbleColumnLine + 1).drivers.push_back(pin);
    } else if (n != 0) {
      collisions_.push_back(
          fmt::format("IO{} is an input, but nibble {:X} of the {} column joins it to an output", number, n,
                      column_name(column)));
    }
  }
}

void Routes::output_cell(int number) {
  IoCell& cell = cells_[static_cast<std::size_t>(number - 1)];
  cell.source = {Kind::undriven, 0, 0};
  int sources = 0;
  for (const Column column : kColumns) {
    const int n = nibble(number, column);
    if (n == 0) continue;
    ++sources;
    if (is_opamp_nibble(n)) {
      cell.source = {Kind::opamp, cab_next_to(number, column), n == kNibbleOpAmp1 ? 1 : 2};
    } else if (is_column_nibble(n)) {
      cell.source = column_line(column, n - kNibbleColumnLine + 1).driver();
    } else {
      collisions_.push_back(
          fmt::format("IO{} is an output, but nibble {:X} of the {} column joins it to an input line", number,
                      n, column_name(column)));
    }
  }
  if (sources > 1) collisions_.push_back(fmt::format("IO{} is an output with two drivers", number));
}

void Routes::check_lines() {
  const auto check = [&](const Line& line, const std::string& name) {
    if (line.drivers.size() < 2) return;
    collisions_.push_back(
        fmt::format("{} has two drivers: {} and {}", name, line.drivers[0].text(), line.drivers[1].text()));
  };
  for (int line = 1; line <= kLines; ++line) {
    for (const Column column : kColumns) {
      check(column_line(column, line), fmt::format("column line {} ({})", line, column_name(column)));
    }
    for (int cab = 1; cab <= kCabs; ++cab) {
      check(direct_lines_[static_cast<std::size_t>(cab - 1)][static_cast<std::size_t>(line - 1)],
            fmt::format("direct line {} into CAB {}", line, cab));
    }
  }
}

CircuitNode Routes::node(int cab, int selector) const {
  const CircuitNode at = selected(cab, selector);
  if (at.kind == Kind::direct_line)
    return direct_lines_[static_cast<std::size_t>(cab - 1)][static_cast<std::size_t>(at.number - 1)].driver();
  if (at.kind != Kind::local_input) return at;
  const Address local = local_input_at(cab, at.number);
  const int line = memory_.at(local.bank, local.byte);
  if (line < 1 || line > kLines) return {Kind::undriven, 0, 0};
  return column_lines_[column_of(cab) == Column::odd ? 0 : 1][static_cast<std::size_t>(line - 1)].driver();
}

}  // namespace bodesmith::fpaa::an231
