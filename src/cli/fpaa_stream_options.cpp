#include "cli/fpaa_stream_options.hpp"
#include "base/json.hpp"

#include <fmt/format.h>

#include <map>

#include "fpaa/streams/stream_output.hpp"

namespace bodesmith::cli {
namespace {

/// chip1.out1=IO3.
std::map<std::string, int> chosen_cells(const CommandLine& line) {
  std::map<std::string, int> out;
  for (const std::string& text : line.all<std::string>("pin")) {
    const std::size_t cut = text.find("=IO");
    const std::string cell = cut == std::string::npos ? "" : text.substr(cut + 3);
    if (cut == 0 || cell.size() != 1 || cell[0] < '1' || cell[0] > '7') {
      line.fail(fmt::format("--pin '{}', expected for instance chip1.out1=IO3 (IO1 to IO7)", text));
    }
    out[text.substr(0, cut)] = cell[0] - '0';
  }
  return out;
}

}  // namespace

void add_stream_options(CommandLine& line) {
  line.flag("stream",
            "also complete configuration streams of the chips, without any vendor program: stream/chipN.ahf, "
            "primary.c, packets.bin, and how to power on for the first time");
  line.repeatable<std::string>("pin", "with --stream: I/O cell of a pin, e.g. chip1.out1=IO3");
}

std::optional<StreamArtefacts> make_streams(fpaa::Plan& plan, const CommandLine& line) {
  const std::map<std::string, int> cells = chosen_cells(line);
  if (!line.has("stream")) {
    if (!cells.empty()) line.fail("--pin without --stream, expected both");
    return std::nullopt;
  }
  const auto streams = value_or_throw(fpaa::an231::plan_streams(plan, {.cells = cells}));
  const double difference = fpaa::an231::check_streams(plan, streams);
  for (const fpaa::an231::PlanStreams::Chip& made : streams.chips) {
    for (fpaa::ChipPlan& chip : plan.chips) {
      if (chip.chip != made.chip) continue;
      for (const auto& [pin, cell] : made.built.pins) chip.pins[pin] = fmt::format("IO{}", cell);
    }
  }
  return StreamArtefacts{fpaa::an231::stream_files(plan, streams, "plan.json"),
                         std::make_shared<const Json>(fpaa::an231::stream_json(streams, difference)),
                         fpaa::an231::first_power_on(plan, streams) + "\n"};
}

}  // namespace bodesmith::cli
