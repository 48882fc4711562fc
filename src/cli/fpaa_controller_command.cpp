#include <fmt/format.h>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "fpaa/controller.hpp"
#include "fpaa/polynomial_error.hpp"

namespace bodesmith::cli {
namespace {

void add_controller_options(CommandLine& line) {
  line.positional("DISTURBANCE.json", 1, 1);
  line.output("folder for controller.json, controller.md and the look-up tables");
  line.option<std::string>("ascending", "plan.json of the ascending branch's compensator");
  line.option<std::string>("descending", "plan.json of the descending branch's compensator");
  line.option<std::string>("polynomial",
                           "outside, multipliers or lookup (default: the most accurate that fits)");
  line.option<double>("fast-clock-hz", "clock of everything but the compensators", 250e3);
  line.option<double>("outside-error-percent", "error of each AD835, of its full scale", 0.1);
}

fpaa::ControllerOptions controller_options(const CommandLine& line) {
  fpaa::ControllerOptions out;
  out.fast_clock = {line.positive("fast-clock-hz")};
  out.outside_error_percent = line.positive("outside-error-percent");
  if (line.has("polynomial")) {
    using By = fpaa::PolynomialBy;
    out.polynomial = line.choice("polynomial", {By::outside, By::multipliers, By::lookup});
  }
  return out;
}

std::optional<fpaa::Plan> read_compensator(const CommandLine& line, const char* option, Provenance& from) {
  if (!line.has(option)) return std::nullopt;
  return fpaa::Plan::read(line.get<std::string>(option), from);
}

void write_controller(const std::filesystem::path& folder, const fpaa::Controller& controller,
                      const Json& json, const Disturbance& disturbance) {
  OutputSet out(folder);
  out.add("controller.json", to_text(json));
  out.add("controller.md", fpaa::controller_sheet(controller));
  using Branch = Disturbance::Branch;
  for (const auto& [branch, name] :
       {std::pair{Branch::ascending, "ascending"}, std::pair{Branch::descending, "descending"}}) {
    const fpaa::BranchTable made = value_or_throw(fpaa::branch_table(disturbance, branch));
    const auto wanted = [&, b = branch](double v) {
      return fpaa::branch_volts(disturbance, b, made.scale, v);
    };
    out.add(fmt::format("lookup_{}.csv", name), made.table.csv(wanted));
  }
  out.commit();
}

std::string controller_text(const fpaa::Controller& controller) {
  std::string out = fmt::format("polynomials: {}\n", controller.why);
  for (const fpaa::ControllerVariant& v : controller.variants) {
    out += fmt::format(
        "  {:<12} {}: worst {} %, delay {} us, {} CAMs on {} chips, {} op-amps, {} capacitors\n",
        fpaa::to_string(v.by), v.fits() ? "fits" : "does not fit", rounded_text(v.max_error_percent, 3),
        rounded_text(1e6 * v.delay_s, 4), v.cams.size(), v.chips, v.resources.opamps, v.resources.capacitors);
  }
  return out;
}

}  // namespace

int run_fpaa_controller(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fpaa controller",
      "bodesmith fpaa controller disturbance.json --descending out/fpaa/plan.json -o out/controller",
      "Places the whole controller (both branches' polynomials, amplitude gains, compensators, branch "
      "switch)\n"
      "on the board; compares the ways to make the polynomials and says which it took and why.");
  add_controller_options(line);
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  const std::string file = line.files()[0];
  const Disturbance disturbance = Disturbance::read(file, from);
  const auto ascending = read_compensator(line, "ascending", from);
  const auto descending = read_compensator(line, "descending", from);

  const Stopwatch watch;
  const auto outcome = fpaa::make_controller(disturbance, ascending ? &*ascending : nullptr,
                                             descending ? &*descending : nullptr, controller_options(line));
  if (const Refusal* refusal = refusal_of(outcome)) {
    throw DesignError(fmt::format("{}: {}", file, refusal->reason));
  }
  const auto& controller = std::get<fpaa::Controller>(outcome);
  Json json = json_header("fpaa_controller", from);
  json.update(controller.to_json());
  json["timing_s"] = {{"compute", watch.seconds()}};
  write_controller(line.output_path(), controller, json, disturbance);
  print_summary(
      line, controller_text(controller) + fmt::format("written to {}\n", line.output_path().string()), json);
  return kDone;
}

}  // namespace bodesmith::cli
