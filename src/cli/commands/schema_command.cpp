#include <fmt/format.h>

#include "approximate/method.hpp"
#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "chain/model_file.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/schemas.hpp"
#include "fpaa/cams/cam.hpp"
#include "gap/effect.hpp"

namespace bodesmith::cli {
namespace {

constexpr std::string_view kSchemaFolder = "schemas/";
constexpr std::string_view kSchemaEnding = ".schema.json";

}  // namespace

namespace {

/// The words of a schema that a registry has: at a place of it, written as a JSON pointer.
Json with_words(std::string_view text, const char* place, const std::vector<std::string>& words) {
  Json out = Json::parse(text);
  out.at(Json::json_pointer(place)) = words;
  return out;
}

/// Kinds that a program which uses this one as a library has registered are in its schemas too.
std::string with_registered_kinds(const std::string& name, std::string_view text) {
  if (name == "model") return to_text(chain::model_schema());
  if (name == "diagnosis") {
    std::vector<std::string> told;  // some are told under another's name
    for (const gap::Effect* effect : gap::effect_registry().all())
      if (effect->told() == effect->name()) told.emplace_back(effect->name());
    return to_text(with_words(text, "/$defs/effect/enum", told));
  }
  if (name == "fpaa_plan") {
    return to_text(with_words(text, "/properties/chips/items/properties/cams/items/properties/cam/enum",
                              fpaa::cam_registry().name_list()));
  }
  if (name == "project")
    return to_text(
        with_words(text, "/properties/approximate/properties/method/enum", method_registry().name_list()));
  return std::string(text);
}

}  // namespace

std::vector<SchemaFile> schema_files() {
  std::vector<SchemaFile> out;
  for (const EmbeddedTemplate& one : embedded_templates()) {
    if (!one.name.starts_with(kSchemaFolder) || !one.name.ends_with(kSchemaEnding)) continue;
    const std::string_view file = one.name.substr(kSchemaFolder.size());
    const std::string name(file.substr(0, file.size() - kSchemaEnding.size()));
    out.push_back({name, std::string(file), with_registered_kinds(name, one.text)});
  }
  return out;
}

int run_schema(const std::vector<std::string>& arguments) {
  CommandLine line(
      "schema", "bodesmith schema -o schemas",
      "JSON Schemas (draft 2020-12) of all TOML and JSON files, so that editors complete and check them and other\n"
      "programs can validate: all of them into a folder, or one to the terminal.\n"
      "  bodesmith schema project\n"
      "In a TOML file the line `#:schema schemas/project.schema.json` names one (taplo, VS Code's Even Better TOML),\n"
      "in a JSON file the key \"$schema\"; every reader here passes over them.");
  line.positional("NAME", 0, 1);
  line.output("folder for the schemas", true);
  if (!line.parse(arguments)) return kDone;
  std::vector<std::string> names;
  const std::vector<SchemaFile> files = schema_files();
  for (const SchemaFile& file : files) names.push_back(file.name);
  if (!line.files().empty()) {
    const std::string wanted = line.files().front();
    for (const SchemaFile& file : files) {
      if (file.name != wanted) continue;
      if (line.has("output")) {
        write_file(line.output_path() / file.file, file.text);
      } else {
        fmt::print("{}", file.text);
      }
      return kDone;
    }
    line.fail(fmt::format("there is no schema '{}'{}, expected one of {}", wanted,
                          did_you_mean(wanted, names), join(names, ", ")));
  }
  Json summary = json_header("schema_summary", {});
  summary["schemas"] = names;
  if (!line.has("output")) {
    print_summary(line, join(names, "\n") + "\n", summary);
    return kDone;
  }
  OutputSet out(line.output_path());
  for (const SchemaFile& file : files) out.add(file.file, file.text);
  out.commit();
  return print_summary(line, fmt::format("{} schemas in {}\n", files.size(), line.output_path().string()),
                       summary);
}

}  // namespace bodesmith::cli
