#include "cli/version_text.hpp"

#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "cli/build_facts.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {
namespace {

Json libraries_json() {
  Json out = Json::object();
  for (const std::string_view pair : split(build::kLibraries, ' ')) {
    const auto at = pair.find('=');
    const std::string version(pair.substr(at + 1));
    out[std::string(pair.substr(0, at))] = version.empty() ? Json() : Json(version);
  }
  return out;
}

Json options_json() {
  Json out = Json::object();
  for (const std::string_view pair : split(build::kOptions, ' ')) {
    const auto at = pair.find('=');
    const std::string_view value = pair.substr(at + 1);
    out[std::string(pair.substr(0, at))] = value == "ON" || value == "TRUE" || value == "1";
  }
  return out;
}

}  // namespace

int print_version(const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    fmt::print("bodesmith {}\n", kVersion);
    return kDone;
  }
  if (arguments.size() > 1 || arguments[0] != "--json")
    throw InputError(fmt::format("--version: '{}' is not known, expected --json or nothing", arguments[0]));
  Json out = json_header("version", {});
  out.erase("inputs");
  out["version"] = kVersion;
  out["commit"] = std::string_view(build::kCommit).empty() ? Json() : Json(build::kCommit);
  out["compiler"] = build::kCompiler;
  out["compiler_flags"] = build::kFlags;
  out["build_type"] = build::kBuildType;
  out["system"] = build::kSystem;
  out["options"] = options_json();
  out["libraries"] = libraries_json();
  fmt::print("{}", to_text(out));
  return kDone;
}

}  // namespace bodesmith::cli
