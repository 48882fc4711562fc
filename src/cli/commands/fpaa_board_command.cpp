// The verbs of `bodesmith fpaa` that work on a finished plan: streams, verify, check, send.
#include <fmt/format.h>

#include <algorithm>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/sheets/report_check.hpp"
#include "fpaa/streams/board_link.hpp"
#include "fpaa/streams/stream_file.hpp"
#include "fpaa/streams/update_stream.hpp"

namespace bodesmith::cli {
namespace {

void add_project_options(CommandLine& line) {
  line.option<std::string>("api", "ApiCode.c of the project that the CAMs were typed into");
  line.repeatable("map", "PLAN=TABLE: name of a plan's capacitor in the project's tables");
  line.flag("no-clocks", "leave the clock divisors alone");
}

fpaa::ApiProject read_project(const CommandLine& line, Provenance& from) {
  if (!line.has("api")) line.fail("--api is missing, expected the project's ApiCode.c");
  const std::string path = line.get<std::string>("api");
  return fpaa::parse_api_code(from.read(path), path);
}

fpaa::UpdateOptions update_options(const CommandLine& line) {
  fpaa::UpdateOptions out;
  out.clocks = !line.has("no-clocks");
  for (const std::string& pair : line.all<std::string>("map")) {
    const std::size_t cut = pair.find('=');
    if (cut == std::string::npos || cut == 0 || cut + 1 == pair.size()) {
      line.fail(fmt::format("--map '{}', expected PLAN=TABLE", pair));
    }
    out.names[pair.substr(0, cut)] = pair.substr(cut + 1);
  }
  return out;
}

std::vector<fpaa::Bytes> read_streams(const std::string& path, Provenance& from) {
  std::vector<fpaa::Bytes> out;
  for (fpaa::FoundStream& one : fpaa::find_streams(from.read(path), path))
    out.push_back(std::move(one.bytes));
  return out;
}

int finish_comparison(const CommandLine& line, const std::string& name, const Provenance& from,
                      const std::vector<std::string>& differences, double seconds) {
  const Json summary = timed_document(name, from, {{"differences", differences}}, seconds);
  std::string text;
  for (const std::string& difference : differences) text += difference + "\n";
  text += differences.empty()
              ? "no differences\n"
              : fmt::format("{} difference{}\n", differences.size(), differences.size() == 1 ? "" : "s");
  return print_summary(line, text, summary, differences.empty());
}

}  // namespace

int run_fpaa_streams(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fpaa streams", "bodesmith fpaa streams out/fpaa/plan.json --api ApiCode.c -o out/streams",
      "Turns a plan into update streams for a project whose CAMs bear the build sheet's names: AHF, C "
      "arrays,\nC calls of the generated API, and the board's serial packets.");
  line.positional("PLAN.json", 1, 1);
  line.output("folder for the streams");
  add_project_options(line);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  const fpaa::Plan plan = fpaa::Plan::read(line.files()[0], from);
  const fpaa::ApiProject project = read_project(line, from);
  const fpaa::UpdateOptions options = update_options(line);

  const Stopwatch watch;
  OutputSet out(line.output_path());
  std::vector<std::pair<std::string, fpaa::Bytes>> arrays;
  std::string packets;
  Json chips = Json::array();
  for (const fpaa::ChipPlan& chip : plan.chips) {
    const fpaa::ConfigStream stream = fpaa::update_stream(chip, project, options);
    const fpaa::Bytes bytes = fpaa::encode(stream);
    const std::string name = fmt::format("update_chip{}", chip.chip);
    out.add(name + ".ahf", fpaa::to_ahf(bytes));
    arrays.emplace_back(name, bytes);
    packets += fpaa::to_packet(bytes, false);
    chips.push_back({{"chip", chip.chip}, {"address1", stream.address1}, {"bytes", bytes.size()}});
  }
  out.add("update_streams.c", fpaa::c_arrays(arrays, line.files()[0]));
  out.add("set_capacitors.c", fpaa::c_calls(plan, project, options, line.files()[0]));
  out.add("packets.bin", packets);
  out.commit();
  const Json summary = timed_document("fpaa_streams", from, {{"chips", chips}}, watch.seconds());
  std::string text;
  for (const auto& [name, bytes] : arrays) text += fmt::format("{}: {} bytes\n", name, bytes.size());
  return print_summary(line, text + fmt::format("written to {}\n", line.output_path().string()), summary);
}

void add_verify_options(CommandLine& line);
int verify_complete_streams(const CommandLine& line);

