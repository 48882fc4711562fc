#include <fmt/format.h>

#include <algorithm>

#include "base/document.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "circuit/realise.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "yield/yield.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;

void declare(CommandLine& line) {
  line.positional("SECTIONS.json|PLAN.json…", 1, -1);
  line.output("yield.json (percentiles a frequency, ranking of the parts, what to buy)", true);
  line.seed();
  const yield::Spread s;
  line.options().add_options()("samples", po::value<std::uint64_t>()->default_value(100000),
                               "circuits drawn")(
      "distribution", po::value<std::string>()->default_value("uniform"),
      "uniform within the tolerance, gaussian (tolerance = --sigmas standard deviations), or corners")(
      "sigmas", po::value<double>()->default_value(s.sigmas),
      "standard deviations that a tolerance stands for")(
      "resistor-percent", po::value<double>()->default_value(s.resistor_percent),
      "tolerance of the resistors")("capacitor-percent",
                                    po::value<double>()->default_value(s.capacitor_percent),
                                    "tolerance of the capacitors")(
      "unit-capacitor-percent", po::value<double>()->default_value(s.unit_capacitor_percent),
      "FPAA: standard deviation of one unit; n units have 1/sqrt(n) of it")(
      "temperature-low-c", po::value<double>()->default_value(25.0),
      "every circuit is at a temperature from here")(
      "temperature-high-c", po::value<double>()->default_value(25.0), "to here; 25 is neutral")(
      "resistor-ppm", po::value<double>()->default_value(s.resistor_ppm_per_k),
      "temperature coefficient, +- ppm/K")("capacitor-ppm",
                                           po::value<double>()->default_value(s.capacitor_ppm_per_k),
                                           "temperature coefficient, +- ppm/K")(
      "count", po::value<int>()->default_value(60), "frequencies, evenly in log")(
      "from-hz", po::value<double>(), "lowest frequency (default: lowest corner of the first design)")(
      "to-hz", po::value<double>(), "highest frequency (default: highest corner)")(
      "limit-db", po::value<double>(),
      "count the circuits that stay within, say which tolerances to buy for it")(
      "limit-deg", po::value<double>(), "the same for the phase")(
      "min-yield-percent", po::value<double>(), "exit with 1 when fewer circuits stay within the limits")(
      "realization", po::value<std::string>()->default_value("opamp-rc"), "as in bodesmith spice")(
      "series", po::value<std::string>()->default_value("E96"), "series of the resistors")(
      "capacitor-series", po::value<std::string>()->default_value("E12"), "series of the capacitors")(
      "threads", po::value<int>()->default_value(0), "0: all cores (one a process under mpirun)");
}

yield::Spread read_spread(const CommandLine& line) {
  yield::Spread s;
  const std::string kind = line.get<std::string>("distribution");
  if (kind == "uniform") {
    s.kind = yield::Spread::Kind::uniform;
  } else if (kind == "gaussian") {
    s.kind = yield::Spread::Kind::gaussian;
  } else if (kind == "corners") {
    s.kind = yield::Spread::Kind::corners;
  } else {
    line.fail(fmt::format("--distribution is {}, expected uniform, gaussian or corners", kind));
  }
  s.sigmas = line.positive("sigmas");
  s.resistor_percent = line.get<double>("resistor-percent");
  s.capacitor_percent = line.get<double>("capacitor-percent");
  s.unit_capacitor_percent = line.get<double>("unit-capacitor-percent");
  s.temperature_low_c = line.get<double>("temperature-low-c");
  s.temperature_high_c = line.get<double>("temperature-high-c");
  s.resistor_ppm_per_k = line.get<double>("resistor-ppm");
  s.capacitor_ppm_per_k = line.get<double>("capacitor-ppm");
  return s;
}

