#include "fpaa/streams/stream_check.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bodesmith::fpaa::an231 {
namespace {

constexpr std::size_t kMostDifferences = 40;

}  // namespace

PlanError stream_error(const BoardCircuit& board, const SignalPins& pins, Band band,
                       const WantedResponse& wanted_response) {
  const PeriodicNetworks networks = pin_networks(board, pins.input, pins.output);
  const std::vector<Hertz> grid = log_grid(band, kStatedPoints);
  std::vector<Complex> got;
  std::vector<Complex> wanted;
  for (const Hertz f : grid) {
    got.push_back(networks.gain(f.rad_s()));
    wanted.push_back(wanted_response(f.rad_s()));
  }
  return {compare_responses(grid, got, wanted), band};
}

PinCells plan_cells(const Plan& plan) {
  PinCells out;
  for (const ChipPlan& chip : plan.chips) {
    for (const auto& [pin, cell] : chip.pins) {
      if (cell.size() == 3 && cell.compare(0, 2, "IO") == 0 && cell[2] >= '1' && cell[2] <= '7')
        out[fmt::format("chip{}.{}", chip.chip, pin)] = cell[2] - '0';
    }
  }
  return out;
}

std::string address_text(Address at) {
  for (const Constant& c : kConstants) {
    if (c.address.bank == at.bank && c.address.byte == at.byte) return c.what;
  }
  for (int k = 0; k < kClocks; ++k) {
    if (at.bank == 0 && at.byte == clock_divisor_at(k).byte) return fmt::format("divisor of Clock {}", k);
  }
  if (at.bank == 0) return at.byte == kClockPower.byte ? "clocks that are on" : "chip";
  if (at.bank == kIoBank) return "I/O cells and their routes";
  if (at.bank < 3 || at.bank > 2 + 2 * kCabs) return "chip";
  const int cab = (at.bank - 1) / 2;
  for (int c = 1; c <= kCapacitors; ++c) {
    const Address value = capacitor_at(cab, c);
    const Address words = switches_at(cab, c);
    if (at.bank == value.bank && at.byte == value.byte) return fmt::format("C{} of CAB {}", c, cab);
    if (at.bank == words.bank && at.byte >= words.byte && at.byte < words.byte + 4) {
      return fmt::format("switches of C{} of CAB {}", c, cab);
    }
  }
  return fmt::format("op-amps, clocks and lines of CAB {}", cab);
}

Outcome<std::vector<std::string>> memory_differences(const Plan& plan, const std::vector<ChipImage>& chips) {
  const auto made = plan_streams(plan, plan_cells(plan));
  if (const Refusal* refusal = refusal_of(made)) return *refusal;
  std::vector<std::string> out;
  for (const PlanStreams::Chip& wanted : std::get<PlanStreams>(made).chips) {
    const auto chip = std::ranges::find(chips, wanted.chip, &ChipImage::address1);
    if (chip == chips.end()) {
      out.push_back(fmt::format("there is no stream for chip {}", wanted.chip));
      continue;
    }
    for (const auto& [at, should] : changed_bytes(chip->memory, wanted.memory)) {
      if (out.size() >= kMostDifferences) break;
      out.push_back(fmt::format("chip {} bank {} byte {}: is {:02X}, the plan has {:02X} ({})", wanted.chip,
                                at.bank, at.byte, chip->memory.at(at.bank, at.byte), should,
                                address_text(at)));
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa::an231
