#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "signal/csv.hpp"
#include "signal/time_record.hpp"
#include "simulate/record_metrics.hpp"
#include "simulate/references.hpp"
#include "simulate/simulate.hpp"
#include "simulate/sweep.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;

void declare(CommandLine& line) {
  line.positional("MODEL.toml", 1, 1);
  line.output("CSV with time_s, u and the model's y (of a sweep: its table)");
  line.options().add_options()("input", po::value<std::string>(),
                               "CSV with time_s, u; a y in it is compared with")(
      "start", po::value<std::string>()->default_value("zero"),
      "zero: all states zero before the first sample; equilibrium: at rest under the first input")(
      "engine", po::value<std::string>()->default_value("automatic"),
      "automatic: in closed form where there is one, else from sample to sample, refined until --tolerance "
      "is "
      "met; exact: closed form or nothing; record: from sample to sample with one step; cvode: the chain as "
      "an "
      "ODE with events")("tolerance", po::value<double>()->default_value(1e-8),
                         "relative, of the largest output (automatic) or of each state (cvode)")(
      "oversample", po::value<int>()->default_value(1),
      "steps a sample interval to start with (automatic, record)")(
      "degree", po::value<int>()->default_value(0),
      "of the hold between samples, 1 to 4; 0: as the model needs")(
      "no-error-estimate", "leave out the second run (record, cvode)");
  line.options().add_options()(
      "reference", po::value<std::string>(),
      "instead of --input: triangle, sine, stair, multisine, chirp or complex (the first seed's)")(
      "frequency-hz", po::value<double>()->default_value(1.0),
      "of the reference; of a chirp's or multisine's lowest end")(
      "last-hz", po::value<double>()->default_value(100.0), "highest frequency of a chirp or multisine")(
      "amplitude", po::value<double>()->default_value(0.5), "half the height of the reference")(
      "offset", po::value<double>(), "its middle (default: the amplitude, so that it starts at 0)")(
      "duration-s", po::value<double>()->default_value(1.0), "how long")(
      "step-s", po::value<double>()->default_value(1e-3), "between its samples")(
      "steps", po::value<int>()->default_value(10), "levels of a stair")(
      "sweep-frequency-hz", po::value<std::string>(),
      "a table of tracking figures instead, for these frequencies (1,10,100); -o is then that table")(
      "sweep-amplitude", po::value<std::string>(), "and these amplitudes")(
      "periods", po::value<int>()->default_value(3), "of each run; the last one counts")(
      "samples-per-period", po::value<int>()->default_value(1000), "of each run")(
      "resume", "take over the rows that the table at -o already has");
  line.seed();
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

/// "1,10,100" as numbers above 0.
std::vector<double> number_list(const CommandLine& line, const std::string& option) {
  std::vector<double> out;
  const std::string text = line.get<std::string>(option);
  for (const std::string_view part : split(text, ',')) {
    double value = 0.0;
    if (!parse_number(trim(part), value) || !(value > 0.0)) {
      line.fail(fmt::format("--{} has '{}', expected numbers above 0 with commas between", option, part));
    }
    out.push_back(value);
  }
  return out;
}

/// --input, or a reference of the program's own.
TimeRecord read_input(const CommandLine& line, Provenance& from) {
  if (line.has("input") == line.has("reference")) line.fail("expected either --input or --reference");
  if (line.has("input")) return TimeRecord::read_csv(line.get<std::string>("input"), from);
  simulate::ReferenceSpec spec;
  spec.kind = line.get<std::string>("reference");
  spec.frequency = Hertz{line.positive("frequency-hz")};
  spec.last = Hertz{line.positive("last-hz")};
  spec.amplitude = line.positive("amplitude");
  spec.offset = line.maybe<double>("offset").value_or(spec.amplitude);
  spec.duration_s = line.positive("duration-s");
  spec.step_s = line.positive("step-s");
  spec.steps = line.get<int>("steps");
  spec.seed = line.seed_value();
  return simulate::make_reference(spec);
}

int run_sweep_command(const CommandLine& line, const chain::Chain& model, const Provenance& from,
                      const simulate::Options& simulation) {
  simulate::SweepOptions options;
  options.kind = line.has("reference") ? line.get<std::string>("reference") : "triangle";
  for (const double f : number_list(line, "sweep-frequency-hz")) options.frequencies.push_back(Hertz{f});
  options.amplitudes = line.has("sweep-amplitude") ? number_list(line, "sweep-amplitude")
                                                   : std::vector<double>{line.positive("amplitude")};
  options.offset = line.maybe<double>("offset");
  options.periods = line.get<int>("periods");
  options.samples_per_period = line.get<int>("samples-per-period");
  options.simulation = simulation;
  const std::string key = simulate::sweep_key(from.inputs.front().sha256, options);
  std::vector<simulate::SweepRow> known;
  if (line.has("resume")) known = simulate::read_sweep_csv(line.output_path(), key);
  const std::size_t total = options.frequencies.size() * options.amplitudes.size();

  catch_interrupts();
  const Stopwatch watch;
  const auto rows = simulate::run_sweep(model, options, known);
  const double compute_s = watch.seconds();
  if (rows.empty()) throw Interrupted();
  write_file(line.output_path(), simulate::sweep_csv(rows, key));
  if (rows.size() < total) {
    note(fmt::format("stopped after {} of {} runs; --resume goes on from there", rows.size(), total));
  }

  Json json = json_header("sweep_summary", from);
  json["timing_s"] = {{"compute", compute_s}};
  json["runs"] = rows.size();
  json["runs_taken_over"] = known.size();
  json["complete"] = rows.size() == total;
  std::string text = fmt::format("{:>12} {:>10} {:>10} {:>10} {:>10} {:>9} {:>10}\n", "frequency_hz",
                                 "amplitude", "rms_%", "max_%", "loop_%", "gain_db", "phase_deg");
  for (const auto& r : rows) {
    text += fmt::format("{:>12} {:>10} {:>10} {:>10} {:>10} {:>9} {:>10}\n", rounded_text(r.frequency.value),
                        rounded_text(r.amplitude), rounded_text(r.rms_percent, 3),
                        rounded_text(r.max_percent, 3), rounded_text(r.loop_height_percent, 3),
                        rounded_text(r.gain_db, 3), rounded_text(r.phase_deg, 3));
  }
  print_summary(line, text, json);
  return kDone;
}

}  // namespace

int run_simulate(const std::vector<std::string>& arguments) {
  CommandLine line("simulate", "bodesmith simulate model.toml --input u.csv -o y.csv",
                   "A model's output for an input record, a straight line between samples.");
  declare(line);
  if (!line.parse(arguments)) return kDone;
  const simulate::Options options = read_options(line);
  Provenance from;
  const chain::Chain model = chain::read_model(line.files()[0], from);
  if (line.has("sweep-frequency-hz")) return run_sweep_command(line, model, from, options);
  const TimeRecord input = read_input(line, from);

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
