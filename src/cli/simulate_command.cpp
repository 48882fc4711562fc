#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "signal/csv.hpp"
#include "signal/time_record.hpp"
#include "simulate/record_metrics.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;

void declare(CommandLine& line) {
  line.positional("MODEL.toml", 1, 1);
  line.output("CSV with time_s, u and the model's y");
  line.options().add_options()("input", po::value<std::string>(),
                               "CSV with time_s, u; a y in it is compared with")(
      "start", po::value<std::string>()->default_value("zero"),
      "zero: all states zero before the first sample; equilibrium: at rest under the first input")(
      "engine", po::value<std::string>()->default_value("automatic"),
      "automatic: from sample to sample, refined until --tolerance is met; record: the same with one step; "
      "cvode: "
      "the chain as an ODE with events")(
      "tolerance", po::value<double>()->default_value(1e-8),
      "relative, of the largest output (automatic) or of each state (cvode)")(
      "oversample", po::value<int>()->default_value(1),
      "steps a sample interval to start with (automatic, record)")(
      "degree", po::value<int>()->default_value(0),
      "of the hold between samples, 1 to 4; 0: as the model needs")(
      "no-error-estimate", "leave out the second run (record, cvode)");
}

simulate::Options read_options(const CommandLine& line) {
  simulate::Options options;
  const std::string engine = line.get<std::string>("engine");
  if (engine == "record") {
    options.engine = simulate::Engine::record;
  } else if (engine == "cvode") {
    options.engine = simulate::Engine::cvode;
  } else if (engine == "exact") {
    options.engine = simulate::Engine::exact;
  } else if (engine != "automatic") {
    line.fail(fmt::format("--engine is '{}', expected automatic, exact, record or cvode", engine));
  }
  const std::string start = line.get<std::string>("start");
  if (start == "equilibrium") {
    options.start = simulate::Start::equilibrium;
  } else if (start != "zero") {
    line.fail(fmt::format("--start is '{}', expected zero or equilibrium", start));
  }
  options.relative_tolerance = line.positive("tolerance");
  options.absolute_tolerance = 1e-2 * options.relative_tolerance;
  options.oversample = line.get<int>("oversample");
  if (options.oversample < 1 || options.oversample > 1024) line.fail("--oversample is outside 1 to 1024");
  options.degree = line.get<int>("degree");
  if (options.degree < 0 || options.degree > 4) line.fail("--degree is outside 0 to 4");
  options.estimate_error = !line.has("no-error-estimate");
  return options;
}

}  // namespace

int run_simulate(const std::vector<std::string>& arguments) {
  CommandLine line("simulate", "bodesmith simulate model.toml --input u.csv -o y.csv",
                   "A model's output for an input record, a straight line between samples.");
  declare(line);
  if (!line.parse(arguments)) return kDone;
  const simulate::Options options = read_options(line);
  if (!line.has("input")) line.fail("--input is missing, expected a CSV with time_s and u");
  Provenance from;
  const chain::Chain model = chain::read_model(line.files()[0], from);
  const TimeRecord input = TimeRecord::read_csv(line.get<std::string>("input"), from);

  const Stopwatch watch;
  const simulate::Result result = simulate::simulate(model, input, options);
  const double compute_s = watch.seconds();
  for (const std::string& text : result.notes) note(text);

  CsvWriter csv;
  std::vector<double> time(input.size());
  for (std::size_t i = 0; i < time.size(); ++i) time[i] = input.time_s(i);
  csv.add("time_s", std::move(time));
  csv.add("u", input.u);
  csv.add("y", result.y);
  write_file(line.output_path(), csv.text());

  Json json = json_header("simulate_summary", from);
  json["timing_s"] = {{"compute", compute_s}, {"engine", result.stats.compute_s}};
  json["samples"] = input.size();
  json["engine"] = result.stats.engine;
  json["steps"] = result.stats.steps;
  if (result.stats.degree > 0) json["hold_degree"] = result.stats.degree;
  if (result.stats.engine == "cvode") {
    json["evaluations"] = result.stats.evaluations;
    json["restarts"] = result.stats.restarts;
    json["events"] = result.stats.events;
  }
  if (result.error_estimate) json["error_estimate"] = *result.error_estimate;
  json["model_error_relative"] = result.model_error;
  const auto [low, high] = std::minmax_element(result.y.begin(), result.y.end());
  json["output_range"] = *high - *low;
  std::string text = fmt::format(
      "{} samples of y, from {} to {}\nengine {}{}\n", input.size(), rounded_text(*low), rounded_text(*high),
      result.stats.engine,
      result.error_estimate ? fmt::format(", numerical error about {:.1e}", *result.error_estimate) : "");
  if (result.model_error > 0.0) {
    text += fmt::format("fractional terms stand in by an approximation within {:.1e} of their response\n",
                        result.model_error);
  }
  if (!input.y.empty()) {
    const auto gap = simulate::compare_records(result.y, input.y);
    json["against_record"] = {
        {"rms", gap.rms}, {"max", gap.max}, {"rms_percent_of_range", gap.rms_percent_of_range}};
    text += fmt::format("against the record's y: rms {} ({} % of its range), at most {}\n",
                        rounded_text(gap.rms), rounded_text(gap.rms_percent_of_range), rounded_text(gap.max));
  }
  print_summary(line, text, json);
  return kDone;
}

}  // namespace bodesmith::cli
