#include <fmt/format.h>

#include <algorithm>

#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "circuit/layout.hpp"
#include "circuit/layout_budget.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "spice/emit.hpp"
#include "spice/layout_check.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;

void declare(CommandLine& line) {
  line.positional("DISTURBANCE.json", 1, 1);
  line.output("folder for layout.json, disturbance.sub and layout.svg");
  const LayoutOptions defaults;
  line.options().add_options()("series", po::value<std::string>()->default_value("E96"),
                               "series of the resistors, E3 to E192 or exact")(
      "multiplier-scale-v", po::value<double>()->default_value(defaults.multiplier.scale_v),
      "U in W = X Y/U + Z")("switch-ohm", po::value<double>()->default_value(defaults.switch_on_ohm),
                            "on-resistance of the branch switch")(
      "full-scale-v", po::value<double>()->default_value(defaults.full_scale_v),
      "greatest voltage at any node")(
      "lowest-hz", po::value<double>()->default_value(defaults.lowest.value),
      "lowest reference frequency (triangle) that the slope detector must see")(
      "check", "run ngspice: static, and triangles at 100 Hz and 5 kHz")(
      "max-error-percent", po::value<double>(),
      "exit with 1 when d(x) is off by more percent of the range of x");
}

LayoutOptions read_options(const CommandLine& line) {
  LayoutOptions options;
  options.resistors = Series::named(line.get<std::string>("series"));
  options.multiplier.scale_v = line.positive("multiplier-scale-v");
  options.switch_on_ohm = line.positive("switch-ohm");
  options.full_scale_v = line.positive("full-scale-v");
  options.lowest = Hertz{line.positive("lowest-hz")};
  return options;
}

}  // namespace

int run_layout(const std::vector<std::string>& arguments) {
  CommandLine line("layout", "bodesmith layout disturbance.json -o layout/",
                   "The disturbance generator as multipliers, weighted sums and a branch switch.");
  declare(line);
  if (!line.parse(arguments)) return kDone;
  const LayoutOptions options = read_options(line);
  if (line.has("max-error-percent")) line.positive("max-error-percent");
  if (line.has("check") && !ngspice_available()) {
    line.fail("--check needs ngspice, which is not installed (Debian: apt-get install ngspice)");
  }
  Provenance from;
  const Disturbance disturbance = Disturbance::read(line.files()[0], from);

  const Stopwatch watch;
  const DisturbanceLayout layout = layout_disturbance(disturbance, options);
  const double compute_s = watch.seconds();
  for (const std::string& warning : layout.warnings) note(warning);

  Json json = json_header("layout", from);
  json.update(layout.to_json());
  const LayoutBudget budget = layout_budget(layout);
  json["budget"] = budget.to_json();
  json["timing_s"] = {{"compute", compute_s}};
  std::string text = fmt::format("{} multipliers ({}), {} op-amps, branch sums at {} V per unit\n",
                                 layout.multipliers.size(), layout.multiplier.name,
                                 json["opamps"].get<size_t>(), rounded_text(layout.branch_gain));
  for (const LayoutBranch& branch : layout.branches) {
    text += fmt::format("{}: {} % of range from the polynomial\n", branch.name,
                        rounded_text(branch.max_error_percent, 3));
  }
  text += fmt::format(
      "offsets, scales and tolerances (assumed, see layout.json): {} % of range rms of all causes, worst "
      "branch; largest: {}\n"
      "multipliers: {} with shared powers ({} in series), {} with Horner's scheme ({} in series)\n",
      rounded_text(*std::max_element(budget.rss_percent.begin(), budget.rss_percent.end()), 3),
      budget.lines[0].cause, budget.shared_multipliers, budget.shared_depth, budget.horner_multipliers,
      budget.horner_depth);
  if (line.has("check")) {
    const LayoutCheck check = check_layout_with_ngspice(layout, {Hertz{100}, Hertz{5000}});
    json["ngspice"] = {{"version", ngspice_version()},
                       {"static_percent", check.static_percent},
                       {"static_against_program_percent", check.static_against_program},
                       {"dynamic", Json::array()}};
    text += fmt::format("ngspice: {} % of range from the polynomials at rest",
                        rounded_text(check.static_percent, 3));
    for (const LayoutCheck::Dynamic& one : check.dynamic) {
      json["ngspice"]["dynamic"].push_back({{"frequency_hz", one.frequency.value},
                                            {"rms_percent", one.rms_percent},
                                            {"late_share", one.late_share}});
      text += fmt::format(", {} % rms at {} Hz", rounded_text(one.rms_percent, 3),
                          rounded_text(one.frequency.value));
    }
    text += "\n";
  }
  int status = kDone;
  if (const auto limit = line.maybe<double>("max-error-percent");
      limit && layout.max_error_percent > *limit) {
    text += fmt::format("the limit of {} % is not met\n", rounded_text(*limit));
    json["limit_missed"] = true;
    status = kLimitMissed;
  }
  OutputSet out(line.output_path());
  out.add("layout.json", to_text(json));
  out.add("disturbance.sub",
          disturbance_library(layout, fmt::format("disturbance generator from {}", line.files()[0])));
  out.add("layout.svg", layout_drawing(layout));
  out.commit();
  print_summary(line, text, json);
  return status;
}

}  // namespace bodesmith::cli
