#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/nearest_word.hpp"
#include "base/progress.hpp"
#include "base/quantity.hpp"
#include "base/terminal.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "chain/registry.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/schemas.hpp"
#include "numeric/random.hpp"
#include "signal/bode_points.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"
#include "signal/disturbance.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::cli {
namespace {
namespace fs = std::filesystem;

/// A project to begin with: its files, and what a person is told of it.
struct NewProject {
  std::string about;
  std::string command;
  std::vector<std::string> schemas;
  struct File {
    std::string name;
    std::string what;
    std::string text;
  };
  std::vector<File> files;
  std::vector<std::string> next;
};

/// Flags, or a few questions where there are none and a person sits at a terminal.
class Answers {
 public:
  explicit Answers(const CommandLine& line)
      : line_(line), asks_(!line.has("kind") && on_terminal(STDIN_FILENO) && on_terminal(STDOUT_FILENO)) {}

  bool asks() const { return asks_; }

  std::string text(const std::string& option, const std::string& question) const {
    const std::string standard = line_.maybe<std::string>(option).value_or("");
    if (!asks_ || line_.has(option)) return standard;
    const std::string given = ask(question, standard);
    return given.empty() ? standard : given;
  }

  double number(const std::string& option, const std::string& question) const {
    const double standard = line_.positive(option);
    if (!asks_ || line_.has(option)) return standard;
    const std::string given = ask(question, rounded_text(standard));
    double value = standard;
    if (!given.empty() && (!parse_quantity(given, value) || !(value > 0.0)))
      line_.fail(fmt::format("'{}' is no number above 0", given));
    return value;
  }

 private:
  static std::string ask(const std::string& question, const std::string& standard) {
    hide_progress();
    fmt::print("{} [{}]: ", question, standard);
    std::fflush(stdout);
    std::string out;
    if (!std::getline(std::cin, out)) throw InputError("no answer, expected one line");
    return std::string(trim(out));
  }

