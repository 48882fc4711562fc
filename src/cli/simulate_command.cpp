#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/simulate_pictures.hpp"
#include "signal/csv.hpp"
#include "signal/time_record.hpp"
#include "simulate/controller_file.hpp"
#include "simulate/record_metrics.hpp"
#include "simulate/references.hpp"
#include "simulate/segments.hpp"
#include "simulate/signal_study.hpp"
#include "simulate/simulate.hpp"
#include "simulate/sweep.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;

void declare(CommandLine& line) {
  line.positional("MODEL.toml", 1, 1);
  line.output("CSV with time_s, u and the model's y (in a loop: time_s, r, u, y; of a sweep: its table)");
  line.options().add_options()("input", po::value<std::string>(),
                               "CSV with time_s, u (in a loop: time_s, r); a y in it is compared with")(
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
      "no-error-estimate", "leave out the second run (record, cvode)")(
      "controller", po::value<std::string>(),
      "controller.toml: close a PI or PID loop round the model, which then follows the input as its "
      "reference");
  line.options().add_options()("spectra", po::value<std::string>(),
                               "also write amplitudes and phases of u and y over frequency (CSV); harmonics "
                               "of the last period when u repeats itself")(
      "loops", po::value<std::string>(),
      "also write hysteresis loops, y over u rising and falling, one a period (CSV)")(
      "report", po::value<std::string>(), "also draw all this: a page (.html) or the drawings alone (.svg)")(
      "fundamental-hz", po::value<double>(), "of a periodic --input (default: looked for)");
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

/// Where the input comes from, and the frequency at which it repeats when that is known.
struct Input {
  TimeRecord record;
  std::optional<Hertz> fundamental;
};

/// --input (its r in a loop), or a reference of the program's own.
Input read_input(const CommandLine& line, bool loop, Provenance& from) {
  if (line.has("input") == line.has("reference")) line.fail("expected either --input or --reference");
  Input out;
  if (line.maybe<double>("fundamental-hz")) out.fundamental = Hertz{line.positive("fundamental-hz")};
  if (line.has("input")) {
    const std::string path = line.get<std::string>("input");
    out.record = loop ? TimeRecord::read_csv_column(path, from, "r") : TimeRecord::read_csv(path, from);
    return out;
  }
  if (out.fundamental) line.fail("--fundamental-hz belongs to --input; a reference has its --frequency-hz");
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
  out.record = simulate::make_reference(spec);
  if (spec.kind == "complex")
    out.fundamental = Hertz{0.1};
  else if (spec.kind != "chirp")
    out.fundamental = spec.frequency;
  return out;
}

/// Loops of every run below one another, told apart by frequency and amplitude; harmonics likewise.
std::string sweep_loops_csv(const std::vector<simulate::SweepRow>& rows) {
  std::vector<double> columns[6];
  for (const auto& row : rows) {
    const simulate::Loop loop = simulate::hysteresis_loop(row.u, row.y);
    for (std::size_t i = 0; i < loop.u.size(); ++i) {
      const double values[] = {row.frequency.value, row.amplitude,      loop.u[i],
                               loop.ascending[i],   loop.descending[i], loop.height_percent};
      for (int k = 0; k < 6; ++k) columns[k].push_back(values[k]);
    }
  }
  CsvWriter csv;
  const char* names[] = {"frequency_hz", "amplitude", "u", "ascending", "descending", "height_percent"};
  for (int k = 0; k < 6; ++k) csv.add(names[k], std::move(columns[k]));
  return csv.text();
}

std::string sweep_spectra_csv(const std::vector<simulate::SweepRow>& rows) {
  std::vector<double> columns[7];
  for (const auto& row : rows) {
    const double step = 1.0 / (row.frequency.value * static_cast<double>(row.u.size()));
    const Spectrum u = spectrum_of(row.u, 0.0, step, true);
    const Spectrum y = spectrum_of(row.y, 0.0, step, true);
    for (std::size_t k = 0; k < u.amplitude.size(); ++k) {
      const double values[] = {row.frequency.value, row.amplitude,  static_cast<double>(k), u.amplitude[k],
                               u.phase_deg[k],      y.amplitude[k], y.phase_deg[k]};
      for (int c = 0; c < 7; ++c) columns[c].push_back(values[c]);
    }
  }
  CsvWriter csv;
  const char* names[] = {"frequency_hz", "amplitude",   "harmonic",   "u_amplitude",
                         "u_phase_deg",  "y_amplitude", "y_phase_deg"};
  for (int c = 0; c < 7; ++c) csv.add(names[c], std::move(columns[c]));
  return csv.text();
}

int run_sweep_command(const CommandLine& line, const chain::Chain& model,
                      const std::optional<simulate::LoopSetup>& loop, const Provenance& from,
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
  options.loop = loop;
  if (loop && loop->drive) line.fail("a sweep cannot use a drive from a file, expected a feedforward model");
  const bool signals = line.has("spectra") || line.has("loops");
  if (signals && line.has("resume"))
    line.fail("--resume takes over rows without their signals, expected no --spectra and no --loops");
  options.keep_periods = signals || line.has("report");
  std::string files;
  for (const auto& file : from.inputs) files += file.sha256;
  const std::string key = simulate::sweep_key(files, options);
  std::vector<simulate::SweepRow> known;
  if (line.has("resume")) known = simulate::read_sweep_csv(line.output_path(), key);
  const std::size_t total = options.frequencies.size() * options.amplitudes.size();

  catch_interrupts();
  const Stopwatch watch;
  const auto rows = simulate::run_sweep(model, options, known);
  const double compute_s = watch.seconds();
  if (rows.empty()) throw Interrupted();
  OutputSet out;
  out.add(line.output_path(), simulate::sweep_csv(rows, key));
  if (line.has("spectra")) out.add(line.get<std::string>("spectra"), sweep_spectra_csv(rows));
  if (line.has("loops")) out.add(line.get<std::string>("loops"), sweep_loops_csv(rows));
  if (line.has("report")) {
    const std::string file = line.get<std::string>("report");
    out.add(file, picture_of(rows, line.files()[0], file));
  }
  out.commit();
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

/// A chain's or a loop's run, with what the summary says of it.
struct Run {
  std::vector<double> y;
  std::vector<double> drive;  ///< empty without a loop
  std::optional<double> error_estimate;
  double model_error = 0.0;
  simulate::Stats stats;
  std::vector<std::string> notes;
};

Run run_once(const chain::Chain& model, const std::optional<simulate::LoopSetup>& loop,
             const TimeRecord& input, const simulate::Options& options) {
  if (loop) {
    simulate::LoopResult r = simulate::simulate_loop(model, *loop, input, options);
    return {std::move(r.y), std::move(r.drive), r.error_estimate, r.model_error, r.stats, {}};
  }
  simulate::Result r = simulate::simulate(model, input, options);
  return {std::move(r.y), {}, r.error_estimate, r.model_error, r.stats, std::move(r.notes)};
}

/// What --spectra, --loops and --report add.
void add_study(const CommandLine& line, const Input& input, const std::vector<double>& time, const Run& run,
               OutputSet& out, Json& json, std::string& text) {
  const std::string name = run.drive.empty() ? "u" : "r";
  const TimeRecord& record = input.record;
  if (record.size() < 2) line.fail("a record of one sample has no spectrum and no loop");
  const simulate::SignalStudy study =
      simulate::study_signals(record.u, run.y, record.start_s, record.step_s, input.fundamental);
  if (!study.repetition) {
    note(input.fundamental ? "the record holds no whole number of samples that are whole periods: one "
                             "windowed spectrum, one loop"
                           : "the input does not repeat itself: one windowed spectrum, one loop");
  }
  if (line.has("spectra")) out.add(line.get<std::string>("spectra"), study.spectra_csv(name));
  if (line.has("loops")) out.add(line.get<std::string>("loops"), study.loops_csv(name));
  json["spectra"] = study.spectra_json(name);
  json["loops"] = study.loops_json();
  if (study.u_distortion_percent && study.y_distortion_percent) {
    text += fmt::format("harmonics of {} Hz: distortion of {} {} %, of y {} %\n",
                        rounded_text(study.fundamental->value), name,
                        rounded_text(*study.u_distortion_percent), rounded_text(*study.y_distortion_percent));
  }
  text += fmt::format(
      "loop height {} ({} % of the range of y), {}\n", rounded_text(study.loops.back().height),
      rounded_text(study.loops.back().height_percent), study.repetition ? "last period" : "whole record");
  if (!line.has("report")) return;
  SimulatedRun picture;
  picture.title = line.files()[0];
  picture.input = name;
  picture.time_s = time;
  picture.in = record.u;
  picture.y = run.y;
  picture.drive = run.drive;
  picture.study = &study;
  const auto against = simulate::compare_records(record.u, run.y);
  picture.figures = {
      {rounded_text(against.rms_percent_of_range, 3) + " %", "rms of y - " + name + ", of the range of y"},
      {rounded_text(study.loops.back().height_percent, 3) + " %", "loop height, of the range of y"}};
  if (study.y_distortion_percent)
    picture.figures.emplace_back(rounded_text(*study.y_distortion_percent, 3) + " %",
                                 "harmonic distortion of y");
  if (run.error_estimate)
    picture.figures.emplace_back(fmt::format("{:.1e}", *run.error_estimate), "numerical error of y");
  const std::string file = line.get<std::string>("report");
  out.add(file, picture_of(picture, file));
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
  std::optional<simulate::LoopSetup> loop;
  if (line.has("controller")) loop = simulate::read_controller(line.get<std::string>("controller"), from);
  if (line.has("sweep-frequency-hz")) return run_sweep_command(line, model, loop, from, options);
  const Input input = read_input(line, loop.has_value(), from);
  const TimeRecord& record = input.record;

  const Stopwatch watch;
  const Run run = run_once(model, loop, record, options);
  const double compute_s = watch.seconds();
  for (const std::string& text : run.notes) note(text);

  CsvWriter csv;
  std::vector<double> time(record.size());
  for (std::size_t i = 0; i < time.size(); ++i) time[i] = record.time_s(i);
  csv.add("time_s", time);
  csv.add(loop ? "r" : "u", record.u);
  if (loop) csv.add("u", run.drive);
  csv.add("y", run.y);
  OutputSet out;
  out.add(line.output_path(), csv.text());

  Json json = json_header("simulate_summary", from);
  json["timing_s"] = {{"compute", compute_s}, {"engine", run.stats.compute_s}};
  json["samples"] = record.size();
  json["engine"] = run.stats.engine;
  json["steps"] = run.stats.steps;
  if (!loop) {
    json["segments"] = Json::array();
    for (const simulate::Segment& s : simulate::segments_of(model, run.stats.engine))
      json["segments"].push_back({{"blocks", {s.first, s.last}}, {"method", s.method}});
  }
  if (run.stats.degree > 0) json["hold_degree"] = run.stats.degree;
  if (run.stats.engine == "cvode") {
    json["evaluations"] = run.stats.evaluations;
    json["restarts"] = run.stats.restarts;
    json["events"] = run.stats.events;
  }
  if (run.error_estimate) json["error_estimate"] = *run.error_estimate;
  json["model_error_relative"] = run.model_error;
  const auto [low, high] = std::minmax_element(run.y.begin(), run.y.end());
  json["output_range"] = *high - *low;
  std::string text = fmt::format(
      "{} samples of y, from {} to {}\nengine {}{}\n", record.size(), rounded_text(*low), rounded_text(*high),
      run.stats.engine,
      run.error_estimate ? fmt::format(", numerical error about {:.1e}", *run.error_estimate) : "");
  if (run.model_error > 0.0) {
    text += fmt::format("fractional terms stand in by an approximation within {:.1e} of their response\n",
                        run.model_error);
  }
  const auto compare = [&](const char* key, const std::string& with, std::span<const double> a,
                           std::span<const double> b) {
    const auto gap = simulate::compare_records(a, b);
    json[key] = {{"rms", gap.rms}, {"max", gap.max}, {"rms_percent_of_range", gap.rms_percent_of_range}};
    text += fmt::format("{}: rms {} ({} % of its range), at most {}\n", with, rounded_text(gap.rms),
                        rounded_text(gap.rms_percent_of_range), rounded_text(gap.max));
  };
  if (loop) compare("tracking_error", "r against y", record.u, run.y);
  if (!record.y.empty()) compare("against_record", "against the record's y", run.y, record.y);
  if (line.has("spectra") || line.has("loops") || line.has("report"))
    add_study(line, input, time, run, out, json, text);
  out.commit();
  print_summary(line, text, json);
  return kDone;
}

}  // namespace bodesmith::cli
