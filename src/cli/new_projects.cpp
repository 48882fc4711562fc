#include "cli/new_projects.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <numbers>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/terminal.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "chain/registry.hpp"
#include "identify/stage_disturbance.hpp"
#include "numeric/random.hpp"
#include "signal/bode_points.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"
#include "signal/disturbance.hpp"
#include "signal/time_record.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::cli {
namespace {
namespace fs = std::filesystem;

/// The text of a file that a person has, checked by the reader that will read it, or the template `example`.
template <class Read>
std::string own_or_example(const CommandLine& line, const std::string& option, const char* example,
                           Read read) {
  if (!line.has(option)) return render_template(example, {});
  const fs::path path = line.get<std::string>(option);
  Provenance from;
  read(path, from);
  return read_file(path);
}

void choose_hardware(const CommandLine& line, const Answers& answers, const std::string& standard,
                     Json& data) {
  const std::string given =
      answers.asks() || line.has("hardware")
          ? answers.text("hardware", "Built from: circuit (op-amps), fpaa (a board), both")
          : standard;
  if (given != "circuit" && given != "fpaa" && given != "both")
    line.fail(fmt::format("--hardware is '{}', expected circuit, fpaa or both", given));
  data["circuit"] = given != "fpaa";
  data["fpaa"] = given != "circuit";
}

NewProject filter_project(const CommandLine& line, const Answers& answers, Json& data) {
  NewProject out;
  out.about = "A magnitude read off a curve, to op-amps or a board.";
  data["max_error_db"] = number_text(answers.number("max-error-db", "Largest error at a point, in dB"));
  choose_hardware(line, answers, "circuit", data);
  out.command = "bodesmith run project.toml -o out";
  out.schemas = {"project"};
  out.files = {
      {"points.csv", "the curve: put your own points here",
       own_or_example(line, "points", "new/points.csv",
                      [](const fs::path& path, Provenance& from) { BodePoints::read_csv(path, from); })},
      {"project.toml", "what is required, and what it is built from",
       render_template("new/filter.toml", data)}};
  out.next = {"`out/report.html`: the curve, the errors of every step, the parts",
              "`bodesmith fit points.csv --direct --order 4 -o sections.json`: the fit alone"};
  return out;
}

NewProject pid_project(const CommandLine& line, const Answers& answers, Json& data) {
  NewProject out;
  out.about = "A fractional PID as a circuit.";
  for (const auto& [key, question] : {std::pair{"kp", "kp"},
                                      {"ki", "ki (of ki s^-lambda)"},
                                      {"lambda", "lambda"},
                                      {"kd", "kd (of kd s^mu)"},
                                      {"mu", "mu"}})
    data[key] = number_text(answers.number(key, question));
  data["from_hz"] = number_text(answers.number("from-hz", "Lower end of the band, in Hz"));
  data["to_hz"] = number_text(answers.number("to-hz", "Upper end of the band, in Hz"));
  choose_hardware(line, answers, "circuit", data);
  out.command = "bodesmith run project.toml -o out";
  out.schemas = {"project", "fractional"};
  out.files = {{"pid.toml", "the controller: its gains and powers", render_template("new/pid.toml", data)},
               {"project.toml", "the band, and what it is built from",
                render_template("new/fractional-pid.toml", data)}};
  out.next = {"`bodesmith bode --series pid.toml plant.toml --margins`: the loop with your plant"};
  return out;
}

/// What records of a stage say of it: disturbance.json, gains.csv, and the plant's keys.
struct RecordedStage {
  std::string disturbance;
  std::string gains;
};
RecordedStage recorded_stage(const CommandLine& line, Json& data, std::vector<std::string>& track) {
  for (const char* other : {"points", "disturbance"})
    if (line.has(other)) line.fail(fmt::format("--records and --{} exclude each other", other));
  Provenance from;
  std::vector<TimeRecord> records;
  for (const std::string& file : line.get<std::vector<std::string>>("records"))
    records.push_back(TimeRecord::read_csv(file, from, true));
  const identify::StageDisturbance study = identify::identify_disturbance(records);
  if (study.disturbance.rate.frequency.size() < 2)
    line.fail(
        "--records needs full strokes at two frequencies at least: how the loop grows with frequency is what is built");
  for (const std::string& one : study.notes) note(one);
  Json document = json_header("disturbance", from);
  document.update(study.to_json());
  data["branch"] = std::string(to_string(study.varying()));
  data["base_hz"] = number_text(study.disturbance.rate.frequency.front().value);
  track.clear();
  for (const Hertz f : study.disturbance.rate.frequency) track.push_back(number_text(f.value));
  if (study.lag.kind == identify::StageLag::Kind::amplifier)
    data["amplifier_hz"] = number_text(1.0 / (2.0 * std::numbers::pi * study.lag.seconds));
  if (!line.has("stroke-m")) {
    // A piezo stage moves nanometres to a millimetre: a number within that can only be metres.
    const double stroke = std::abs(study.loops.front().stroke);
    if (!(stroke > 1e-9 && stroke < 1e-3))
      line.fail(fmt::format(
          "--stroke-m is missing: the records' stroke is {} of their own unit, expected what that is in m",
          rounded_text(stroke)));
    data["stroke_m"] = number_text(stroke);
  }
  return {to_text(document), study.gains_csv()};
}

NewProject stage_project(const CommandLine& line, const Answers& answers, Json& data) {
  NewProject out;
  out.about = "An analog controller against the hysteresis of a piezo stage.";
  data["stroke_m"] = number_text(answers.number("stroke-m", "Full stroke of the stage, in m"));
  data["branch"] = "descending";
  data["amplifier_hz"] = "100e3";
  data["base_hz"] = "1.0";
  std::vector<std::string> track = {"1", "10", "100"};
  RecordedStage own;
  if (line.has("records")) {
    own = recorded_stage(line, data, track);
  } else {
    own.gains = own_or_example(line, "points", "new/gains.csv", [&](const fs::path& path, Provenance& from) {
      data["base_hz"] = number_text(BodePoints::read_csv(path, from).points.front().frequency.value);
    });
    own.disturbance =
        own_or_example(line, "disturbance", "new/disturbance.json",
                       [](const fs::path& path, Provenance& from) { Disturbance::read(path, from); });
  }
  if (line.has("track-hz")) {
    track.clear();
    for (const double f : line.get<std::vector<double>>("track-hz")) track.push_back(number_text(f));
  }
  data["track_hz"] = join(track, ", ");
  choose_hardware(line, answers, "both", data);
  out.command = "bodesmith run project.toml -o out";
  out.schemas = {"project", "disturbance"};
  out.files = {
      {"gains.csv", "gains of the hysteresis over frequency", own.gains},
      {"disturbance.json", "its polynomials, and the same gains for the simulation", own.disturbance},
      {"project.toml", "what it is built from, and what the stage must follow",
       render_template("new/nanopositioner.toml", data)}};
  out.next = {"`out/controller/controller.sub`: the whole controller for any SPICE",
              "`out/tracking.csv`: what is left at each frequency"};
  return out;
}

NewProject diagnosis_project(const CommandLine& line, const Answers&, Json& data) {
  if (line.has("data") != line.has("holdout"))
    line.fail("--data and --holdout must be given together: one record to fit, another one to judge");
  const auto read = [](const fs::path& path, Provenance& from) { TimeRecord::read_csv(path, from); };
  NewProject out;
  out.about = "A model and measured records that disagree: what the model is missing.";
  out.command = "bodesmith diagnose model.toml --data train.csv --holdout test.csv -o out";
  out.schemas = {"model"};
  out.files = {
      {"model.toml", "what is known of the stage", render_template("new/model.toml", data)},
      {"train.csv", "a record (time_s,u,y) that is fitted; any format that is read will do",
       line.has("data") ? own_or_example(line, "data", "", read) : example_record({3.1, 23.0, 97.0}, 1)},
      {"test.csv", "another one, held out: the figures are its",
       line.has("holdout") ? own_or_example(line, "holdout", "", read)
                           : example_record({4.7, 31.0, 140.0}, 2)}};
  if (!line.has("data"))
    out.next.push_back(
        "the records come from a stage with a lag of 180 Hz, which the model lacks: replace them by yours");
  out.next.push_back("`out/model.toml`: the model with what was found");
  return out;
}

}  // namespace

