#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {
namespace {

const std::vector<std::string>& shells() {
  static const std::vector<std::string> all = {"bash", "zsh", "fish"};
  return all;
}

/// Between single quotes of a shell; what zsh and fish give a meaning of their own there is written otherwise.
std::string in_quotes(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'') {
      out += "’";
    } else if (c == '[') {
      out += '(';
    } else if (c == ']') {
      out += ')';
    } else if (c == ':') {
      out += ';';
    } else if (c != '\\' && c != '`' && c != '$') {
      out += c == '\n' ? ' ' : c;
    }
  }
  return out;
}

/// Descriptions next to an option are one line of a terminal.
std::string short_text(const std::string& what) {
  constexpr std::size_t kLongest = 70;
  const std::string text = in_quotes(what);
  if (text.size() <= kLongest) return text;
  return text.substr(0, text.rfind(' ', kLongest)) + " …";
}

/// The endings of the files a command takes ("MODEL.toml|SECTIONS.json"); empty: any.
std::set<std::string> endings_of(const std::string& positional) {
  // Several of different kinds one after the other.
  if (positional.find(' ') != std::string::npos) return {};
  std::set<std::string> endings;
  for (const std::string_view one : split(positional, '|')) {
    const std::string_view name = trim(one);
    const auto dot = name.find('.');
    if (dot == std::string_view::npos) return {};
    std::string ending;
    for (const char c : name.substr(dot + 1)) {
      if (c < 'a' || c > 'z') break;
      ending += c;
    }
    if (ending != "json" && ending != "toml") return {};
    endings.insert(ending);
  }
  return endings;
}

/// Words that stand in the place of a file ("lowpass|highpass|…" of design).
std::vector<std::string> positional_words(const CommandTable& table) {
  std::vector<std::string> out;
  if (table.name == "completion") return shells();
  const auto pieces = split(table.positional, '|');
  if (pieces.size() < 2) return out;
  for (const std::string_view one : pieces) {
    const std::string word(trim(one));
    if (word.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") != std::string::npos) return {};
    out.push_back(word);
  }
  return out;
}

Json option_json(const OptionEntry& option, const std::string& command) {
  Json out = {{"name", option.name},
              {"command", command},
              {"what", short_text(option.what)},
              {"words", join(option.words, " ")}};
  out["letter"] = option.letter.empty() ? Json(false) : Json(option.letter);
  out["value"] = option.takes_value;
  out["flag"] = !option.takes_value;
  out["chooses"] = !option.words.empty();
  out["any_value"] = option.takes_value && option.words.empty();
  out["several"] = option.several;
  return out;
}

Json command_json(const CommandTable& table) {
  Json out = {{"name", table.name}, {"what", short_text(table.first_sentence())}};
  out["id"] = table.name;
  for (char& c : out["id"].get_ref<std::string&>()) c = c == ' ' ? '_' : c;
  std::vector<std::string> files;
  for (const std::string& ending : endings_of(table.positional)) files.push_back("*." + ending);
  out["files"] = files.empty() ? Json(false) : Json(join(files, " "));
  out["words"] = join(positional_words(table), " ");
  out["has_words"] = !positional_words(table).empty();
  out["options"] = Json::array();
  std::vector<std::string> dashed;
  for (const OptionEntry& option : table.options) {
    out["options"].push_back(option_json(option, table.name));
    dashed.push_back("--" + option.name);
    if (!option.letter.empty()) dashed.push_back("-" + option.letter);
  }
  out["dashed"] = join(dashed, " ");
  return out;
}

Json completion_data() {
  Json out;
  out["commands"] = Json::array();
  for (const CommandTable& table : command_tables()) out["commands"].push_back(command_json(table));
  out["top"] = Json::array();
  std::vector<std::string> names;
  for (const Command& command : commands()) {
    names.push_back(command.name);
    Json one = {{"name", command.name}, {"what", in_quotes(command.what)}, {"verbs", Json::array()}};
    std::vector<std::string> verbs;
    for (const Command& verb : verbs_of(command.name)) {
      verbs.push_back(verb.name);
      one["verbs"].push_back(
          {{"name", verb.name}, {"what", in_quotes(verb.what)}, {"command", command.name}});
    }
    one["has_verbs"] = !verbs.empty();
    one["verb_names"] = join(verbs, " ");
    out["top"].push_back(std::move(one));
  }
  out["top_names"] = join(names, " ");
  return out;
}

}  // namespace

int run_completion(const std::vector<std::string>& arguments) {
  CommandLine line(
      "completion", "source <(bodesmith completion bash)",
      "Completion of subcommands, options and their words for a shell, made from the tables that parse the\n"
      "command line. To keep it:\n"
      "  bodesmith completion bash -o ~/.local/share/bash-completion/completions/bodesmith\n"
      "  bodesmith completion zsh  -o ~/.zfunc/_bodesmith      (a folder of $fpath)\n"
      "  bodesmith completion fish -o ~/.config/fish/completions/bodesmith.fish");
  line.positional("bash|zsh|fish", 1, 1);
  line.output("file to write (default: stdout)", true);
  if (!line.parse(arguments)) return kDone;
  const std::string shell = line.files()[0];
  if (std::ranges::find(shells(), shell) == shells().end())
    line.fail(fmt::format("'{}' is no known shell{}, expected {}", shell, did_you_mean(shell, shells()),
                          join(shells(), ", ")));
  const std::string text = render_template("completion/bodesmith." + shell, completion_data());
  if (!line.has("output")) {
    fmt::print("{}", text);
    return kDone;
  }
  write_file(line.output_path(), text);
  const std::string path = line.output_path().string();
  Json summary = json_header("completion_summary", {});
  summary["shell"] = shell;
  summary["file"] = path;
  return print_summary(line, fmt::format("completion for {} written to {}\n", shell, path), summary);
}

}  // namespace bodesmith::cli
