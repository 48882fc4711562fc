#include "report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "base/documents/json.hpp"
#include "base/provenance.hpp"
#include "base/text_template.hpp"
#include "base/version.hpp"
#include "report/svg.hpp"

namespace bodesmith::report {
namespace {

/// In the order in which they stand in the page: each may use what is above it when it starts.
constexpr std::array<std::string_view, 16> kScripts = {
    "elements", "units",  "colours", "traces",     "csv",   "view",   "ticks",   "plot",
    "links",    "legend", "keys",    "data_table", "theme", "figure", "choices", "start"};

std::string_view template_text(std::string_view name) {
  for (const EmbeddedTemplate& entry : embedded_templates()) {
    if (entry.name == name) return entry.text;
  }
  throw std::logic_error("no template named " + std::string(name));
}

unsigned hex_digit(char c) {
  return static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10);
}

/// "sha256-…" in base 64 (RFC 4648): three bytes to four characters.
std::string hash_source(std::string_view text) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::string hex = sha256_hex(text);
  std::string out = "'sha256-";
  const std::size_t bytes = hex.size() / 2;
  const auto byte = [&](std::size_t i) -> std::uint32_t {
    return i < bytes ? 16u * hex_digit(hex[2 * i]) + hex_digit(hex[2 * i + 1]) : 0u;
  };
  for (std::size_t i = 0; i < bytes; i += 3) {
    const std::uint32_t three = (byte(i) << 16u) | (byte(i + 1) << 8u) | byte(i + 2);
    for (unsigned k = 0; k < 4; ++k) out += i + k <= bytes ? kDigits[(three >> (18u - 6u * k)) & 63u] : '=';
  }
  return out + "'";
}

std::string sources(const std::vector<std::string>& texts) {
  if (texts.empty()) return " 'none'";
  std::string out;
  for (const std::string& text : texts) out += " " + hash_source(text);
  return out;
}

}  // namespace

std::string page_script() {
  std::string out =
      fmt::format("/*! uPlot\n{}*/\n\"use strict\";\n(() => {{\n{}\n", template_text("vendor/uPlot/LICENSE"),
                  template_text("vendor/uPlot/uPlot.iife.min.js"));
  for (const std::string_view name : kScripts) out += template_text(fmt::format("report/live/{}.js", name));
  return out + "})();\n";
}

std::string page_style() {
  return fmt::format("{}\n{}{}", template_text("vendor/uPlot/uPlot.min.css"),
                     template_text("report/page.css"), template_text("report/live.css"));
}

std::string content_policy(const std::vector<std::string>& scripts, const std::vector<std::string>& styles) {
  return fmt::format("default-src 'none'; script-src{}; style-src{}; base-uri 'none'; form-action 'none'",
                     sources(scripts), sources(styles));
}

std::vector<std::string> styles_in(const std::string& svg) {
  static constexpr std::string_view kOpen = "<style>";
  std::vector<std::string> out;
  for (std::size_t at = svg.find(kOpen); at != std::string::npos; at = svg.find(kOpen, at)) {
    at += kOpen.size();
    out.push_back(svg.substr(at, svg.find("</style>", at) - at));
  }
  return out;
}

std::string& Page::body() {
  if (chapters_.empty()) chapters_.push_back({"", ""});
  return chapters_.back().body;
}

void Page::chapter(const std::string& heading) {
  chapters_.push_back({heading, ""});
}

void Page::paragraph(const std::string& text) {
  body() += fmt::format("<p>{}</p>\n", escape_xml(text));
}

void Page::warning(const std::string& text) {
  body() += fmt::format("<p class=\"warning\">{}</p>\n", escape_xml(text));
}

void Page::key_figures(const std::vector<std::pair<std::string, std::string>>& value_and_meaning) {
  body() += "<div class=\"key\">\n";
  for (const auto& [value, meaning] : value_and_meaning) {
    body() += fmt::format("<div><b>{}</b><span>{}</span></div>\n", escape_xml(value), escape_xml(meaning));
  }
  body() += "</div>\n";
}

namespace {

/// Of columns that hold sentences, which are read from the left.
std::vector<const char*> classes_of(const Table& table) {
  constexpr auto kBlanks = 3;
  std::vector<const char*> out(table.head.size(), "");
  for (const auto& row : table.rows) {
    for (std::size_t c = 0; c < std::min(row.size(), out.size()); ++c)
      if (std::ranges::count(row[c], ' ') >= kBlanks) out[c] = " class=\"words\"";
  }
  return out;
}

}  // namespace

void Page::table(const Table& table, const std::string& caption) {
  std::string& out = body();
  const std::vector<const char*> classes = classes_of(table);
  const auto class_of = [&](std::size_t c) { return c < classes.size() ? classes[c] : ""; };
  out += "<div class=\"wide\"><table>\n";
  if (!caption.empty()) out += fmt::format("<caption>{}</caption>\n", escape_xml(caption));
  out += "<thead><tr>";
  for (std::size_t c = 0; c < table.head.size(); ++c)
    out += fmt::format("<th scope=\"col\"{}>{}</th>", class_of(c), escape_xml(table.head[c]));
  out += "</tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const bool marked = std::ranges::find(table.marked, i) != table.marked.end();
    out += marked ? "<tr class=\"marked\">" : "<tr>";
    for (std::size_t c = 0; c < table.rows[i].size(); ++c)
      out += fmt::format("<td{}>{}</td>", class_of(c), escape_xml(table.rows[i][c]));
    out += "</tr>\n";
  }
  out += "</tbody></table></div>\n";
}

std::string Page::drawing(const std::string& svg) {
  const std::string out = inlined_svg(svg, fmt::format("figure-{}", ++figures_));
  for (const std::string& style : styles_in(out)) styles_.push_back(style);
  return out;
}

void Page::figure(const std::string& svg, const std::string& caption) {
  body() += fmt::format("<figure><div class=\"still\">{}</div><figcaption>{}</figcaption></figure>\n",
                        drawing(svg), escape_xml(caption));
}

void Page::plots(const std::vector<Plot>& plots, const std::string& caption) {
  body() += fmt::format(
      "<figure class=\"plots\"><div class=\"live\"></div><div class=\"still\">{}</div><script "
      "type=\"application/json\">{}</script><figcaption>{}</figcaption></figure>\n",
      drawing(stack_svg(plots)), json_for_script(live_plots(plots)), escape_xml(caption));
}

void Page::choices(const Table& rows, const std::string& caption, const std::vector<Choice>& choices,
                   std::size_t chosen) {
  body() += "<div class=\"choices\">\n";
  table(rows, caption);
  body() += fmt::format("<script type=\"application/json\">{}</script><div class=\"chosen\"></div></div>\n",
                        json_for_script(choices_json(choices, chosen)));
}

void Page::listing(const std::string& text) {
  body() += fmt::format("<pre>{}</pre>\n", escape_xml(text));
}

std::string Page::html() const {
  const std::string script = page_script();
  std::vector<std::string> styles = styles_;
  styles.push_back(page_style());
  Json data = {{"title", title_},        {"subtitle", subtitle_},
               {"version", kVersion},    {"policy", content_policy({script}, styles)},
               {"style", styles.back()}, {"script", script}};
  data["chapters"] = Json::array();
  int number = 0;
  for (const Chapter& chapter : chapters_) {
    ++number;
    data["chapters"].push_back({{"id", fmt::format("chapter-{}", number)},
                                {"heading", chapter.heading},
                                {"has_heading", !chapter.heading.empty()},
                                {"body", chapter.body}});
  }
  return render_template("report/page.html", data);
}

}  // namespace bodesmith::report
