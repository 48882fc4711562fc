#include <fmt/format.h>

#include <algorithm>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "cli/commands.hpp"
#include "cli/modes/simulate_modes.hpp"
#include "cli/modes/simulate_pictures.hpp"
#include "cli/shared_options.hpp"
#include "invert/compensation.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"
#include "signal/statistics.hpp"
#include "simulate/controller_file.hpp"
#include "simulate/references.hpp"
#include "simulate/signal_study.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::cli {
namespace {

void declare_simulate(CommandLine& line) {
  line.positional("MODEL.toml|SECTIONS.json", 1, 1);
  line.output("CSV with time_s, u and the model's y (in a loop: time_s, r, u, y; of a sweep: its table)");
  add_input_options(line);
  line.option<std::string>(
      "start",
      "zero: all states zero before the first sample; equilibrium: at rest under the first input (default: what "
      "the model's own start says, otherwise zero)");
  line.words("start", {"zero", "equilibrium"});
  line.option<std::string>(
      "engine",
      "automatic: in closed form where there is one, else from sample to sample, refined until "
      "--tolerance is met; exact: closed form or nothing; record: from sample to sample with one "
      "step; cvode: the chain as an ODE with events; grunwald-letnikov: a linear chain by the tool-servo paper's eq. 2",
      "automatic");
  line.words("engine", {"automatic", "exact", "record", "cvode", "grunwald-letnikov"});
  line.option<double>("tolerance", "relative, of the largest output (automatic) or of each state (cvode)",
                      1e-8);
  line.option<int>("oversample",
                   "initial number of steps per sample interval (automatic, record, grunwald-letnikov)", 1);
  line.flag("no-error-estimate", "leave out the second run (record, cvode)");
  line.option<std::string>(
      "controller",
      "controller.toml: close a PI or PID loop round the model, which then follows the input as "
      "its reference");
  line.option<std::string>(
      "spectra",
      "also write amplitudes and phases of u and y over frequency (CSV); harmonics of the last "
      "period when u repeats");
  line.option<std::string>("loops",
                           "also write hysteresis loops, y over u rising and falling, one a period (CSV)");
  line.option<std::string>("report", "also plot all this: a page (.html) or the plots alone (.svg)");
  add_sweep_options(line);
  line.seed();
}

simulate::Options read_simulation_options(const CommandLine& line) {
  using simulate::Engine;
  using simulate::Start;
  simulate::Options options;
  options.engine = line.choice(
      "engine", {Engine::automatic, Engine::exact, Engine::record, Engine::cvode, Engine::grunwald_letnikov});
  if (line.has("start")) options.start = line.choice("start", {Start::zero, Start::equilibrium});
  options.relative_tolerance = line.positive("tolerance");
  options.absolute_tolerance = 1e-2 * options.relative_tolerance;
  options.oversample = static_cast<std::size_t>(line.integer("oversample", 1, 1024));
  options.estimate_error = !line.has("no-error-estimate");
  return options;
}

/// A chain's or a loop's run, and what the summary says about it.
struct SimulatedOutput {
  std::vector<double> y;
  std::vector<double> drive;  ///< empty without a loop
  std::optional<double> error_estimate;
  double model_error = 0.0;
  simulate::Stats stats;
  std::vector<std::string> notes;
};

SimulatedOutput simulate_once(const chain::Chain& model, const std::optional<simulate::LoopSetup>& loop,
                              const TimeRecord& input, const simulate::Options& options) {
  if (loop) {
    simulate::LoopResult r = simulate::simulate_loop(model, *loop, input, options);
    return {std::move(r.y), std::move(r.drive), r.error_estimate, r.model_error, r.stats, std::move(r.notes)};
  }
  simulate::Result r = simulate::simulate(model, input, options);
  return {std::move(r.y), {}, r.error_estimate, r.model_error, r.stats, std::move(r.notes)};
}

/// The loop, the drive of its inverse.toml worked out for this reference.
std::optional<simulate::LoopSetup> with_drive(std::optional<simulate::LoopSetup> loop,
                                              const TimeRecord& reference, Provenance& from) {
  if (!loop || loop->inverse.empty()) return loop;
  const invert::InverseFile inverse = invert::InverseFile::read(loop->inverse, from);
  loop->drive = reference;
  loop->drive->u = invert::compensate(inverse.model, reference, inverse.options).drive;
  return loop;
}

/// The plots that --report asks for.
std::string study_report(const CommandLine& line, const TimeRecord& record, const SimulatedOutput& run,
                         const simulate::SignalStudy& study, const std::string& name) {
  SimulatedRun picture;
  picture.title = line.files()[0];
  picture.input = name;
  picture.time_s = record.times_s();
  picture.in = record.u;
  picture.y = run.y;
  picture.drive = run.drive;
  picture.study = &study;
  // Only what has the same unit as y is compared with it.
  picture.measured = record.y;
  if (!record.y.empty()) {
    const auto against = error_figures(run.y, record.y);
    picture.figures.emplace_back(rounded_text(against.rms_percent, 3) + " %",
                                 "rms of y - y measured, of the range of y measured");
  } else if (!run.drive.empty()) {
    const auto against = error_figures(record.u, run.y);
    picture.figures.emplace_back(rounded_text(against.rms_percent, 3) + " %",
                                 "rms of r - y, of the range of y");
  }
  picture.figures.emplace_back(rounded_text(study.loops.back().height_percent, 3) + " %",
                               "loop height, of the range of y");
  if (study.y_distortion_percent)
    picture.figures.emplace_back(rounded_text(*study.y_distortion_percent, 3) + " %",
                                 "harmonic distortion of y");
  if (run.error_estimate)
    picture.figures.emplace_back(fmt::format("{:.1e}", *run.error_estimate), "numerical error of y");
  return picture_of(picture, line.get<std::string>("report"));
}

/// What --spectra, --loops and --report add.
void add_study(const CommandLine& line, const SimulationInput& input, const SimulatedOutput& run,
               OutputSet& out, Json& json, std::string& text) {
  const std::string name = run.drive.empty() ? "u" : "r";
  const TimeRecord& record = input.record;
  if (record.size() < 2) line.fail("a record of one sample has no spectrum and no loop");
  const simulate::SignalStudy study =
      simulate::study_signals(record.u, run.y, record.start_s, record.step_s, input.fundamental);
  if (!study.repetition) {
    note(input.fundamental ? "no whole number of periods is a whole number of samples: one windowed "
                             "spectrum, one loop"
                           : "the input does not repeat: one windowed spectrum, one loop");
  }
  if (line.has("report")) {
    out.add(line.get<std::string>("report"), study_report(line, record, run, study, name));
  }
  if (line.has("spectra")) out.add(line.get<std::string>("spectra"), spectra_csv(study, name));
  if (line.has("loops")) out.add(line.get<std::string>("loops"), loops_csv(study, name));
  json["spectra"] = spectra_json(study, name);
  json["loops"] = loops_json(study);
  if (study.u_distortion_percent && study.y_distortion_percent) {
    text += fmt::format("harmonics of {} Hz: distortion of {} {} %, of y {} %\n",
                        rounded_text(study.fundamental->value), name,
                        rounded_text(*study.u_distortion_percent), rounded_text(*study.y_distortion_percent));
  }
  text += fmt::format(
      "loop height {} ({} % of the range of y), {}\n", rounded_text(study.loops.back().height),
      rounded_text(study.loops.back().height_percent), study.repetition ? "last period" : "whole record");
}

std::string output_csv(const TimeRecord& record, const SimulatedOutput& run, bool loop) {
  CsvWriter csv;
  csv.add(column::time_s, record.times_s());
  csv.add(loop ? column::reference : column::input, record.u);
  if (loop) csv.add(column::input, run.drive);
  csv.add(column::output, run.y);
  return csv.text();
}

/// What the engine did, for the summary as JSON.
void add_engine_json(const chain::Chain& model, const SimulatedOutput& run, bool loop, Json& json) {
  json["engine"] = to_string(run.stats.engine);
  json["steps"] = run.stats.steps;
  if (!loop) {
    json["segments"] = Json::array();
    for (const simulate::Segment& s : simulate::segments_of(model, run.stats.engine))
      json["segments"].push_back({{"blocks", {s.first, s.last}}, {"method", s.method}});
  }
  if (run.stats.degree > 0) json["hold_degree"] = run.stats.degree;
  if (run.stats.engine == simulate::Engine::cvode) {
    json["evaluations"] = run.stats.evaluations;
    json["restarts"] = run.stats.restarts;
    json["events"] = run.stats.events;
  }
  if (run.error_estimate) json["error_estimate"] = *run.error_estimate;
  json["model_error_relative"] = run.model_error;
}

std::string engine_text(const SimulatedOutput& run) {
  std::string text = fmt::format(
      "engine {}{}\n", to_string(run.stats.engine),
      run.error_estimate ? fmt::format(", numerical error about {:.1e}", *run.error_estimate) : "");
  if (run.model_error > 0.0) {
    text +=
        fmt::format("fractional terms are approximated within {:.1e} of their response\n", run.model_error);
  }
  return text;
}

/// The difference between two signals, into the JSON summary under `key` and as a line of text.
std::string compare_signals(const char* key, const std::string& what, std::span<const double> a,
                            std::span<const double> b, Json& json) {
  const auto gap = error_figures(a, b);
  json[key] = {{"rms", gap.rms}, {"max", gap.max}, {"rms_percent_of_range", gap.rms_percent}};
  return fmt::format("{}: rms {} ({} % of its range), at most {}\n", what, rounded_text(gap.rms),
                     rounded_text(gap.rms_percent), rounded_text(gap.max));
}

int simulate_file(const CommandLine& line, const chain::Chain& model,
                  const std::optional<simulate::LoopSetup>& loop, Provenance& from,
                  const simulate::Options& options) {
  const SimulationInput input = read_input(line, loop.has_value(), from);
  const TimeRecord& record = input.record;
  const Stopwatch watch;
  const SimulatedOutput run = simulate_once(model, with_drive(loop, record, from), record, options);
  const double compute_s = watch.seconds();
  for (const std::string& text : run.notes) note(text);

  OutputSet out;
  out.add(line.output_path(), output_csv(record, run, loop.has_value()));

  Json json = json_header("simulate_summary", from);
  json["timing_s"] = {{"compute", compute_s}, {"engine", run.stats.compute_s}};
  json["samples"] = record.size();
  add_engine_json(model, run, loop.has_value(), json);
  const auto [low, high] = std::minmax_element(run.y.begin(), run.y.end());
  json["output_range"] = *high - *low;
  std::string text = fmt::format("{} samples of y, from {} to {}\n{}", record.size(), rounded_text(*low),
                                 rounded_text(*high), engine_text(run));
  if (loop) text += compare_signals("tracking_error", "r against y", record.u, run.y, json);
  if (!record.y.empty() || loop) json["percent_of_range"] = kPercentOfRange;
  if (!record.y.empty())
    text += compare_signals("against_record", "against the record's y", run.y, record.y, json);
  if (line.has("spectra") || line.has("loops") || line.has("report"))
    add_study(line, input, run, out, json, text);
  out.commit();
  return print_summary(line, text, json);
}

}  // namespace

