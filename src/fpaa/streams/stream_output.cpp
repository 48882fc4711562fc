#include "fpaa/streams/stream_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "fpaa/streams/board_networks.hpp"
#include "fpaa/streams/c_source.hpp"

namespace bodesmith::fpaa::an231 {
namespace {

constexpr int kCheckedPoints = 24;
constexpr double kLargestDifference = 1e-9;
constexpr int kToneCount = 5;
constexpr double kLargestTone = 0.5;  ///< V
constexpr double kToneShare = 0.25;   ///< of the largest input

SignalPins ends_of(const Plan& plan, const PlanStreams& streams) {
  const auto ends = end_pins(plan, streams.cells);
  if (!ends) throw DesignError("the plan's wires lead from no input pin to an output pin");
  return *ends;
}

PeriodicNetworks read_back_networks(const Plan& plan, const PlanStreams& streams) {
  const SignalPins ends = ends_of(plan, streams);
  return pin_networks(read_back(plan, streams), ends.input, ends.output);
}

/// Two digits are enough to set a generator.
double round_tone(double hz) {
  const double step = std::pow(10.0, std::floor(std::log10(hz)) - 1.0);
  return std::round(hz / step) * step;
}

std::string cell_text(const BoardPin& pin) {
  return fmt::format("chip {} IO{}", pin.chip, pin.cell);
}

Json wires_outside(const BoardCircuit& board) {
  Json out = Json::array();
  for (const PinLink& link : board.links)
    out.push_back({{"from", cell_text(link.from)}, {"to", cell_text(link.to)}});
  return out;
}

}  // namespace

double check_streams(const Plan& plan, const PlanStreams& streams) {
  for (const PlanStreams::Chip& chip : streams.chips) {
    const ChipCircuit circuit = read_circuit(chip.memory, chip.chip);
    if (!circuit.problems.empty()) {
      throw DesignError(fmt::format("chip {}: {}", chip.chip, circuit.problems.front()));
    }
  }
  const PeriodicNetworks got = read_back_networks(plan, streams);
  // The streams say nothing of how late op-amps and switches are.
  Plan at_once = plan;
  at_once.slow = {};
  const SwitchedBoard wanted(at_once);
  double worst = 0.0;
  for (const Hertz f : log_grid(plan.error.band, kCheckedPoints)) {
    const RadPerSecond w = f.rad_s();
    const Complex b = wanted.gain(w);
    const double difference = std::abs(got.gain(w) - b) / std::max(std::abs(b), 1e-12);
    if (!(difference <= kLargestDifference)) {
      throw DesignError(fmt::format("the stream differs from the plan by {} % at {} Hz and is not written",
                                    rounded_text(100.0 * difference), rounded_text(f.value)));
    }
    worst = std::max(worst, difference);
  }
  return 100.0 * worst;
}

std::string first_power_on(const Plan& plan, const PlanStreams& streams) {
  const SignalPins ends = ends_of(plan, streams);
  const PeriodicNetworks runs = read_back_networks(plan, streams);
  const double limit = plan.max_input_v > 0.0 ? plan.max_input_v : kFullScaleV;
  const double tone = std::min(kLargestTone, kToneShare * limit);
  Json data;
  data["status"] = kStreamStatus;
  data["input"] = cell_text(ends.input);
  data["output"] = cell_text(ends.output);
  data["tone_v"] = rounded_text(tone, 2);
  data["limit_v"] = rounded_text(limit, 3);
  data["chips"] = streams.chips.size();
  data["many"] = streams.chips.size() > 1;
  data["wires"] = wires_outside(read_back(plan, streams));
  data["readings"] = Json::array();
  for (const Hertz f : log_grid(plan.error.band, kToneCount)) {
    const double hz = round_tone(f.value);
    const Complex h = runs.gain(Hertz{hz}.rad_s());
    data["readings"].push_back({{"hz", rounded_text(hz)},
                                {"gain_db", fmt::format("{:.2f}", to_decibel(std::abs(h)))},
                                {"phase_deg", fmt::format("{:.1f}", std::arg(h) * 180.0 / std::numbers::pi)},
                                {"out_v", fmt::format("{:.3f}", tone * std::abs(h))}});
  }
  data["warnings"] = streams.warnings;
  data["constants"] = Json::array();
  for (const Constant& c : kConstants) {
    data["constants"].push_back({{"place", fmt::format("{:X}:{:02X}", c.address.bank, c.address.byte)},
                                 {"value", fmt::format("{:02X}", c.value)},
                                 {"what", c.what}});
  }
  return render_template("fpaa/first_power_on.md", data);
}

OutputSet configuration_files(const PlanStreams& streams, const std::string& plan_file) {
  OutputSet out;
  Json data;
  data["plan"] = plan_file;
  data["status"] = kStreamStatus;
  data["arrays"] = Json::array();
  std::string packets;
  for (std::size_t i = 0; i < streams.chips.size(); ++i) {
    const PlanStreams::Chip& chip = streams.chips[i];
    ConfigStream sparse = primary_stream(chip.memory, chip.chip, StreamForm::sparse);
    const Bytes bytes = encode(sparse);
    out.add(fmt::format("chip{}.ahf", chip.chip),
            to_ahf(encode(primary_stream(chip.memory, chip.chip, StreamForm::whole))));
    Json pins = Json::array();
    for (const auto& [pin, cell] : streams.pins_of(chip.chip)) pins.push_back({{"pin", pin}, {"cell", cell}});
    data["arrays"].push_back({{"chip", chip.chip},
                              {"name", fmt::format("primary_chip{}", chip.chip)},
                              {"count", bytes.size()},
                              {"pins", std::move(pins)},
                              {"rows", c_rows(bytes)}});
    // As the public host program sends them: chip 1 as '0' with five zeros before and one after, the others as
    // '1' (so that the board is not reset again) with one after.
    sparse.leading_zeros = i == 0 ? 5 : 0;
    sparse.trailing_zeros = 1;
    packets += to_packet(encode(sparse), i == 0);
  }
  out.add("primary.c", render_template("fpaa/primary.c", data));
  out.add("packets.bin", packets);
  return out;
}

OutputSet stream_files(const Plan& plan, const PlanStreams& streams, const std::string& plan_file) {
  OutputSet out = configuration_files(streams, plan_file);
  out.add("first_power_on.md", first_power_on(plan, streams));
  return out;
}

Json stream_json(const PlanStreams& streams, double difference_percent) {
  Json out;
  out["status"] = kStreamStatus;
  out["largest_difference_percent"] = difference_percent;
  out["chips"] = Json::array();
  for (const PlanStreams::Chip& chip : streams.chips) {
    const auto size = [&](StreamForm form) {
      return encode(primary_stream(chip.memory, chip.chip, form)).size();
    };
    out["chips"].push_back({{"chip", chip.chip},
                            {"address1", chip.chip},
                            {"c_array_bytes", size(StreamForm::sparse)},
                            {"ahf_bytes", size(StreamForm::whole)},
                            {"pins", streams.pins_of(chip.chip)}});
  }
  out["constants"] = Json::array();
  for (const Constant& c : kConstants) {
    out["constants"].push_back({{"bank", c.address.bank},
                                {"byte", c.address.byte},
                                {"value", fmt::format("{:02X}", c.value)},
                                {"what", c.what}});
  }
  out["warnings"] = streams.warnings;
  return out;
}

}  // namespace bodesmith::fpaa::an231