yield::Design read_design(const CommandLine& line, const std::string& file, Provenance& from) {
  const Node node = read_document(file, from);
  if (node.kind() == Node::Kind::object && node.string_or("schema", "") == "bodesmith.fpaa_plan/1") {
    return yield::design_of_plan(node, file);
  }
  const Sections sections = Sections::from_node(node);
  circuit::RealiseOptions options;
  options.realization = line.get<std::string>("realization");
  options.resistors = circuit::Series::named(line.get<std::string>("series"));
  options.capacitors = circuit::Series::named(line.get<std::string>("capacitor-series"));
  return yield::design_of_circuit(circuit::realise(sections, options), sections, file);
}

std::string describe(const yield::Design& design, const yield::Result& result,
                     const yield::Options& options) {
  std::string text = fmt::format(
      "{}: {} poles, {} parts, {} circuits\n  worst over {} frequencies: {} dB, {} deg in 95 of 100 circuits "
      "(median {} dB, "
      "greatest {} dB; all parts at their limits {} dB)\n",
      result.name, design.poles, design.parts.size(), result.samples, result.grid.size(),
      rounded_text(result.worst_db.quantile(0.95), 3), rounded_text(result.worst_deg.quantile(0.95), 3),
      rounded_text(result.worst_db.quantile(0.5), 3), rounded_text(result.worst_db.greatest, 3),
      rounded_text(result.worst_case_db, 3));
  if (options.limit_db || options.limit_deg) {
    text += fmt::format(
        "  within the limits: {} %\n",
        rounded_text(100.0 * static_cast<double>(result.within) / static_cast<double>(result.samples), 5));
  }
  text += "  parts that matter most:";
  for (size_t i = 0; i < std::min<size_t>(4, result.ranking.size()); ++i) {
    const yield::PartRank& rank = result.ranking[i];
    text += fmt::format("{} {} ({} % of the variance)", i == 0 ? "" : ",", rank.part,
                        rounded_text(100.0 * rank.share, 3));
  }
  return text + "\n";
}

Json purchase_json(const std::vector<yield::Purchase>& all) {
  Json out = Json::array();
  for (const yield::Purchase& one : all) {
    out.push_back({{"resistor_percent", one.resistor_percent},
                   {"capacitor_percent", one.capacitor_percent},
                   {"worst_db_p95", one.worst_db_95},
                   {"meets", one.meets}});
  }
  return out;
}

std::string purchase_text(const std::vector<yield::Purchase>& all, double limit_db) {
  if (all.empty() || !all[0].meets) {
    return fmt::format("  no tolerance on the list keeps 95 % of the circuits within {} dB\n",
                       rounded_text(limit_db));
  }
  return fmt::format("  to keep 95 % within {} dB, buy {} % resistors and {} % capacitors ({} dB)\n",
                     rounded_text(limit_db), rounded_text(all[0].resistor_percent),
                     rounded_text(all[0].capacitor_percent), rounded_text(all[0].worst_db_95, 3));
}

/// Everything that the counts depend on, for the checkpoint.
std::string job_text(const yield::Options& o, const Provenance& from) {
  const yield::Spread& s = o.spread;
  std::string text = fmt::format(
      "{} {} {} {} {} {} {} {} {} {} {}", static_cast<int>(s.kind), s.sigmas, s.resistor_percent,
      s.capacitor_percent, s.unit_capacitor_percent, s.temperature_low_c, s.temperature_high_c,
      s.resistor_ppm_per_k, s.capacitor_ppm_per_k, o.limit_db.value_or(-1.0), o.limit_deg.value_or(-1.0));
  for (const Hertz f : o.grid) text += " " + number_text(f.value);
  for (const InputFile& file : from.inputs) text += " " + file.sha256;
  return text;
}

}  // namespace

