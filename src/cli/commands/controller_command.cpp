#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/shared_options.hpp"
#include "schematic/opamp_library.hpp"
#include "synthesis/controller/as_built.hpp"
#include "synthesis/controller/files.hpp"
#include "synthesis/controller/study.hpp"
#include "tolerance/controller/report.hpp"

namespace bodesmith::cli {
namespace {

void declare_controller(CommandLine& line) {
  line.positional("DISTURBANCE.json", 1, 1);
  line.output("folder for controller.sub, controller.json, parts.csv, controller.svg and the KiCad project");
  const generator::Options defaults(generator::Form::self_fed);
  line.option<std::string>(
      "form",
      "self-fed: v = r - K d(v), the generator fed by its own drive; two-pass: v = r - K d(r - K "
      "d(r)); seed: v = r - K d(r)",
      "self-fed");
  line.list<double>("track-hz",
                    "frequencies that are tracked (default: 1 10 20 40 60 80 100); the gain curve's corners "
                    "are put there where they fit");
  line.option<std::string>("waveform", "reference: triangle, sine, two_tone or decaying_triangle",
                           "triangle");
  line.words("waveform", {"triangle", "sine", "two_tone", "decaying_triangle"});
  line.option<double>("amplitude", "amplitude of the reference as a share of the full stroke", 1.0);
  add_load_option(line);
  line.flag("full-stroke", "leave the amplitude gains out: a smaller circuit, for full strokes only");
  line.flag("constant", "leave the rate gains out: the constant polynomial");
  line.option<double>("rate-tolerance-percent",
                      "of the gain curve's straight pieces against the table, percent of range",
                      defaults.rate_tolerance_percent);
  line.option<double>(
      "averaging-s",
      "time constant after the slope's rectifier; several periods: the mean slope, right for every "
      "reference that goes once up and down (default: a hundredth of the shortest period)");
  line.option<std::string>("series", "series of the resistors, E3 to E192 or exact", "E96");
  line.option<std::string>("opamp", "type of the op-amps", defaults.opamp.name);
  line.option<std::string>("fast-opamp", "type of the slope detector's op-amps", defaults.fast_opamp.name);
  line.option<double>("multiplier-scale-v", "U in W = X Y/U + Z", defaults.multiplier.scale_v);
  line.option<double>("lowest-hz", "slowest --waveform of which the slope detector must follow every turn",
                      defaults.lowest.value);
  add_check_option(line, "run ngspice on controller.sub at every tracked frequency, and the loop's margins");
  line.flag("errors",
            "errors of parts too: Monte Carlo, trims tried blind (trim.md); more options: yield controller");
  line.flag("allow-unstable", "go on with a phase margin below 30 degrees");
  line.option<double>("max-error-percent", "exit with 1 when the tracking error without lag is larger");
}

std::vector<Hertz> controller_frequencies(const CommandLine& line) {
  if (line.has("track-hz")) return line.analog_frequencies("track-hz");
  return {{1.0}, {10.0}, {20.0}, {40.0}, {60.0}, {80.0}, {100.0}};
}

generator::Options read_controller_options(const CommandLine& line) {
  generator::Options out(generator::Form::self_fed);
  out.form = generator::form_named(line.get<std::string>("form"));
  out.tracked = controller_frequencies(line);
  out.rates = !line.has("constant");
  out.full_stroke = line.has("full-stroke");
  out.rate_tolerance_percent = line.positive("rate-tolerance-percent");
  out.averaging_s = line.maybe_positive("averaging-s").value_or(0.0);
  out.resistors = synthesis::Series::named(line.get<std::string>("series"));
  if (out.resistors.is_exact()) out.capacitors = synthesis::Series::named("exact");
  const schematic::OpAmpLibrary types = schematic::OpAmpLibrary::built_in();
  out.opamp = types.named(line.get<std::string>("opamp"));
  out.fast_opamp = types.named(line.get<std::string>("fast-opamp"));
  out.multiplier.scale_v = line.positive("multiplier-scale-v");
  out.lowest = line.analog_frequency("lowest-hz");
  return out;
}

tracking::Reference read_controller_reference(const CommandLine& line) {
  using Shape = tracking::Reference::Shape;
  const Shape shape =
      line.choice("waveform", {Shape::triangle, Shape::sine, Shape::two_tone, Shape::decaying_triangle});
  return tracking::Reference(shape, line.positive("amplitude"));
}

std::string built_summary(const generator::DisturbanceCircuit& built) {
  std::string text = fmt::format(
      "{}: {} multipliers ({}), {} op-amps ({}, slope detector {}), {} resistors, capacitors and diodes\n"
      "parts and gain curve: K d within {} % of range; loop gain at most {}, drive up to {} V\n",
      to_string(built.form), built.multipliers.size(), built.multiplier.name, built.opamps.size(),
      built.opamp.name, built.other_opamps.at(0).name, built.parts.size(),
      rounded_text(built.max_error_percent, 3), rounded_text(built.loop.greatest_gain, 3),
      rounded_text(built.loop.greatest_drive, 4));
  if (built.curve) {
    text += fmt::format("rate gains from the slope: {} straight pieces, held at {} Hz above\n",
                        built.curve->corner.size() - 1, rounded_text(built.curve->corner.back().value));
  }
  if (built.stroke) {
    text += fmt::format("amplitude gains from the reference's last peak, strokes from {} on\n",
                        rounded_text(built.stroke->least, 3));
  }
  return text;
}

std::string as_built_summary(const std::vector<generator::AsBuilt>& cases, bool checked) {
  std::string text = fmt::format("tracking error, rms in percent of range, {}:\n",
                                 checked ? "ngspice and a stage that reads its drive" : "by CVODE");
  for (const generator::AsBuilt& one : cases) {
    text += fmt::format("{:>8} Hz: {}, without lag {} (no controller {})", rounded_text(one.frequency.value),
                        rounded_text(one.error.rms_percent, 3),
                        rounded_text(one.error.rms_percent_without_lag, 3),
                        rounded_text(one.without.rms_percent, 3));
    if (checked) {
      text +=
          fmt::format("; from CVODE {}, first period {} from the settled one",
                      rounded_text(one.cvode_difference_percent, 2), rounded_text(one.start_up_percent, 2));
    }
    text += "\n";
  }
  return text;
}

/// Keys `stability`, and with --errors `errors_of_parts` and `trim`; trim.md.
std::string add_part_errors(const CommandLine& line, const generator::DisturbanceCircuit& built,
                            const tracking::Reference& reference, Json& json, OutputSet& out) {
  tolerance::ControllerReport report;
  std::string text;
  if (line.has("errors")) {
    tolerance::ControllerReportOptions options;
    options.study.frequencies = built.tracked;
    const double stroke = tolerance::examined_stroke(built, reference.alpha());
    options.study.reference = tracking::Reference(reference.shape(), stroke);
    options.ngspice = line.has("check");
    options.allow_unstable = line.has("allow-unstable");
    const tracking::PolynomialStage stage(built.disturbance, {}, {.alpha = stroke});
    report = tolerance::examine(built, stage, options);
    json.update(tolerance::to_json(report, built));
    out.add("trim.md", tolerance::trim_page(report, built, "the controller of " + line.files()[0]));
    text = tolerance::summary_text(report, built);
  } else {
    report.loop =
        line.has("check") ? generator::checked_loop_stability(built) : generator::loop_stability(built);
    generator::require_stable(report.loop, line.has("allow-unstable"));
    if (!report.loop.at.empty()) json["stability"] = generator::to_json(report.loop);
    text = generator::summary_text(report.loop);
  }
  if (const std::string warning = generator::loop_warning(report.loop); !warning.empty()) note(warning);
  return text;
}

}  // namespace

int run_controller(const std::vector<std::string>& arguments) {
  CommandLine line(
      "controller", "bodesmith controller disturbance.json -o controller/ --check",
      "The whole analog controller of a disturbance as one circuit: inverse, rate gains, switch.");
  declare_controller(line);
  if (!line.parse(arguments)) return kDone;
  const std::optional<double> limit = line.maybe_positive("max-error-percent");
  require_ngspice_for_check(line);
  Provenance from;
  Disturbance disturbance = Disturbance::read(line.files()[0], from);
  if (const auto left = line.maybe_positive("load-stroke")) disturbance = disturbance.at_load(*left);
  generator::Options options = read_controller_options(line);
  const tracking::Reference reference = read_controller_reference(line);
  options.least_swing = reference.least_swing();
  if (options.full_stroke && reference.alpha() != 1.0)
    line.fail(fmt::format("--full-stroke and --amplitude {} contradict each other",
                          rounded_text(reference.alpha())));

  const Stopwatch watch;
  const generator::DisturbanceCircuit built = generator::make_controller(disturbance, options);
  const bool checked = line.has("check");
  const std::vector<generator::AsBuilt> cases =
      checked ? generator::measure_as_built(built, built.tracked, reference)
              : generator::predict_as_built(built, reference);
  const double compute_s = watch.seconds();
  for (const std::string& warning : built.warnings) note(warning);
  if (built.stroke && reference.alpha() != 1.0 && reference.turns().size() > 2)
    note(
        "the gains are those of the reference's last peak, which behind an inner turn is not its stroke: the errors have it");
  if (!built.stroke && reference.alpha() != 1.0)
    note(fmt::format(
        "made for full strokes: at {} of it the stage's loop is another one (an `amplitude` table builds gains for it)",
        rounded_text(reference.alpha())));

  Json json = generator::controller_json(built);
  json["reference"] = {{"waveform", std::string(to_string(reference.shape()))},
                       {"amplitude", reference.alpha()}};
  json[checked ? "as_built" : "predicted"] = generator::to_json(cases);
  json = timed_document("analog_controller", from, json, compute_s);
  std::string text = built_summary(built) + as_built_summary(cases, checked);
  const bool met = keeps_limit(limit, generator::worst_percent(cases), "%", text, json);
  OutputSet out(line.output_path());
  text += add_part_errors(line, built, reference, json, out);
  generator::add_controller_files(built, fmt::format("controller from {}", line.files()[0]), json, out, "");
  out.commit();
  return print_summary(line, text, json, met);
}

}  // namespace bodesmith::cli