const std::vector<NewKind>& new_kinds() {
  static const std::vector<NewKind> all = {
      {"filter", "a magnitude curve or audio curve to hardware", filter_project},
      {"fractional-pid", "a fractional PID to a circuit", pid_project},
      {"nanopositioner", "a piezo stage's hysteresis to its controller", stage_project},
      {"diagnosis", "records and a model that lacks something", diagnosis_project}};
  return all;
}

namespace {

std::string answer_to(const std::string& question, const std::string& standard) {
  hide_progress();
  fmt::print("{} [{}]: ", question, standard);
  std::fflush(stdout);
  std::string out;
  if (!std::getline(std::cin, out)) throw InputError("no answer, expected one line");
  return std::string(trim(out));
}

/// Three sines that share no period; their frequencies in Hz.
TimeRecord example_input(const std::array<double, 3>& frequencies) {
  TimeRecord out;
  out.step_s = 2e-4;
  for (int i = 0; i < 4000; ++i) {
    double u = 0.5;
    double amplitude = 0.18;
    for (const double f : frequencies) {
      u += amplitude * std::sin(2.0 * std::numbers::pi * f * i * out.step_s);
      amplitude *= 0.8;
    }
    out.u.push_back(u);
  }
  return out;
}

}  // namespace

Answers::Answers(const CommandLine& line)
    : line_(line), asks_(!line.has("kind") && on_terminal(STDIN_FILENO) && on_terminal(STDOUT_FILENO)) {}

std::string Answers::text(const std::string& option, const std::string& question) const {
  const std::string standard = line_.maybe<std::string>(option).value_or("");
  if (!asks_ || line_.has(option)) return standard;
  const std::string given = answer_to(question, standard);
  return given.empty() ? standard : given;
}

double Answers::number(const std::string& option, const std::string& question) const {
  const double standard = line_.positive(option);
  if (!asks_ || line_.has(option)) return standard;
  const std::string given = answer_to(question, rounded_text(standard));
  double value = standard;
  if (!given.empty() && (!parse_quantity(given, value) || !(value > 0.0)))
    line_.fail(fmt::format("'{}' is no number above 0", given));
  return value;
}

/// What a stage answers that has a lag which model.toml does not know, measured with some noise.
std::string example_record(const std::array<double, 3>& frequencies, std::uint64_t seed) {
  const TimeRecord input = example_input(frequencies);
  chain::Chain stage;
  stage.blocks = {chain::make_block("gain").set("gain", 0.95).set("offset", 0.02),
                  chain::make_block("lowpass").set("corner_hz", 180.0)};
  std::vector<double> y = simulate::simulate(stage, input).y;
  Random noise(seed);
  for (double& value : y) value += 2e-4 * noise.normal();
  CsvWriter csv;
  csv.add(column::time_s, input.times_s());
  csv.add(column::input, input.u);
  csv.add(column::output, y);
  return csv.text();
}

}  // namespace bodesmith::cli
