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

namespace po = boost::program_options;

fpaa::PolynomialBy polynomial_named(const CommandLine& line, const std::string& name) {
  for (const auto by :
       {fpaa::PolynomialBy::outside, fpaa::PolynomialBy::multipliers, fpaa::PolynomialBy::lookup}) {
    if (name == fpaa::word(by)) return by;
  }
  line.fail(fmt::format("--polynomial '{}', expected outside, multipliers or lookup", name));
}

}  // namespace

int run_fpaa_controller(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fpaa controller",
      "bodesmith fpaa controller disturbance.json --descending out/fpaa/plan.json -o out/controller",
      "Places the whole controller (both branches' polynomials, amplitude gains, compensators, branch "
      "switch)\n"
      "on the board; compares the ways to make the polynomials and says which it took and why.");
  line.positional("DISTURBANCE.json", 1, 1);
  line.output("folder for controller.json, controller.md and the look-up tables");
  line.options().add_options()("ascending", po::value<std::string>(),
                               "plan.json of the ascending branch's compensator")(
      "descending", po::value<std::string>(), "plan.json of the descending branch's compensator")(
      "polynomial", po::value<std::string>(),
      "outside, multipliers or lookup (default: the most accurate that fits)")(
      "fast-clock-hz", po::value<double>()->default_value(250e3), "clock of everything but the compensators")(
      "outside-error-percent", po::value<double>()->default_value(0.1),
      "error of each AD835, of its full scale");
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  const std::string file = line.files()[0];
  const Disturbance disturbance = Disturbance::read(file, from);
  const auto plan = [&](const char* option) -> std::optional<fpaa::Plan> {
    if (!line.has(option)) return std::nullopt;
    return fpaa::Plan::read(line.get<std::string>(option), from);
  };
  const auto ascending = plan("ascending");
  const auto descending = plan("descending");
  fpaa::ControllerOptions options;
  options.fast_clock = {line.positive("fast-clock-hz")};
  options.outside_error_percent = line.positive("outside-error-percent");
  if (line.has("polynomial"))
    options.polynomial = polynomial_named(line, line.get<std::string>("polynomial"));

  const Stopwatch watch;
  const fpaa::Controller controller = [&] {
    try {
      return fpaa::make_controller(disturbance, ascending ? &*ascending : nullptr,
                                   descending ? &*descending : nullptr, options);
    } catch (const DesignError& error) {
      throw DesignError(fmt::format("{}: {}", file, error.what()));
    }
  }();
  Json json = json_header("fpaa_controller", from);
  json.update(controller.to_json());
  json["timing_s"] = {{"compute", watch.seconds()}};
  OutputSet out(line.output_path());
  out.add("controller.json", to_text(json));
  out.add("controller.md", fpaa::controller_sheet(controller));
  using Branch = Disturbance::Branch;
  for (const auto& [branch, name] :
       {std::pair{Branch::ascending, "ascending"}, std::pair{Branch::descending, "descending"}}) {
    double scale = 1.0;
    const fpaa::LookupTable table = fpaa::branch_table(disturbance, branch, scale);
    const auto wanted = [&, b = branch](double v) { return fpaa::branch_volts(disturbance, b, scale, v); };
    out.add(fmt::format("lookup_{}.csv", name), table.csv(wanted));
  }
  out.commit();
  std::string text = fmt::format("polynomials: {}\n", controller.why);
  for (const fpaa::ControllerVariant& v : controller.variants) {
    text += fmt::format(
        "  {:<12} {}: worst {} %, delay {} us, {} CAMs on {} chips, {} op-amps, {} capacitors\n",
        fpaa::word(v.by), v.fits ? "fits" : "does not fit", rounded_text(v.max_error_percent, 3),
        rounded_text(1e6 * v.delay_s, 4), v.cams.size(), v.chips, v.resources.opamps, v.resources.capacitors);
  }
  print_summary(line, text + fmt::format("written to {}\n", line.output_path().string()), json);
  return kDone;
}

}  // namespace bodesmith::cli
