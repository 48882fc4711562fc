#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "base/version.hpp"
#include "cli/build_facts.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {
namespace {

/// Text in which roff sees no requests and no escapes, and minus signs that can be copied.
std::string roff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  if (!out.empty() && (out[0] == '.' || out[0] == '\'')) out.insert(0, "\\&");
  return out;
}

/// The descriptions of --help: lines that stand in by two blanks are commands, to be shown as they are.
Json paragraphs_of(const std::string& what) {
  Json out = Json::array();
  bool literal = false;
  for (const std::string_view line : split(what, '\n')) {
    const bool indented = line.starts_with("  ");
    if (trim(line).empty()) {
      out.push_back({{"line", ".PP"}});
      continue;
    }
    if (indented != literal) out.push_back({{"line", indented ? ".PP\n.nf" : ".fi\n.PP"}});
    literal = indented;
    out.push_back({{"line", roff(indented ? line : trim(line))}});
  }
  if (literal) out.push_back({{"line", ".fi"}});
  return out;
}

/// An empty line is a request too many for roff; the template engine leaves some between nested sections.
std::string without_empty_lines(const std::string& text) {
  std::string out;
  for (const std::string_view line : split(text, '\n')) {
    if (!trim(line).empty()) out += std::string(line) + "\n";
  }
  return out;
}

std::string page_name(const std::string& command) {
  std::string out = "bodesmith-" + command;
  for (char& c : out) c = c == ' ' ? '-' : c;
  return out;
}

Json groups_of(const CommandTable& table) {
  Json out = Json::array();
  for (const OptionEntry& option : table.options) {
    if (out.empty() || out.back()["caption"] != roff(option.group))
      out.push_back({{"caption", roff(option.group)}, {"options", Json::array()}});
    std::string text = option.what;
    if (!option.default_text.empty()) text += " (default: " + option.default_text + ")";
    if (!option.words.empty()) text += "; one of: " + join(option.words, ", ");
    Json one = {{"name", roff("--" + option.name)}, {"what", roff(text)}};
    one["letter"] = option.letter.empty() ? Json(false) : Json(roff("-" + option.letter));
    one["value"] = option.takes_value ? Json(option.several ? "value …" : "value") : Json(false);
    out.back()["options"].push_back(std::move(one));
  }
  return out;
}

Json page_of(const CommandTable& table, const std::vector<CommandTable>& all) {
  Json out = {{"page", roff(page_name(table.name))},
              {"command", roff("bodesmith " + table.name)},
              {"version", kVersion},
              {"date", build::kDate},
              {"what", roff(table.first_sentence())},
              {"example", roff(table.example)},
              {"description", paragraphs_of(table.what)},
              {"groups", groups_of(table)},
              {"measured", table.reads_measurements},
              {"see", Json::array()}};
  out["title"] = page_name(table.name);
  for (char& c : out["title"].get_ref<std::string&>())
    c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
  out["positional"] = table.positional.empty() ? Json(false) : Json(roff(table.positional));
  for (const CommandTable& other : all) {
    if (other.name.starts_with(table.name + " ") || table.name.starts_with(other.name + " "))
      out["see"].push_back({{"page", roff(page_name(other.name))}});
  }
  return out;
}

Json overview_of(const std::vector<CommandTable>& all) {
  Json out = {
      {"version", kVersion}, {"date", build::kDate}, {"commands", Json::array()}, {"see", Json::array()}};
  for (const Command& command : commands())
    out["commands"].push_back({{"name", roff(command.name)}, {"what", roff(command.what)}});
  for (std::size_t i = 0; i < all.size(); ++i)
    out["see"].push_back({{"page", roff(page_name(all[i].name))}, {"more", i + 1 < all.size()}});
  return out;
}

}  // namespace

int run_manual(const std::vector<std::string>& arguments) {
  CommandLine line("manual", "bodesmith manual -o man/man1",
                   "Manual pages (man(7)) of the program and of every subcommand.");
  line.output("folder for bodesmith.1, bodesmith-fit.1, …");
  if (!line.parse(arguments)) return kDone;
  const std::vector<CommandTable> all = command_tables();
  OutputSet out(line.output_path());
  out.add("bodesmith.1", without_empty_lines(render_template("manual/bodesmith.1", overview_of(all))));
  for (const CommandTable& table : all)
    out.add(page_name(table.name) + ".1",
            without_empty_lines(render_template("manual/command.1", page_of(table, all))));
  out.commit();
  Json summary = json_header("manual_summary", {});
  summary["pages"] = all.size() + 1;
  return print_summary(
      line, fmt::format("{} manual pages in {}\n", all.size() + 1, line.output_path().string()), summary);
}

}  // namespace bodesmith::cli
