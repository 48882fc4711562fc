#include "report/page_parts.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "base/provenance.hpp"
#include "base/text_template.hpp"

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

}  // namespace bodesmith::report