  const CommandLine& line_;
  bool asks_;
};

struct NewKind {
  std::string name;
  std::string what;
  NewProject (*make)(const CommandLine& line, const Answers& answers, Json& data);
};

/// The text of a file that a person has, checked by the reader that will read it, or the example's.
template <class Read>
std::string own_or_example(const CommandLine& line, const std::string& option, const std::string& example,
                           Read read) {
  if (!line.has(option)) return example;
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
  constexpr const char* kCurve =
      "# A loudspeaker's correction, as read off a measurement: a lift in the bass, a dip at 3 kHz.\n"
      "frequency_hz,gain_db\n20,5.5\n30,5.2\n50,4.2\n80,2.8\n120,1.6\n200,0.7\n400,0.1\n800,-0.3\n1500,-1.4\n"
      "2500,-2.9\n3500,-3.1\n5000,-2.0\n8000,-0.8\n12000,-0.3\n20000,0\n";
  NewProject out;
  out.about = "A magnitude read off a curve, to op-amps or a board.";
  data["max_error_db"] = number_text(answers.number("max-error-db", "Largest error at a point, in dB"));
  choose_hardware(line, answers, "circuit", data);
  out.command = "bodesmith run project.toml -o out";
  out.schemas = {"project"};
  out.files = {
      {"points.csv", "the curve: put your own points here",
       own_or_example(line, "points", kCurve,
                      [](const fs::path& path, Provenance& from) { BodePoints::read_csv(path, from); })},
      {"project.toml", "what is wanted, and what it is built from",
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

NewProject stage_project(const CommandLine& line, const Answers& answers, Json& data) {
  // The stage of examples/nanopositioner.
  constexpr const char* kGains =
      "# How much larger the hysteresis of the descending branch is at each frequency than at the first one.\n"
      "frequency_hz,gain\n1,1\n10,1.06\n20,1.1\n60,1.04\n100,1.17\n";
  const Json disturbance = {{"$schema", ".schemas/disturbance.schema.json"},
                            {"schema", "bodesmith.disturbance/1"},
                            {"ascending", {0.3546, -0.6433, 0.2887}},
                            {"descending", {-0.2398, 0.0838, 0.156}},
                            {"rate",
                             {{"frequency_hz", {1, 10, 20, 60, 100}},
                              {"ascending", {1, 1, 1, 1, 1}},
                              {"descending", {1.0, 1.06, 1.1, 1.04, 1.17}}}}};
  NewProject out;
  out.about = "An analog controller against the hysteresis of a piezo stage.";
  data["stroke_m"] = number_text(answers.number("stroke-m", "Full stroke of the stage, in m"));
  const std::string gains =
      own_or_example(line, "points", kGains, [&](const fs::path& path, Provenance& from) {
        data["base_hz"] = number_text(BodePoints::read_csv(path, from).points.front().frequency.value);
      });
  if (!data.contains("base_hz")) data["base_hz"] = "1.0";
  std::vector<std::string> track = {"1", "10", "100"};
  if (line.has("track-hz")) {
    track.clear();
    for (const double f : line.get<std::vector<double>>("track-hz")) track.push_back(number_text(f));
  }
  data["track_hz"] = join(track, ", ");
  choose_hardware(line, answers, "both", data);
  out.command = "bodesmith run project.toml -o out";
  out.schemas = {"project", "disturbance"};
  out.files = {
      {"gains.csv", "gains of the hysteresis over frequency", gains},
      {"disturbance.json", "its polynomials, and the same gains for the simulation",
       own_or_example(line, "disturbance", to_text(disturbance),
                      [](const fs::path& path, Provenance& from) { Disturbance::read(path, from); })},
      {"project.toml", "what it is built from, and what the stage must follow",
       render_template("new/nanopositioner.toml", data)}};
  out.next = {"`out/controller/controller.sub`: the whole controller for any SPICE",
              "`out/tracking.csv`: what is left at each frequency"};
  return out;
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

/// What a stage answers that has a lag which model.toml does not know, measured with some noise.
std::string example_record(const std::array<double, 3>& frequencies, std::uint64_t seed) {
  const TimeRecord input = example_input(frequencies);
  chain::Chain stage;
  stage.blocks = {chain::make_block("gain").set("gain", 0.95).set("offset", 0.02),
                  chain::make_block("lowpass").set("corner_hz", 180.0)};
  std::vector<double> y = simulate::simulate(stage, input).y;
  std::vector<double> time(y.size());
  Random noise(seed);
  for (std::size_t i = 0; i < y.size(); ++i) {
    time[i] = input.time_s(i);
    y[i] += 2e-4 * noise.normal();
  }
  CsvWriter csv;
  csv.add(column::time_s, time);
  csv.add(column::input, input.u);
  csv.add(column::output, y);
  return csv.text();
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

const std::vector<NewKind>& new_kinds() {
  static const std::vector<NewKind> all = {
      {"filter", "a magnitude curve or audio curve to hardware", filter_project},
      {"fractional-pid", "a fractional PID to a circuit", pid_project},
      {"nanopositioner", "a piezo stage's hysteresis to its controller", stage_project},
      {"diagnosis", "records and a model that lacks something", diagnosis_project}};
  return all;
}

void declare_new(CommandLine& line) {
  std::vector<std::string> kinds;
  for (const NewKind& kind : new_kinds()) kinds.push_back(kind.name);
  line.positional("DIR", 1, 1);
  line.option<std::string>("kind", join(kinds, ", ") + " (asked for at a terminal when left out)");
  line.words("kind", kinds);
  line.option<std::string>("name", "of the project (default: the folder's)");
  line.option<std::string>("points", "own points instead of an example's (filter, nanopositioner)");
  line.option<std::string>("hardware", "circuit, fpaa or both", "circuit");
  line.words("hardware", {"circuit", "fpaa", "both"});
  line.group("filter");
  line.option<double>("max-error-db", "largest error at a point", 0.3);
  line.group("fractional-pid");
  line.option<double>("kp", "proportional gain", 1.2);
  line.option<double>("ki", "of ki s^-lambda", 30.0);
  line.option<double>("lambda", "power of the integral part", 0.9);
  line.option<double>("kd", "of kd s^mu", 0.004);
  line.option<double>("mu", "power of the derivative part", 0.7);
  line.option<double>("from-hz", "lower end of its band", 0.1);
  line.option<double>("to-hz", "upper end of its band", 1000.0);
  line.group("nanopositioner");
  line.option<std::string>("disturbance", "own disturbance.json instead of an example's");
  line.option<double>("stroke-m", "full stroke of the stage", 6.92e-6);
  line.list<double>("track-hz", "frequencies to follow (default: 1 10 100)");
  line.group("diagnosis");
  line.option<std::string>("data", "own record (time_s,u,y) instead of an example's");
  line.option<std::string>("holdout", "another one");
}

std::string kind_wanted(const CommandLine& line, const Answers& answers) {
  if (line.has("kind")) return line.get<std::string>("kind");
  std::vector<std::string> names;
  for (const NewKind& kind : new_kinds()) names.push_back(kind.name);
  if (!answers.asks()) line.fail("--kind is missing, expected " + join(names, ", "));
  hide_progress();
  for (const NewKind& kind : new_kinds()) fmt::print("  {:<15}{}\n", kind.name, kind.what);
  return answers.text("kind", "Which of these");
}

/// A folder that is new or holds nothing.
void expect_empty(const CommandLine& line, const fs::path& folder) {
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) return;
  if (!fs::is_directory(folder, ignored)) line.fail(fmt::format("{} is no folder", folder.string()));
  if (!fs::is_empty(folder, ignored))
    line.fail(fmt::format("{} holds files, expected a new or an empty folder: nothing is overwritten",
                          folder.string()));
}

}  // namespace

int run_new(const std::vector<std::string>& arguments) {
  CommandLine line(
      "new", "bodesmith new mine --kind filter --points curve.csv",
      "A commented project to begin with, which runs as it is: made from options or, at a terminal, from a few\n"
      "questions. Nothing is overwritten.");
  declare_new(line);
  if (!line.parse(arguments)) return kDone;
  const fs::path folder = line.files()[0];
  expect_empty(line, folder);
  const Answers answers(line);
  const std::string wanted = kind_wanted(line, answers);
  std::vector<std::string> names;
  const NewKind* kind = nullptr;
  for (const NewKind& one : new_kinds()) {
    names.push_back(one.name);
    if (one.name == wanted) kind = &one;
  }
  if (kind == nullptr)
    line.fail(
        fmt::format("--kind is '{}'{}, expected {}", wanted, did_you_mean(wanted, names), join(names, ", ")));

  Json data;
  const std::string standard = fs::absolute(folder).lexically_normal().filename().string();
  data["name"] = line.has("name") ? line.get<std::string>("name") : standard;
  for (const char c : data["name"].get<std::string>())
    if (c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20)
      line.fail("--name has a quotation mark or a control character");
  data["about"] = kind->what;
  const NewProject project = kind->make(line, answers, data);

  OutputSet out(folder);
  data["about"] = project.about;
  data["command"] = project.command;
  data["files"] = Json::array();
  data["next"] = Json::array();
  for (const NewProject::File& file : project.files) {
    out.add(file.name, file.text);
    data["files"].push_back({{"file", file.name}, {"what", file.what}});
  }
  for (const std::string& one : project.next) data["next"].push_back({{"line", one}});
  out.add("README.md", render_template("new/README.md", data));
  for (const SchemaFile& schema : schema_files()) {
    if (std::find(project.schemas.begin(), project.schemas.end(), schema.name) != project.schemas.end())
      out.add(fs::path(".schemas") / schema.file, schema.text);
  }
  out.commit();
  Json summary = json_header("new_summary", {});
  summary["kind"] = kind->name;
  summary["command"] = project.command;
  summary["files"] = Json::array();
  for (const fs::path& path : out.paths()) summary["files"].push_back(path.string());
  print_summary(line,
                fmt::format("{}: {}\nnext:\n  cd {}\n  {}\n", folder.string(), project.about, folder.string(),
                            project.command),
                summary);
  return kDone;
}

}  // namespace bodesmith::cli