int run_fpaa_verify(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fpaa verify", "bodesmith fpaa verify out/fpaa/plan.json out/fpaa/stream/packets.bin --sections s.json",
      "Complete streams (AHF, C arrays, board packets, raw; updates after their primary): what the bytes would "
      "do\nagainst a plan or sections (PLAN.json may be a SECTIONS.json): dB, degrees, percent over a band.\n"
      "With --api (update streams for a project of your own): every capacitor and divisor against the plan.\n"
      "Exit status 1 when they differ, or miss a limit.");
  line.positional("PLAN.json STREAM…", 2, -1);
  add_project_options(line);
  add_verify_options(line);
  if (!line.parse(arguments)) return kDone;
  if (!line.has("api")) return verify_complete_streams(line);
  Provenance from;
  const std::vector<std::string> files = line.files();
  const fpaa::Plan plan = fpaa::Plan::read(files[0], from);
  const fpaa::ApiProject project = read_project(line, from);
  const fpaa::UpdateOptions options = update_options(line);
  const Stopwatch watch;
  std::vector<std::string> differences;
  for (auto file = files.begin() + 1; file != files.end(); ++file) {
    for (const fpaa::Bytes& bytes : read_streams(*file, from)) {
      const fpaa::ConfigStream stream = fpaa::decode(bytes, *file);
      const auto chip = std::ranges::find_if(plan.chips, [&](const fpaa::ChipPlan& c) {
        const auto number = static_cast<std::size_t>(c.chip - 1);
        return number < project.chips.size() && project.chips[number].address1 == stream.address1;
      });
      if (chip == plan.chips.end()) {
        differences.push_back(
            fmt::format("{}: Address1 {} belongs to no chip of the plan", *file, stream.address1));
        continue;
      }
      for (const std::string& difference : fpaa::compare_with_plan(stream, *chip, project, options)) {
        differences.push_back(fmt::format("{}: {}", *file, difference));
      }
    }
  }
  return finish_comparison(line, "fpaa_verify", from, differences, watch.seconds());
}

int run_fpaa_check(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fpaa check", "bodesmith fpaa check out/fpaa/plan.json project.htm",
      "Reads AnadigmDesigner2's HTML report and lists every difference from a plan. Exit status 1 when "
      "there is one.");
  line.positional("PLAN.json REPORT.htm", 2, 2);
  line.option<double>("tolerance", "largest relative difference of a parameter (the report rounds)", 0.005);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  const fpaa::Plan plan = fpaa::Plan::read(line.files()[0], from);
  const std::string path = line.files()[1];
  const fpaa::DesignerReport report = fpaa::read_report(from.read(path), path);
  const Stopwatch watch;
  const auto differences = fpaa::compare_report(report, plan, line.positive("tolerance"));
  return finish_comparison(line, "fpaa_check", from, differences, watch.seconds());
}

int run_fpaa_send(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fpaa send", "bodesmith fpaa send out/streams/packets.bin --port /dev/ttyUSB0",
      "Sends board packets over a serial port (57600 8N1): asks the board for its identity and number of chips, sends,\n"
      "and asks for the status after each packet.");
  line.positional("PACKETS.bin", 1, 1);
  line.option<std::string>("port", "serial device");
  line.flag("dry-run", "decode and show the packets, send nothing");
  line.option<double>("timeout-s", "longest wait for a byte of a reply", 1.0);
  line.option<int>("retries", "retries of a query", 3);
  if (!line.parse(arguments)) return kDone;
  const bool dry = line.has("dry-run");
  if (!dry && !line.has("port")) line.fail("--port is missing, expected the serial device (or --dry-run)");
  Provenance from;
  const std::string path = line.files()[0];
  fpaa::LinkOptions options;
  options.timeout_s = line.positive("timeout-s");
  options.retries = line.integer("retries", 0, 1000);

  std::vector<std::string> packets;
  std::string text;
  int chips = 0;
  Json list = Json::array();
  for (const fpaa::Packet& packet : fpaa::from_packets(from.read(path), path)) {
    const fpaa::ConfigStream stream = fpaa::decode(packet.bytes, path);
    chips = std::max(chips, stream.address1);
    packets.push_back(fpaa::to_packet(packet.bytes, packet.primary));
    text += fmt::format("packet {}: {} to Address1 {}, {} blocks, {} bytes{}\n", packets.size(),
                        stream.primary ? "primary" : "update", stream.address1, stream.blocks.size(),
                        packet.bytes.size(), packet.primary ? ", resets the board" : "");
    list.push_back({{"address1", stream.address1},
                    {"primary", stream.primary},
                    {"resets_board", packet.primary},
                    {"bytes", packet.bytes.size()}});
  }
  Json summary = json_header("fpaa_send", from);
  summary["dry_run"] = dry;
  summary["packets"] = list;
  const Stopwatch watch;
  if (!dry) {
    const auto port = fpaa::open_serial_port(line.get<std::string>("port"));
    const fpaa::LinkReport report = fpaa::send_packets(*port, packets, chips, options);
    summary["identity"] = report.identity;
    summary["chips"] = report.chips;
    summary["status"] = report.status;
    text += fmt::format("board: {}, {} chips\n", report.identity, report.chips);
    for (std::size_t i = 0; i < report.status.size(); ++i)
      text += fmt::format("after packet {}: {}\n", i + 1, report.status[i]);
  } else {
    text += "nothing sent (--dry-run)\n";
  }
  summary["timing_s"] = {{"compute", watch.seconds()}};
  return print_summary(line, text, summary);
}

}  // namespace bodesmith::cli
