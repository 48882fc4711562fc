// `bodesmith fpaa disassemble`: what the bytes of any AN231 stream make.
#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "fpaa/streams/netlist.hpp"

namespace bodesmith::cli {
namespace {

struct Disassembly {
  Json json;
  std::string text;
  std::size_t problems = 0;
  std::size_t unexplained = 0;
};

Disassembly disassemble(const std::vector<fpaa::FoundStream>& streams, Hertz master) {
  Disassembly out;
  out.json["streams"] = fpaa::an231::streams_json(streams);
  out.json["boards"] = Json::array();
  for (const fpaa::an231::LoadedBoard& loaded : fpaa::an231::load_boards(streams)) {
    const fpaa::an231::BoardCircuit board = fpaa::an231::read_board(loaded, master);
    Json one = fpaa::an231::board_json(board);
    one["notes"] = loaded.notes;
    out.json["boards"].push_back(std::move(one));
    out.text += fpaa::an231::board_text(board);
    for (const std::string& note : loaded.notes) out.text += "note: " + note + "\n";
    for (const fpaa::an231::ChipCircuit& chip : board.chips) {
      out.problems += chip.problems.size();
      out.unexplained += chip.unexplained.size();
    }
  }
  // One board is the rule: its chips and stages then stand at the top.
  if (out.json["boards"].size() == 1) {
    for (const char* key : {"chips", "stages", "notes"}) out.json[key] = out.json["boards"][0][key];
    out.json.erase("boards");
  }
  return out;
}

}  // namespace

int run_fpaa_disassemble(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fpaa disassemble", "bodesmith fpaa disassemble stream/chip1.ahf -o netlist.json",
      "Reads AN231 configuration streams (AHF, C source, board packets, raw bytes) back to a "
      "netlist: clocks,\ncapacitors and their switches, op-amps, routes, I/O cells, and the z "
      "transfer of every stage by charge balance.\nUpdates are laid over the primary before them. "
      "What is not understood is listed.");
  line.positional("STREAM…", 1, -1);
  line.output("netlist.json (bodesmith.fpaa_netlist/1)", true);
  line.option<double>("master-clock-hz", "ACLK", 16e6);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  std::vector<fpaa::FoundStream> streams;
  for (const std::string& path : line.files()) {
    for (fpaa::FoundStream& s : fpaa::find_streams(from.read(path), path)) streams.push_back(std::move(s));
  }
  const Stopwatch watch;
  Disassembly made = disassemble(streams, {line.positive("master-clock-hz")});
  Json json = timed_document("fpaa_netlist", from, made.json, watch.seconds());
  if (line.has("output")) write_file(line.output_path(), to_text(json));
  made.text += fmt::format("{} stream{}, {} problem{}, {} byte{} not understood\n", streams.size(),
                           streams.size() == 1 ? "" : "s", made.problems, made.problems == 1 ? "" : "s",
                           made.unexplained, made.unexplained == 1 ? "" : "s");
  return print_summary(line, made.text, json);
}

}  // namespace bodesmith::cli
