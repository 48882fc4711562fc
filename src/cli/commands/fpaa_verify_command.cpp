// `bodesmith fpaa verify` on complete streams: what the bytes would do, against a plan or sections.
#include <fmt/format.h>

#include <optional>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "fpaa/streams/plan_stream.hpp"
#include "fpaa/streams/stream_check.hpp"

namespace bodesmith::cli {
namespace {

using fpaa::an231::BoardPin;

/// Largest difference between a plan and its own stream that is rounding.
constexpr double kRoundingPercent = 1e-7;

/// "chip1.IO3".
BoardPin board_pin(const CommandLine& line, const std::string& text) {
  const std::size_t dot = text.find(".IO");
  double chip = 0.0;
  const bool good = text.compare(0, 4, "chip") == 0 && dot != std::string::npos && dot + 4 == text.size() &&
                    parse_number(text.substr(4, dot - 4), chip) && chip >= 1 && chip <= 255 &&
                    text[dot + 3] >= '1' && text[dot + 3] <= '7';
  if (!good) line.fail(fmt::format("'{}' is no pin, expected for instance chip1.IO3", text));
  return {static_cast<int>(chip), text[dot + 3] - '0'};
}

/// What the streams are held against.
struct VerifyReference {
  std::optional<fpaa::Plan> plan;
  std::optional<Sections> sections;
};

VerifyReference read_verify_reference(const CommandLine& line, Provenance& from) {
  VerifyReference out;
  const Node first = read_document(line.files()[0], from);
  if (first.has("schema") && first.at("schema").string() == "bodesmith.sections/1") {
    out.sections = Sections::from_node(first);
  } else {
    out.plan = fpaa::Plan::from_node(first);
  }
  if (const auto path = line.maybe<std::string>("sections")) out.sections = Sections::read(*path, from);
  return out;
}

Band verify_band(const CommandLine& line, const VerifyReference& reference) {
  if (const auto band = line.maybe_band()) return *band;
  if (reference.plan) return reference.plan->error.band;
  if (reference.sections->error) return reference.sections->error->band;
  Band band = reference.sections->corner_band();
  if (!(band.from.value > 0.0)) line.fail("--from-hz and --to-hz are missing: the sections have no corners");
  if (band.from.value >= band.to.value) band = {{0.1 * band.from.value}, {10.0 * band.to.value}};
  return band;
}

void add_wires(const CommandLine& line, const VerifyReference& reference, fpaa::an231::BoardCircuit& board) {
  if (reference.plan)
    fpaa::an231::add_links(board, *reference.plan, fpaa::an231::plan_cells(*reference.plan));
  for (const std::string& wire : line.all<std::string>("wire")) {
    const std::size_t cut = wire.find('=');
    if (cut == std::string::npos) line.fail(fmt::format("--wire '{}', expected chip1.IO3=chip2.IO1", wire));
    const fpaa::an231::PinLink link{board_pin(line, wire.substr(0, cut)),
                                    board_pin(line, wire.substr(cut + 1))};
    for (const int chip : {link.from.chip, link.to.chip}) {
      if (!board.index_of(chip)) line.fail(fmt::format("there is no stream for chip {}", chip));
    }
    board.links.push_back(link);
  }
}

/// By option, by the plan, or the only ones there are.
fpaa::an231::SignalPins verified_pins(const CommandLine& line, const VerifyReference& reference,
                                      const fpaa::an231::BoardCircuit& board) {
  fpaa::an231::SignalPins pins;
  const auto input = line.maybe<std::string>("input");
  const auto output = line.maybe<std::string>("output");
  if (reference.plan && !(input && output)) {
    if (const auto ends = fpaa::an231::end_pins(*reference.plan, fpaa::an231::plan_cells(*reference.plan)))
      pins = *ends;
  }
  if (pins.output == pins.input && !(input && output)) {
    pins = value_or_throw(fpaa::an231::signal_pins(board));
  }
  if (input) pins.input = board_pin(line, *input);
  if (output) pins.output = board_pin(line, *output);
  return pins;
}

std::string verify_error_text(const char* what, const fpaa::PlanError& e) {
  return fmt::format("{}: at most {} dB, {} deg, {} % (at {} Hz) from {} to {} Hz\n", what,
                     rounded_text(e.max_magnitude_db), rounded_text(e.max_phase_deg),
                     rounded_text(e.max_complex_percent), rounded_text(e.worst.value),
                     rounded_text(e.band.from.value), rounded_text(e.band.to.value));
}

fpaa::an231::LoadedBoard read_one_board(const CommandLine& line, Provenance& from) {
  std::vector<fpaa::FoundStream> streams;
  const std::vector<std::string> files = line.files();
  for (auto file = files.begin() + 1; file != files.end(); ++file) {
    for (fpaa::FoundStream& s : fpaa::find_streams(from.read(*file), *file)) streams.push_back(std::move(s));
  }
  std::vector<fpaa::an231::LoadedBoard> boards = fpaa::an231::load_boards(streams);
  if (boards.size() != 1) {
    line.fail(
        fmt::format("the streams are those of {} boards (an Address1 has two primaries), expected one board",
                    boards.size()));
  }
  return std::move(boards.front());
}

struct Verdict {
  Json json;
  std::string text;
  bool differs = false;
};

void hold_against(const CommandLine& line, const fpaa::an231::BoardCircuit& board,
                  const VerifyReference& reference, Verdict& out) {
  const auto pins = verified_pins(line, reference, board);
  const Band band = verify_band(line, reference);
  const auto error = [&](const fpaa::an231::WantedResponse& wanted) {
    return fpaa::an231::stream_error(board, pins, band, wanted);
  };
  out.json["input"] = fmt::format("chip{}.IO{}", pins.input.chip, pins.input.cell);
  out.json["output"] = fmt::format("chip{}.IO{}", pins.output.chip, pins.output.cell);
  if (reference.plan) {
    const fpaa::SwitchedBoard plan(*reference.plan);
    const auto e = error([&](RadPerSecond w) { return plan.gain(w); });
    out.json["plan"] = {{"error_with_delays", e.to_json()}};
    out.text += verify_error_text("bytes against the plan", e);
    const bool limited = line.has("max-error-percent");
    out.differs =
        out.differs || (!limited && e.max_complex_percent > kRoundingPercent) ||
        (limited && !reference.sections && e.max_complex_percent > line.get<double>("max-error-percent"));
  }
  if (!reference.sections) return;
  const auto e = error([&](RadPerSecond w) { return reference.sections->response(w); });
  out.json["sections"] = {{"error_with_delays", e.to_json()}};
  out.text += verify_error_text("bytes against the sections", e);
  const auto above = [&](const char* option, double value) {
    const auto limit = line.maybe<double>(option);
    if (!limit || value <= *limit) return;
    out.text += fmt::format("NOT met: --{} {}\n", option, *limit);
    out.differs = true;
  };
  above("max-error-percent", e.max_complex_percent);
  above("max-error-db", e.max_magnitude_db);
  above("max-error-deg", e.max_phase_deg);
}

}  // namespace

void add_verify_options(CommandLine& line) {
  line.option<std::string>("sections", "sections.json: also what the bytes would do against these");
  line.option<std::string>("input", "the pin where the signal enters, e.g. chip1.IO1 (default: the plan's)");
  line.option<std::string>("output", "the pin where it leaves");
  line.repeatable("wire", "a wire outside the chips when no plan says so, e.g. chip1.IO3=chip2.IO1");
  line.band("lower end of the band (default: the plan's, or the sections')", "its upper end");
  line.option<double>(
      "max-error-percent",
      "exit with 1 when the complex error of the board as it runs, all clocks and holds in it, is "
      "above this");
  line.option<double>("max-error-db", "the same for the magnitude");
  line.option<double>("max-error-deg", "the same for the phase");
}

int verify_complete_streams(const CommandLine& line) {
  Provenance from;
  const VerifyReference reference = read_verify_reference(line, from);
  const fpaa::an231::LoadedBoard loaded = read_one_board(line, from);
  const Stopwatch watch;
  const Hertz master = reference.plan ? reference.plan->chips.at(0).master_clock : Hertz{16e6};
  fpaa::an231::BoardCircuit board = fpaa::an231::read_board(loaded, master);
  Verdict verdict;
  std::vector<std::string> differences;
  if (reference.plan) {
    auto bytes = fpaa::an231::memory_differences(*reference.plan, loaded.chips);
    if (const Refusal* refusal = refusal_of(bytes)) {
      verdict.text += fmt::format("not compared byte by byte: {}\n", refusal->reason);
    } else {
      differences = std::get<std::vector<std::string>>(std::move(bytes));
    }
  }
  for (const fpaa::an231::ChipCircuit& chip : board.chips) {
    for (const std::string& p : chip.problems)
      differences.push_back(fmt::format("chip {}: {}", chip.address1, p));
  }
  add_wires(line, reference, board);
  Json json = json_header("fpaa_verify", from);
  try {
    hold_against(line, board, reference, verdict);
  } catch (const DesignError& error) {
    // Bytes that make nothing have no response: a difference, when something else has been found.
    if (differences.empty()) throw;
    differences.push_back(error.what());
  }
  json.update(verdict.json);
  json["differences"] = differences;
  json["timing_s"] = {{"compute", watch.seconds()}};
  std::string text;
  for (const std::string& d : differences) text += d + "\n";
  text += verdict.text;
  text += differences.empty()
              ? "no differences in the bytes\n"
              : fmt::format("{} difference{}\n", differences.size(), differences.size() == 1 ? "" : "s");
  print_summary(line, text, json);
  // With a limit the limit decides; without one every difference does.
  const bool limited = line.has("max-error-percent") || line.has("max-error-db") || line.has("max-error-deg");
  return verdict.differs || (!limited && !differences.empty()) ? kLimitMissed : kDone;
}

}  // namespace bodesmith::cli
