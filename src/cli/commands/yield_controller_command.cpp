#include <fmt/format.h>

#include <algorithm>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "schematic/opamp_library.hpp"
#include "tolerance/controller/report.hpp"

namespace bodesmith::cli {
namespace {

void declare_yield_controller(CommandLine& line) {
  line.positional("DISTURBANCE.json", 1, 1);
  line.output("folder for part_errors.json, trim.md and draws.csv");
  line.list<double>("track", "frequencies to track, Hz (default: those of the rate table, or 1 10 100)");
  line.option<std::string>("form", "self-fed, two-pass or seed", "self-fed");
  line.option<std::string>("opamp", "type of the op-amps (default: that of the controller)");
  line.option<std::uint64_t>("draws", "number of copies", 1000);
  line.option<int>("trims", "number of potentiometers, at most", 3);
  line.repeatable("error",
                  "NAME=VALUE, how far parts are off (names: part_errors.json, errors_of_parts.assumed)");
  line.option<double>("max-p95-percent", "exit with 1 when the untrimmed 95 % are above this");
  line.flag("full-stroke", "leave the amplitude gains out: a smaller circuit, for full strokes only");
  line.flag("allow-unstable", "go on with a phase margin below 30 degrees");
  line.option<int>("check-draws", "copies that are run through ngspice too", 2);
  line.flag("no-ngspice", "the program's own models only");
  line.option<int>("threads", "0: all cores", 0);
  line.seed();
}

std::vector<Hertz> yield_tracked(const CommandLine& line, const Disturbance& disturbance) {
  std::vector<Hertz> out = line.analog_frequencies("track");
  if (out.empty()) out = disturbance.rate.frequency;
  if (out.empty()) out = {Hertz{1.0}, Hertz{10.0}, Hertz{100.0}};
  std::ranges::sort(out, {}, &Hertz::value);
  return out;
}

generator::PartErrors part_errors_given(const CommandLine& line) {
  generator::PartErrors out;
  for (const std::string& pair : line.all<std::string>("error")) {
    const std::size_t cut = pair.find('=');
    const std::string name = pair.substr(0, cut);
    double value = 0.0;
    if (cut == std::string::npos || !parse_number(std::string_view(pair).substr(cut + 1), value) ||
        value < 0.0)
      line.fail(fmt::format("--error '{}', expected NAME=VALUE with a value of 0 or more", pair));
    if (const auto wrong = out.set(name, value)) line.fail(fmt::format("--error {} {}", name, *wrong));
  }
  return out;
}

tolerance::ControllerReportOptions yield_report_options(const CommandLine& line,
                                                        const std::vector<Hertz>& tracked) {
  tolerance::ControllerReportOptions out;
  out.study.errors = part_errors_given(line);
  out.study.frequencies = tracked;
  out.study.draws = line.get<std::uint64_t>("draws");
  if (out.study.draws < 2 || out.study.draws > 10000000) line.fail("--draws must be from 2 to 10000000");
  out.study.seed = line.seed_value();
  out.study.threads = line.integer("threads", 0, 1024);
  out.trims.trims = line.integer("trims", 0, 4);
  out.trims.draws = out.study.draws;
  out.ngspice = !line.has("no-ngspice");
  out.checked_draws = line.integer("check-draws", 0, 1000);
  out.allow_unstable = line.has("allow-unstable");
  return out;
}

}  // namespace

int run_yield_controller(const std::vector<std::string>& arguments) {
  CommandLine line(
      "yield controller",
      "bodesmith yield controller disturbance.json --track 1 10 20 40 60 80 100 -o out/errors",
      "What its parts do to the whole analog controller: Monte Carlo of the tracking error of a stage that reads its\n"
      "drive, the parts that matter most, a trim procedure tried blind, and the stability of its loop.");
  declare_yield_controller(line);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  const std::string file = line.files()[0];
  const Disturbance disturbance = Disturbance::read(file, from);
  generator::Options design(generator::Form::self_fed);
  design.form = generator::form_named(line.get<std::string>("form"));
  design.tracked = yield_tracked(line, disturbance);
  design.full_stroke = line.has("full-stroke");
  if (line.has("opamp"))
    design.opamp = schematic::OpAmpLibrary::built_in().named(line.get<std::string>("opamp"));
  const tolerance::ControllerReportOptions options = yield_report_options(line, design.tracked);

  const Stopwatch watch;
  const generator::DisturbanceCircuit made = generator::make_controller(disturbance, design);
  const tracking::PolynomialStage stage(disturbance);
  const tolerance::ControllerReport report = tolerance::examine(made, stage, options);
  Json json = timed_document("part_errors", from, tolerance::to_json(report, made), watch.seconds());
  const auto limit = line.maybe<double>("max-p95-percent");
  OutputSet out(line.output_path());
  out.add("part_errors.json", to_text(json));
  out.add("trim.md", tolerance::trim_page(report, made, "the controller of " + file));
  out.add("draws.csv", tolerance::draws_csv(report.study));
  out.commit();
  std::vector<std::string> warnings = made.warnings;
  if (const std::string warning = generator::loop_warning(report.loop); !warning.empty())
    warnings.push_back(warning);
  warn_each(warnings);
  std::string text = tolerance::summary_text(report, made);
  const bool met = keeps_limit(limit, report.study.worst.p95_percent, "%", text, json);
  return print_summary(line, text + fmt::format("written to {}\n", line.output_path().string()), json, met);
}

}  // namespace bodesmith::cli