int run_yield(const std::vector<std::string>& arguments) {
  CommandLine line(
      "yield", "bodesmith yield sections.json -o yield.json --limit-db 0.5",
      "What tolerances make of a design: Monte Carlo over op-amp RC parts or FPAA capacitors. With several "
      "files\n"
      "the designs are compared. Under `mpirun -n N` the work is shared; results do not depend on N.");
  declare(line);
  if (!line.parse(arguments)) return kDone;
  yield::Options options;
  options.spread = read_spread(line);
  options.samples = line.get<std::uint64_t>("samples");
  options.seed = line.seed_value();
  options.threads = line.get<int>("threads");
  if (line.has("limit-db")) options.limit_db = line.positive("limit-db");
  if (line.has("limit-deg")) options.limit_deg = line.positive("limit-deg");
  if (line.has("min-yield-percent") && !options.limit_db && !options.limit_deg) {
    line.fail("--min-yield-percent needs --limit-db or --limit-deg");
  }
  const int count = line.get<int>("count");
  if (count < 1 || count > 100000) line.fail(fmt::format("--count is {}, expected 1 to 100000", count));

  const std::unique_ptr<yield::Team> team = yield::join_team();
  Provenance from;
  std::vector<yield::Design> designs;
  for (const std::string& file : line.files()) designs.push_back(read_design(line, file, from));
  const double low = line.has("from-hz") ? line.positive("from-hz") : designs[0].band.from.value;
  const double high = line.has("to-hz") ? line.positive("to-hz") : designs[0].band.to.value;
  options.grid = count == 1 ? std::vector<Hertz>{Hertz{low}} : log_grid({Hertz{low}, Hertz{high}}, count);

  Json json = json_header("yield", from);
  json["distribution"] = line.get<std::string>("distribution");
  json["seed"] = options.seed;
  json["resistor_percent"] = options.spread.resistor_percent;
  json["capacitor_percent"] = options.spread.capacitor_percent;
  json["unit_capacitor_percent"] = options.spread.unit_capacitor_percent;
  json["temperature_c"] = {options.spread.temperature_low_c, options.spread.temperature_high_c};
  json["designs"] = Json::array();
  std::string text;
  double least_yield = 100.0, best = INFINITY;
  std::string survivor;
  const Stopwatch watch;
  for (size_t i = 0; i < designs.size(); ++i) {
    options.job = job_text(options, from);
    if (line.has("output"))
      options.checkpoint = line.output_path().string() + fmt::format(".checkpoint{}", i + 1);
    Progress progress("yield of " + designs[i].name);
    if (team->leads()) options.progress = [&](double fraction) { progress.at(fraction); };
    const yield::Result result = yield::run_monte_carlo(designs[i], options, *team);
    if (!team->leads()) continue;
    for (const std::string& one : designs[i].notes) note(one);
    Json one = to_json(result, options);
    one["poles"] = designs[i].poles;
    one["parts"] = designs[i].parts.size();
    one["reference"] = designs[i].reference_name;
    text += describe(designs[i], result, options);
    if (options.limit_db && designs[i].reference_name == "sections") {
      const std::vector<yield::Purchase> buy =
          yield::tolerances_to_buy(designs[i], options, *options.limit_db);
      one["to_buy"] = purchase_json(buy);
      text += purchase_text(buy, *options.limit_db);
    }
    json["designs"].push_back(std::move(one));
    least_yield = std::min(least_yield,
                           100.0 * static_cast<double>(result.within) / static_cast<double>(result.samples));
    if (const double p95 = result.worst_db.quantile(0.95); p95 < best) {
      best = p95;
      survivor = result.name;
    }
  }
  if (!team->leads()) return kDone;
  if (designs.size() > 1) {
    text += fmt::format("{} survives its parts best: {} dB in 95 of 100 circuits\n", survivor,
                        rounded_text(best, 3));
    json["best"] = survivor;
  }
  int status = kDone;
  if (line.has("min-yield-percent") && least_yield < line.get<double>("min-yield-percent")) {
    text += fmt::format("the wanted yield of {} % is not met\n",
                        rounded_text(line.get<double>("min-yield-percent")));
    json["limit_missed"] = true;
    status = kLimitMissed;
  }
  json["timing_s"] = {{"compute", watch.seconds()}};
  if (line.has("output")) write_file(line.output_path(), to_text(json));
  print_summary(line, text, json);
  return status;
}

}  // namespace bodesmith::cli
