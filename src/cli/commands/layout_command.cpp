#include <fmt/format.h>

#include <algorithm>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/shared_options.hpp"
#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/circuit.hpp"
#include "synthesis/generator/files.hpp"
#include "synthesis/generator/ngspice_check.hpp"
#include "synthesis/generator/timing.hpp"

namespace bodesmith::cli {
namespace {

void declare_layout(CommandLine& line) {
  line.positional("DISTURBANCE.json", 1, 1);
  line.output(
      "folder for layout.json, disturbance.sub (with amplitude gains also disturbance_amplitude.sub), "
      "parts.csv and layout.svg");
  const generator::Options defaults;
  line.option<std::string>("series", "series of the resistors, E3 to E192 or exact", "E96");
  line.option<std::string>(
      "scheme",
      "how the polynomials are split for multipliers: shared (powers), horner, 2 to 6 (that many "
      "powers to a group), or auto: fewest multipliers among those of small error and large "
      "bandwidth",
      "auto");
  line.option<double>("multiplier-scale-v", "U in W = X Y/U + Z", defaults.multiplier.scale_v);
  line.option<double>(
      "switch-ohm",
      "on-resistance of the branch switch; default of this and the next four: typical values of an "
      "ADG413 (up to two branches) or an ADG408, assumed");
  line.option<double>("switch-delay-s", "delay from the control to the closing of the new contact");
  line.option<double>("switch-gap-s", "break-before-make time: both contacts open");
  line.option<double>("switch-charge-c", "charge that an opening contact injects");
  line.option<double>("switch-drain-f", "capacitance of the common node for each contact");
  line.option<double>("full-scale-v", "largest voltage at any node but the output", defaults.full_scale_v);
  line.option<double>("lowest-hz",
                      "lowest reference frequency (triangle) that the slope detector must follow",
                      defaults.lowest.value);
  line.option<double>("highest-hz", "highest reference frequency, at which late switching is stated",
                      defaults.highest.value);
  add_check_option(
      line, "run ngspice: static, triangles at 100 Hz and the highest frequency, one change of branch");
  line.option<double>("max-error-percent",
                      "exit with 1 when the error of d(x) is larger, in percent of the range of x");
}

generator::Options read_layout_options(const CommandLine& line, std::size_t branches) {
  generator::Options options;
  options.resistors = synthesis::Series::named(line.get<std::string>("series"));
  options.scheme = generator::Scheme::named(line.get<std::string>("scheme"));
  options.multiplier.scale_v = line.positive("multiplier-scale-v");
  options.full_scale_v = line.positive("full-scale-v");
  options.lowest = line.analog_frequency("lowest-hz");
  options.highest = line.analog_frequency("highest-hz");
  schematic::SwitchModel model = schematic::SwitchModel::for_branches(branches);
  const auto set = [&](const char* name, double& value) {
    if (line.has(name)) value = line.positive(name);
  };
  set("switch-ohm", model.on_ohm);
  set("switch-delay-s", model.on_delay_s);
  set("switch-gap-s", model.gap_s);
  set("switch-charge-c", model.charge_c);
  set("switch-drain-f", model.drain_f);
  schematic::SwitchTimer::of(model);
  options.analog_switch = model;
  return options;
}

std::string percent(double value) {
  return rounded_text(value, 3) + " %";
}

std::string layout_summary(const generator::DisturbanceCircuit& layout, const generator::Budget& budget) {
  std::string text = fmt::format("{} multipliers ({}), {} op-amps, branch sums at {} V per unit\n",
                                 layout.generator_multipliers(), layout.multiplier.name, layout.opamps.size(),
                                 rounded_text(layout.branch_gain));
  for (const generator::Candidate& one : layout.candidates) {
    text += fmt::format(
        "{} {}: {} multipliers ({} in series), {} op-amps, {} of range rms with exact resistors, {}Hz\n",
        one.chosen ? "*" : " ", one.name, one.multipliers, one.depth, one.opamps, percent(one.rss_percent),
        engineering_text(one.bandwidth.value, ""));
  }
  for (const generator::Branch& branch : layout.branches) {
    text +=
        fmt::format("{}: {} of range from the polynomial\n", branch.name, percent(branch.max_error_percent));
  }
  text += fmt::format(
      "offsets, scales and tolerances (assumed, see layout.json): {} of range rms from all causes, worst "
      "branch; largest: {}\n",
      percent(*std::ranges::max_element(budget.rss_percent)), budget.lines[0].cause);
  if (layout.amplitude) {
    text += fmt::format("amplitude gains: {} multipliers, {} of range from the table\n",
                        layout.amplitude->multipliers.size(), percent(layout.amplitude->max_error_percent));
  }
  return text;
}

std::string timing_summary(const generator::DisturbanceCircuit& layout, const generator::Timing& timing) {
  std::string text;
  for (const generator::SlopeDetectorFigures::Delay& one : timing.detector.delays) {
    if (!one.triangle_s)
      text += fmt::format("{} Hz triangle: the slope detector does not follow it\n",
                          rounded_text(one.frequency.value));
  }
  for (const generator::SwitchFigures::Late& one : timing.analog_switch.late) {
    text += fmt::format(
        "{} Hz triangle: branch {}s late, steps up to {}, {} rms ({} with multipliers off by one standard deviation)\n",
        rounded_text(one.frequency.value), engineering_text(one.delay_s, ""), percent(one.step_percent),
        percent(one.rms_percent), percent(one.rms_off_percent));
  }
  if (layout.switched()) {
    text += fmt::format(
        "switch {}: open for {}s, glitch of {} at full scale; slope detector: {} V/s at least, hysteresis {} "
        "times its noise\n",
        layout.analog_switch.name, engineering_text(layout.analog_switch.gap_s, ""),
        percent(timing.analog_switch.glitch_percent), rounded_text(timing.detector.least_slope_v_per_s, 3),
        rounded_text(timing.detector.noise_margin, 3));
  }
  return text;
}

std::string layout_check_text(const generator::DisturbanceCheck& check) {
  std::string text = fmt::format(
      "ngspice: {} of range from the polynomials at rest ({} with multipliers off by one standard deviation, predicted {})",
      percent(check.static_percent), percent(check.off_percent), percent(check.off_predicted_percent));
  for (const generator::DisturbanceCheck::Dynamic& one : check.dynamic) {
    text += fmt::format(", {} rms at {} Hz{} ({} so, detector {}s late)", percent(one.rms_percent),
                        rounded_text(one.frequency.value),
                        one.alpha == 1.0 ? "" : " and alpha " + rounded_text(one.alpha),
                        percent(one.rms_off_percent), engineering_text(one.delay_s, ""));
  }
  if (check.change) {
    text += fmt::format("; a change of branch takes {}s, glitch {} (predicted {})",
                        engineering_text(check.change->delay_s, ""), percent(check.change->glitch_percent),
                        percent(check.change->predicted_percent));
  }
  return text + "\n";
}

}  // namespace

int run_layout(const std::vector<std::string>& arguments) {
  CommandLine line("layout", "bodesmith layout disturbance.json -o layout/",
                   "The disturbance generator as multipliers, weighted sums and a branch switch.");
  declare_layout(line);
  if (!line.parse(arguments)) return kDone;
  const std::optional<double> limit = line.maybe_positive("max-error-percent");
  require_ngspice_for_check(line);
  Provenance from;
  const generator::Input input = generator::Input::read(line.files()[0], from);
  const generator::Options options = read_layout_options(line, input.branches.size());

  const Stopwatch watch;
  const generator::DisturbanceCircuit layout = generator::make_layout(input, options);
  const generator::Budget budget = generator::make_budget(layout);
  const generator::Timing timing =
      generator::make_timing(layout, {options.lowest, Hertz{100}, options.highest});
  const double compute_s = watch.seconds();
  for (const std::string& warning : layout.warnings) note(warning);

  Json json = to_json(layout, budget, timing);
  json = timed_document("layout", from, json, compute_s);
  std::string text = layout_summary(layout, budget) + timing_summary(layout, timing);
  if (line.has("check")) {
    const generator::DisturbanceCheck check =
        generator::check_disturbance(layout, {Hertz{100}, options.highest});
    json["ngspice"] = to_json(check);
    text += layout_check_text(check);
  }
  const bool met = keeps_limit(limit, layout.max_error_percent, "%", text, json);
  OutputSet out(line.output_path());
  generator::add_layout_files(layout, fmt::format("disturbance generator from {}", line.files()[0]), json,
                              out);
  out.commit();
  return print_summary(line, text, json, met);
}

}  // namespace bodesmith::cli
