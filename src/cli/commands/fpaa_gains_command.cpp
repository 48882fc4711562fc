#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "fpaa/gains/gain_schedule.hpp"

namespace bodesmith::cli {
namespace {

void add_gain_options(CommandLine& line) {
  line.positional("DISTURBANCE.json", 1, 1);
  line.output("folder for gains.json, gains.csv, gains.md, gain_host.c, gain_host.py, streams and packets");
  line.option<std::string>("api", "ApiCode.c of the project on the board");
  line.option<std::string>("ascending",
                           "where the ascending branch's gain stands: CHIP.CAM, CHIP.CAM:Cin1/Cout, "
                           "CHIP.CAM:Cin1/200 (units that stay), or ADDRESS1:BANK.BYTE/BANK.BYTE");
  line.option<std::string>("descending", "the same of the descending branch");
  line.option<double>("ascending-gain", "Cin/Cout where the table's gain is 1", 1.0);
  line.option<double>("descending-gain", "the same of the descending branch", 1.0);
  line.option<double>("step-percent", "largest step of a gain between neighbouring sets", 0.2);
}

std::vector<fpaa::GainBranch> gain_branches(const CommandLine& line, Provenance& from) {
  using Branch = Disturbance::Branch;
  std::optional<fpaa::ApiProject> project;
  if (line.has("api")) {
    const std::string path = line.get<std::string>("api");
    project = fpaa::parse_api_code(from.read(path), path);
  }
  std::vector<fpaa::GainBranch> out;
  for (const auto& [branch, name] :
       {std::pair{Branch::ascending, "ascending"}, std::pair{Branch::descending, "descending"}}) {
    if (!line.has(name)) continue;
    const std::string text = line.get<std::string>(name);
    out.push_back({branch,
                   fpaa::parse_gain_place(text, project ? &*project : nullptr, fmt::format("--{}", name)),
                   line.positive(fmt::format("{}-gain", name))});
  }
  return out;
}

std::vector<fpaa::GainBranch> branches_to_better(const fpaa::GainSchedule& schedule) {
  std::vector<fpaa::GainBranch> out;
  for (const fpaa::GainBranch& b : schedule.branches) {
    if (b.better_at_one > 0.0 && b.better_error_percent < 0.5 * schedule.max_ratio_error_percent)
      out.push_back(b);
  }
  return out;
}

void write_gains(const std::filesystem::path& folder, const fpaa::GainSchedule& schedule, const Json& json,
                 const std::string& file) {
  OutputSet out(folder);
  out.add("gains.json", to_text(json));
  out.add("gains.csv", schedule.csv());
  out.add("gains.md", fpaa::gain_sheet(schedule, file));
  out.add("gain_host.c", fpaa::gain_host_c(schedule, file));
  out.add("gain_host.py", fpaa::gain_host_python(schedule, file));
  for (std::size_t i = 0; i < schedule.sets.size(); ++i) {
    const fpaa::GainSet& set = schedule.sets[i];
    for (const auto& [address1, bytes] : set.streams)
      out.add(fmt::format("streams/set{:03}_address{}.ahf", i, address1), fpaa::to_ahf(bytes));
    out.add(fmt::format("packets/set{:03}.bin", i), schedule.packets(set));
  }
  out.commit();
}

}  // namespace

int run_fpaa_gains(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fpaa gains",
      "bodesmith fpaa gains disturbance.json --api ApiCode.c --descending FPAA1.GainInv2 -o out/gains",
      "Rate dependence by a host: a table of capacitor sets (the rate gain of each branch at each frequency of\n"
      "the disturbance's table and between), their update streams, and a host's loop in C and in Python that\n"
      "takes the frequency or measures it from samples of the reference and sends the set that serves it.");
  add_gain_options(line);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  const std::string file = line.files()[0];
  const Disturbance disturbance = Disturbance::read(file, from);
  const std::vector<fpaa::GainBranch> branches = gain_branches(line, from);

  const Stopwatch watch;
  const fpaa::GainSchedule schedule =
      fpaa::make_gain_schedule(disturbance, branches, line.positive("step-percent"), file);
  Json json = timed_document("fpaa_gains", from, schedule.to_json(), watch.seconds());
  for (const fpaa::GainBranch& b : branches_to_better(schedule)) {
    note(fmt::format("{}: with a gain of {} at 1 its capacitor ratios would be within {} % instead of {} %",
                     b.place.words, rounded_text(b.better_at_one), rounded_text(b.better_error_percent, 2),
                     rounded_text(schedule.max_ratio_error_percent, 2)));
  }
  write_gains(line.output_path(), schedule, json, file);
  const std::string text = fmt::format(
      "{} sets from {} to {} Hz; gains within {} %, of the stroke {} % at most; {} ms a set on the line\n"
      "written to {}\n",
      schedule.sets.size(), rounded_text(schedule.sets.front().frequency.value),
      rounded_text(schedule.sets.back().frequency.value), rounded_text(schedule.max_gain_error_percent, 2),
      rounded_text(schedule.max_tracking_error_percent, 2), rounded_text(1e3 * schedule.update_s, 2),
      line.output_path().string());
  return print_summary(line, text, json);
}

}  // namespace bodesmith::cli