int run_simulate(const std::vector<std::string>& arguments) {
  CommandLine line("simulate", "bodesmith simulate model.toml --input u.csv -o y.csv",
                   "A model's output for an input record, taken as a straight line between samples.");
  declare_simulate(line);
  line.reads_records();
  if (!line.parse(arguments)) return kDone;
  const simulate::Options options = read_simulation_options(line);
  Provenance from = line.new_provenance();
  const chain::Chain model = chain::read_model(line.files()[0], from);
  std::optional<simulate::LoopSetup> loop;
  if (line.has("controller")) loop = simulate::read_controller(line.get<std::string>("controller"), from);
  return line.has("sweep-frequency-hz") ? simulate_sweep(line, model, loop, from, options)
                                        : simulate_file(line, model, loop, from, options);
}

void add_input_options(CommandLine& line) {
  line.option<std::string>(
      "input", "CSV with time_s, u (in a loop: time_s, r); if it has a y, the result is compared with it");
  line.option<double>("fundamental-hz", "of a periodic --input (default: detected)");
  line.option<std::string>(
      "reference",
      "instead of --input: triangle, sine, stair (or steps), multisine, chirp or complex (the compound "
      "trajectory of 'Modeling and Control of Piezoelectric Hysteresis')");
  add_reference_options(line, UsualLength::second);
}

SimulationInput read_input(const CommandLine& line, bool loop, Provenance& from) {
  if (line.has("input") == line.has("reference")) line.fail("expected either --input or --reference");
  SimulationInput out;
  if (const auto fundamental = line.maybe_positive("fundamental-hz")) out.fundamental = Hertz{*fundamental};
  if (line.has("input")) {
    const std::string path = line.get<std::string>("input");
    out.record =
        loop ? TimeRecord::read_csv_column(path, from, column::reference) : TimeRecord::read_csv(path, from);
    out.record.require_measured_sizes();
    if (out.fundamental && !(2.0 * out.fundamental->value * out.record.step_s < 1.0))
      line.fail("--fundamental-hz is not below half the sampling rate of " + path);
    return out;
  }
  if (out.fundamental) line.fail("--fundamental-hz belongs to --input; a reference has its --frequency-hz");
  const simulate::ReferenceSpec spec =
      read_reference_options(line, line.get<std::string>("reference"), UsualLength::second);
  out.record = simulate::make_reference(spec);
  out.fundamental = simulate::fundamental_of(spec);
  return out;
}

}  // namespace bodesmith::cli
