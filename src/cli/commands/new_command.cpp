#include <fmt/format.h>

#include <algorithm>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "cli/commands.hpp"
#include "cli/new_projects.hpp"
#include "cli/schemas.hpp"

namespace bodesmith::cli {
namespace {
namespace fs = std::filesystem;

std::vector<std::string> kind_names() {
  std::vector<std::string> out;
  for (const NewKind& kind : new_kinds()) out.push_back(kind.name);
  return out;
}

void declare_new(CommandLine& line) {
  line.positional("DIR", 1, 1);
  line.option<std::string>("kind", join(kind_names(), ", ") + " (asked for at a terminal when left out)");
  line.words("kind", kind_names());
  line.option<std::string>("name", "of the project (default: the folder's)");
  line.option<std::string>("points", "your points instead of the example's (filter, nanopositioner)");
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
  line.option<std::string>("disturbance", "your disturbance.json instead of the example's");
  line.list<std::string>(
      "records",
      "your records of the stage, full strokes at several frequencies, instead of points and disturbance");
  line.option<double>("stroke-m", "full stroke of the stage", 6.92e-6);
  line.list<double>("track-hz", "frequencies to follow (default: 1 10 100)");
  line.group("diagnosis");
  line.option<std::string>("data", "your record (time_s,u,y) instead of the example's");
  line.option<std::string>("holdout", "your record that is not fitted");
}

std::string kind_wanted(const CommandLine& line, const Answers& answers) {
  if (line.has("kind")) return line.get<std::string>("kind");
  if (!answers.asks()) line.fail("--kind is missing, expected " + join(kind_names(), ", "));
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
  const auto kind = std::ranges::find(new_kinds(), wanted, &NewKind::name);
  if (kind == new_kinds().end())
    line.fail(fmt::format("--kind is '{}'{}, expected {}", wanted, did_you_mean(wanted, kind_names()),
                          join(kind_names(), ", ")));

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
    if (std::ranges::find(project.schemas, schema.name) != project.schemas.end())
      out.add(fs::path(".schemas") / schema.file, schema.text);
  }
  line.refuse_unread();
  out.commit();
  Json summary = json_header("new_summary", {});
  summary["kind"] = kind->name;
  summary["command"] = project.command;
  summary["files"] = Json::array();
  for (const fs::path& path : out.paths()) summary["files"].push_back(path.string());
  return print_summary(line,
                       fmt::format("{}: {}\nnext:\n  cd {}\n  {}\n", folder.string(), project.about,
                                   folder.string(), project.command),
                       summary);
}

}  // namespace bodesmith::cli
