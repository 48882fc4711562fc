#include <fmt/format.h>

#include "base/error.hpp"
#include "base/text.hpp"
#include "fpaa/device/board.hpp"
#include "fpaa/gains/gain_schedule.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr const char* kPlaceForms = "expected CHIP.CAM, CHIP.CAM:OVER/UNDER or ADDRESS1:BANK.BYTE/BANK.BYTE";

[[noreturn]] void place_fails(const std::string& option, const std::string& text, const std::string& what) {
  throw InputError(fmt::format("{} '{}': {}", option, text, what));
}

std::optional<int> digits_as_number(std::string_view text, int max) {
  if (text.empty() || text.size() > 5) return std::nullopt;
  int out = 0;
  for (const char c : text) {
    if (!is_digit(c)) return std::nullopt;
    out = 10 * out + (c - '0');
  }
  if (out > max) return std::nullopt;
  return out;
}

std::optional<MemoryPlace> memory_place(std::string_view text) {
  const std::size_t dot = text.find('.');
  if (dot == std::string_view::npos) return std::nullopt;
  const auto bank = digits_as_number(text.substr(0, dot), 255);
  const auto byte = digits_as_number(text.substr(dot + 1), 31);
  if (!bank || !byte) return std::nullopt;
  return MemoryPlace{*bank, *byte};
}

GainPlace known_address(const std::string& text, const std::string& option) {
  const std::size_t colon = text.find(':'), slash = text.find('/');
  if (colon == std::string::npos || slash == std::string::npos || slash < colon)
    place_fails(option, text, kPlaceForms);
  GainPlace out;
  out.words = text;
  const auto address = digits_as_number(std::string_view(text).substr(0, colon), 255);
  const auto over = memory_place(std::string_view(text).substr(colon + 1, slash - colon - 1));
  const std::string_view last = std::string_view(text).substr(slash + 1);
  if (!address || *address == 0 || !over) {
    place_fails(option, text, "expected ADDRESS1 1 to 255, a bank 0 to 255 and a byte 0 to 31 (1:3.7/3.6)");
  }
  out.address1 = *address;
  out.over.push_back(*over);
  if (const auto under = memory_place(last)) {
    out.under.push_back(*under);
  } else if (const auto units = digits_as_number(last, kMostUnits); units && *units > 0) {
    out.fixed_under = *units;
  } else {
    place_fails(option, text, "expected after the stroke BANK.BYTE or 1 to 255 units");
  }
  return out;
}

/// Where a capacitor of the table stands; its double ("aCin" next to "Cin") too.
std::vector<MemoryPlace> table_places(const ApiProject::Cam& cam, const std::string& name) {
  std::vector<MemoryPlace> out;
  for (const ApiProject::Capacitor& c : cam.capacitors) {
    if (c.name == name || c.name == "a" + name) out.push_back({c.bank, c.byte});
  }
  return out;
}

}  // namespace

GainPlace parse_gain_place(const std::string& text, const ApiProject* project, const std::string& option) {
  if (!text.empty() && is_digit(text[0])) return known_address(text, option);
  if (project == nullptr) place_fails(option, text, "names a CAM, expected the project's ApiCode.c as well");
  const std::size_t dot = text.find('.');
  const std::size_t colon = text.find(':');
  if (dot == std::string::npos || dot == 0 || colon < dot) place_fails(option, text, kPlaceForms);
  const std::string chip = text.substr(0, dot);
  const std::string cam = text.substr(dot + 1, colon == std::string::npos ? colon : colon - dot - 1);
  std::string over = "Cin", under = "Cout";
  if (colon != std::string::npos) {
    const std::size_t slash = text.find('/', colon);
    if (slash == std::string::npos) place_fails(option, text, kPlaceForms);
    over = text.substr(colon + 1, slash - colon - 1);
    under = text.substr(slash + 1);
  }
  const ApiProject::Cam* table = project->find(chip, cam);
  if (table == nullptr) {
    std::vector<std::string> names;
    for (const ApiProject::Cam& c : project->cams) names.push_back(c.chip + "." + c.name);
    place_fails(option, text, fmt::format("{} has no such CAM, it has {}", project->file, join(names, ", ")));
  }
  GainPlace out;
  out.words = text;
  for (const ApiProject::Chip& c : project->chips) {
    if (c.name == chip) out.address1 = c.address1;
  }
  std::vector<std::string> names;
  for (const ApiProject::Capacitor& c : table->capacitors) names.push_back(c.name);
  out.over = table_places(*table, over);
  if (out.over.empty()) {
    place_fails(option, text,
                fmt::format("{}:{}: has no capacitor {}, it has {}", project->file, table->line, over,
                            join(names, ", ")));
  }
  if (const auto units = digits_as_number(under, kMostUnits); units && *units > 0) {
    out.fixed_under = *units;
    return out;
  }
  out.under = table_places(*table, under);
  if (out.under.empty()) {
    place_fails(option, text,
                fmt::format("{}:{}: has no capacitor {}, it has {} (or give its units, 1 to 255)",
                            project->file, table->line, under, join(names, ", ")));
  }
  return out;
}

}  // namespace bodesmith::fpaa
