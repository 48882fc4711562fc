#include <fmt/format.h>

#include <filesystem>

#include "base/documents/json.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/modes/modes.hpp"
#include "gap/course.hpp"

namespace bodesmith::cli {
namespace {

std::string list_text(const std::vector<gap::CourseCase>& cases, const std::string& folder) {
  std::string text = fmt::format(
      "{} records, each of a system that has something its model lacks, or has not:\n", cases.size());
  for (const gap::CourseCase& one : cases) text += fmt::format("  {}  {}\n", one.name, one.story);
  text += fmt::format(
      "Look yourself: bodesmith diagnose {} --data {} --holdout {} -o DIR/{}\n"
      "Then (or at once): bodesmith diagnose --course {} -o DIR   diagnoses what DIR lacks, and opens the seals\n",
      cases[0].model.string(), cases[0].data.string(), cases[0].holdout.string(), cases[0].name, folder);
  return text;
}

gap::SearchOptions course_options(const CommandLine& line, const Stopwatch& watch, double& until) {
  gap::SearchOptions options;
  options.threads = line.integer("threads", 1, 256);
  options.stop = [] { return interrupted(); };
  options.late = [&watch, &until] { return watch.seconds() > until; };
  return options;
}

std::string grade_text(const gap::CourseCase& one, const gap::CourseAnswer& answer) {
  return fmt::format("  {}  hidden: {}; named: {}: {}\n", one.name, answer.hidden,
                     answer.named.empty() ? "nothing" : join(answer.named, ", "), to_string(answer.grade));
}

}  // namespace

int run_diagnose_course(const std::vector<std::string>& arguments) {
  CommandLine line(
      "diagnose --course", "bodesmith diagnose --course examples/course -o out/course",
      "Small records with a hidden effect each. Without -o: what they are. With -o DIR: each is diagnosed "
      "into\nDIR/CASE (a diagnosis.json that is there is taken), then compared with the sealed answer.");
  line.positional("", 0, 0);
  line.output("folder of the diagnoses, one folder a case", true);
  line.option<std::string>("course", "folder with course.json and the records");
  line.option<std::string>("case", "only this one");
  line.option<double>("max-seconds", "time for each case", 60.0);
  line.option<int>("threads", "threads of the search", 2);
  line.seed();
  if (!line.parse(arguments)) return kDone;
  const auto folder = line.get<std::string>("course");
  Provenance from;
  std::vector<gap::CourseCase> cases = gap::read_course(folder, from);
  if (line.has("case")) {
    std::erase_if(cases, [&](const gap::CourseCase& c) { return c.name != line.get<std::string>("case"); });
    if (cases.empty()) line.fail("--case " + line.get<std::string>("case") + " is not in the course");
  }
  Json json = json_header("course_result", from);
  json["cases"] = Json::array();
  if (!line.has("output")) {
    for (const gap::CourseCase& one : cases)
      json["cases"].push_back({{"case", one.name}, {"story", one.story}});
    print_summary(line, list_text(cases, folder), json);
    return kDone;
  }
  const Stopwatch watch;
  double until = 0.0;
  const gap::SearchOptions options = course_options(line, watch, until);
  std::string text;
  std::size_t right = 0;
  for (const gap::CourseCase& one : cases) {
    const std::filesystem::path into = line.output_path() / one.name;
    until = watch.seconds() + line.positive("max-seconds");
    if (!std::filesystem::exists(into / "diagnosis.json"))
      diagnose_into(into, one.model, one.data, one.holdout, options);
    if (interrupted()) return kInterrupted;
    const gap::CourseAnswer answer = gap::course_answer(one, into / "diagnosis.json", from);
    right += answer.grade == gap::CourseAnswer::Grade::right ? 1 : 0;
    text += grade_text(one, answer);
    json["cases"].push_back({{"case", one.name},
                             {"hidden", answer.hidden},
                             {"named", answer.named},
                             {"grade", to_string(answer.grade)}});
  }
  text += fmt::format("{} of {} right\n", right, cases.size());
  json["right"] = right;
  json["timing_s"] = {{"compute", watch.seconds()}};
  return print_summary(line, text, json);
}

}  // namespace bodesmith::cli
