#include <fmt/format.h>

#include <algorithm>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "tuning/tune.hpp"

namespace bodesmith::cli {
namespace {

void declare_tune(CommandLine& line) {
  line.positional("PLANT...", 1, -1);
  line.output("controller.json with its margins, as simulate --controller, bode, spice and yield take it");
  line.option<std::string>("sections", "also write the whole controller as sections (for bode, spice)");
  std::vector<std::string> kinds;
  for (const tuning::ControllerKind* kind : tuning::controller_kinds()) kinds.push_back(kind->name());
  line.option<std::string>("kind", "form of the controller: " + join(kinds, ", "), "pid");
  line.words("kind", kinds);
  line.option<double>("phase-margin-deg", "least phase margin, with every plant", 60.0);
  line.option<double>("gain-margin-db", "least gain margin, for more gain and for less", 6.0);
  line.option<double>("max-sensitivity", "largest |1/(1 + L)|");
  line.option<double>(
      "bandwidth-hz",
      "where the nominal loop's gain falls to 1 (default: the highest that keeps the margins)");
  line.option<double>("derivative-corner-hz",
                      "where the derivative ends and the roll-off begins (default: ten times the bandwidth)");
  line.group("What the plant may be besides (a measured one: 2 standard deviations of its fit)");
  line.option<double>("sigmas", "standard deviations by which each fitted parameter is moved, up and down",
                      2.0);
  line.option<double>("gain-tolerance-percent", "tolerance of the plant's gain, up and down", 0.0);
  line.option<double>("frequency-tolerance-percent", "tolerance of all its corner frequencies, up and down",
                      0.0);
  line.seed();
}

/// Of a plant whose gain or corners may be so much lower, and stay above 0.
double tolerance_percent(const CommandLine& line, const std::string& option) {
  const auto value = line.get<double>(option);
  if (!(value >= 0.0 && value < 100.0)) line.fail(fmt::format("--{} is not within 0 to 100", option));
  return value;
}

tuning::TuneOptions tune_options(const CommandLine& line) {
  tuning::TuneOptions out;
  out.limits.phase_margin_deg = line.positive("phase-margin-deg");
  if (out.limits.phase_margin_deg >= 180.0) line.fail("--phase-margin-deg is not below 180");
  out.limits.gain_margin_db = line.positive("gain-margin-db");
  out.limits.max_sensitivity = line.maybe_positive("max-sensitivity");
  if (out.limits.max_sensitivity && *out.limits.max_sensitivity <= 1.0)
    line.fail("--max-sensitivity is not above 1, which every loop that rolls off exceeds");
  if (line.has("bandwidth-hz")) out.bandwidth = line.analog_frequency("bandwidth-hz");
  if (line.has("derivative-corner-hz")) out.derivative_corner = line.analog_frequency("derivative-corner-hz");
  out.seed = line.seed_value();
  return out;
}

const tuning::ControllerKind& kind_of(const CommandLine& line) {
  const auto& all = tuning::controller_kinds();
  const auto name = line.get<std::string>("kind");
  const auto found = std::ranges::find_if(all, [&](const auto* kind) { return kind->name() == name; });
  if (found == all.end()) {
    std::vector<std::string> names;
    for (const auto* kind : all) names.push_back(kind->name());
    line.fail(fmt::format("--kind is '{}', expected one of {}", name, join(names, ", ")));
  }
  return **found;
}

/// The keys of controller.toml.
Json controller_json(const tuning::SeriesController& controller) {
  const simulate::PidController& pid = controller.pid;
  const bool derivative = pid.derivative_s != 0.0;
  Json out = {
      {"type", derivative ? "pid" : "pi"}, {"kp", pid.proportional}, {"ki_per_s", pid.integral_per_s}};
  if (derivative) {
    out["kd_s"] = pid.derivative_s;
    out["derivative_corner_hz"] = pid.derivative_corner.value;
  }
  if (!controller.filter.sections.empty()) {
    out["filter"] = {{"schema", "bodesmith.sections/1"}};
    out["filter"].update(controller.filter.to_json());
  }
  return out;
}

std::string margins_line(const char* what, const tuning::LeastMargins& m) {
  return fmt::format("{}: phase margin {}, gain margin {}, largest sensitivity {}\n", what,
                     m.phase_margin_deg ? rounded_text(*m.phase_margin_deg, 3) + " deg" : "none needed",
                     m.gain_margin_db ? rounded_text(*m.gain_margin_db, 3) + " dB" : "none needed",
                     rounded_text(m.max_sensitivity, 3));
}

std::string tune_text(const tuning::TunedLoop& made, const tuning::ControllerKind& kind,
                      const tuning::PlantFamily& plants) {
  const simulate::PidController& pid = made.controller.pid;
  std::string text = fmt::format("{}: kp {}, ki {} /s", kind.name(), rounded_text(pid.proportional, 5),
                                 rounded_text(pid.integral_per_s, 5));
  if (pid.derivative_s != 0.0)
    text += fmt::format(", kd {}, to {}", engineering_text(pid.derivative_s, "s", 4),
                        engineering_text(pid.derivative_corner.value, "Hz", 4));
  if (!made.controller.filter.sections.empty())
    text += fmt::format(", and a filter of {} poles", made.controller.filter.pole_count());
  text += fmt::format("\nbandwidth {}\n", engineering_text(made.bandwidth.value, "Hz", 4));
  if (plants.rms_fit_db > 0.0)
    text += fmt::format("the measured plant is met within {} dB rms\n", rounded_text(plants.rms_fit_db, 3));
  if (made.members.front().stable)
    text += margins_line("nominal", tuning::least_margins({made.members.front()}));
  if (made.members.size() > 1 && made.stable())
    text += margins_line(fmt::format("worst of {} plants", made.members.size()).c_str(),
                         tuning::least_margins(made.members));
  for (const std::string& one : made.missed) text += one + ": NOT met\n";
  if (made.reachable_bandwidth)
    text += fmt::format("these margins can be had with --bandwidth-hz {}\n",
                        rounded_text(made.reachable_bandwidth->value, 3));
  return text;
}

}  // namespace

int run_tune(const std::vector<std::string>& arguments) {
  CommandLine line(
      "tune",
      "bodesmith tune plant.csv --kind pid --phase-margin-deg 60 --bandwidth-hz 20 -o controller.json",
      "A controller for a measured plant (frequency_hz,magnitude_db,phase_deg), sections.json or a linear\n"
      "model.toml: the most gain at low frequencies that keeps the margins with every plant that the measurement\n"
      "allows. Further files are further plants. Plants have no poles in the right half plane.");
  declare_tune(line);
  line.reads_measurements();
  if (!line.parse(arguments)) return kDone;
  const tuning::TuneOptions options = tune_options(line);
  const tuning::ControllerKind& kind = kind_of(line);
  const tuning::PlantSpread spread{line.positive("sigmas"), tolerance_percent(line, "gain-tolerance-percent"),
                                   tolerance_percent(line, "frequency-tolerance-percent")};
  Provenance from;
  const tuning::PlantFamily plants = tuning::read_plants(line.files(), spread, from);
  const Stopwatch watch;
  const tuning::TunedLoop made = tuning::tune(plants, kind, options);
  const double seconds = watch.seconds();

  const Json report = made.report_json(options);
  Json controller = controller_json(made.controller);
  controller["tuning"] = report;
  OutputSet out;
  out.add(line.output_path(), to_text(timed_document("controller", from, controller, seconds)));
  if (line.has("sections"))
    out.add(line.get<std::string>("sections"),
            to_text(timed_document("sections", from, made.controller.sections().to_json(), seconds)));
  out.commit();
  Json summary = {{"kind", kind.name()}};
  summary.update(controller_json(made.controller));
  summary.update(report);
  summary["limits_met"] = made.met();
  return print_summary(line, tune_text(made, kind, plants),
                       timed_document("tune_summary", from, summary, seconds), made.met());
}

}  // namespace bodesmith::cli
