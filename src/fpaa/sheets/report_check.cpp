#include "fpaa/sheets/report_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

/// One run of visible text, and the tag it stands in ("h1", "b", "td label", "td value", …).
struct Run {
  std::string tag;
  std::string text;
};

std::string plain(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '&') {
      const std::size_t end = text.find(';', i);
      const std::string_view name = end == std::string_view::npos ? "" : text.substr(i + 1, end - i - 1);
      const char* found = name == "amp"    ? "&"
                          : name == "lt"   ? "<"
                          : name == "gt"   ? ">"
                          : name == "nbsp" ? " "
                                           : nullptr;
      if (found != nullptr) {
        out += found;
        i = end;
        continue;
      }
    }
    const bool space = is_blank(text[i]);
    if (space && (out.empty() || out.back() == ' ')) continue;
    out += space ? ' ' : text[i];
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

std::vector<Run> visible_text(std::string_view html) {
  std::vector<Run> out;
  std::string tag;
  std::string text;
  const auto flush = [&] {
    const std::string clean = plain(text);
    text.clear();
    if (!clean.empty()) out.push_back({tag, clean});
  };
  std::size_t at = 0;
  while (at < html.size()) {
    if (html[at] != '<') {
      text += html[at++];
      continue;
    }
    const std::size_t end = html.find('>', at);
    if (end == std::string_view::npos) break;
    const std::string mark = lower_case(html.substr(at + 1, end - at - 1));
    at = end + 1;
    if (mark.rfind("br", 0) == 0) {
      text += ' ';
      continue;
    }
    if (mark.rfind("style", 0) == 0 || mark.rfind("script", 0) == 0) {
      const std::size_t close = lower_case(html.substr(at)).find("</");
      if (close == std::string::npos) break;
      at += close;
      continue;
    }
    flush();
    if (mark.rfind("td", 0) == 0) {
      tag = mark.find("side_label") != std::string::npos   ? "label"
            : mark.find("side_value") != std::string::npos ? "value"
                                                           : "td";
    } else if (mark[0] == '/') {
      tag.clear();
    } else {
      tag = mark.substr(0, mark.find_first_of(" \t\n/"));
    }
  }
  flush();
  return out;
}

/// A leading number with an optional unit, in Hz when `frequency`.
std::optional<double> number_in(std::string_view text, bool frequency) {
  text = trim(text);
  std::size_t end = 0;
  while (end < text.size() &&
         (is_digit(text[end]) || std::string_view("+-.eE").find(text[end]) != std::string_view::npos)) {
    ++end;
  }
  double value = 0.0;
  if (!parse_number(text.substr(0, end), value)) return std::nullopt;
  if (!frequency) return value;
  const std::string unit = lower_case(trim(text.substr(end)).substr(0, 3));
  if (unit == "mhz") return value * 1e6;
  if (unit == "khz") return value * 1e3;
  if (unit.rfind("hz", 0) == 0) return value;
  return value * 1e3;  // the report's bare numbers are kHz
}

bool is_close(double got, double wanted, double tolerance) {
  return std::abs(got - wanted) <= tolerance * std::max(std::abs(wanted), 1e-12);
}

/// Compares one CAM of the report with the plan's.
class CamComparison {
 public:
  CamComparison(const ReportedCam& got, const PlacedCam& wanted, double tolerance,
                std::vector<std::string>& out)
      : got_(got), wanted_(wanted), tolerance_(tolerance), out_(out) {}

  void run() {
    if (got_.cam != wanted_.cam_name()) differ("the CAM", got_.cam, std::string(wanted_.cam_name()));
    clock();
    words("Output Phase", fmt::format("Phase {}", wanted_.phase));
    if (!wanted_.option.empty()) words("Filter Type", wanted_.option);
    for (const CamValues::Entry& entry : wanted_.realised.entries()) {
      const CamParameter* parameter = wanted_.cam->parameter(entry.key);
      const auto should = entry.number();
      if (parameter == nullptr || !should) continue;
      number(parameter->words, *should, parameter->frequency);
    }
  }

 private:
  void differ(std::string_view what, std::string_view is, std::string_view should) {
    out_.push_back(fmt::format("{}: {} is {}, the plan says {}", wanted_.name, what, is, should));
  }
  const std::string* row(std::string_view label) const {
    for (const auto& [key, value] : got_.rows) {
      // "Gain 1 (UpperInput)" and the like: the words in front count.
      if (key == label || key.rfind(std::string(label) + " [", 0) == 0 ||
          key.rfind(std::string(label) + " (", 0) == 0) {
        return &value;
      }
    }
    return nullptr;
  }

  void clock() {
    const std::string* text = number("ClockA", wanted_.clock_a.value, true);
    const std::string should = fmt::format("Chip Clock {}", wanted_.clock_index);
    if (text != nullptr && text->find("Chip Clock") != std::string::npos &&
        text->find(should) == std::string::npos) {
      differ("ClockA", *text, should);
    }
  }

  /// A row that may be missing.
  void words(const std::string& label, const std::string& should) {
    const std::string* text = row(label);
    if (text != nullptr && lower_case(*text) != lower_case(should)) differ(label, *text, should);
  }

  /// A row that has to be there; returned is what it says.
  const std::string* number(std::string_view label, double should, bool frequency) {
    const std::string* text = row(label);
    if (text == nullptr) {
      out_.push_back(fmt::format("{}: no {} in the report", wanted_.name, label));
      return nullptr;
    }
    const auto got = number_in(*text, frequency);
    if (!got || !is_close(*got, should, tolerance_)) {
      differ(label, *text, frequency ? rounded_text(should / 1e3, 6) + " kHz" : rounded_text(should, 6));
    }
    return text;
  }

  const ReportedCam& got_;
  const PlacedCam& wanted_;
  double tolerance_;
  std::vector<std::string>& out_;
};

void compare_clocks(const DesignerReport::Chip& got, const ChipPlan& wanted, std::vector<std::string>& out) {
  const auto find = [&](const std::string& start) -> const std::string* {
    for (const auto& [label, value] : got.clocks) {
      if (label.rfind(start, 0) == 0) return &label;
    }
    return nullptr;
  };
  const auto check = [&](const std::string& start, const std::string& divisor) {
    const std::string* label = find(start);
    if (label == nullptr) {
      out.push_back(fmt::format("chip {}: no {} in the report", wanted.chip, start));
    } else if (label->find("/ " + divisor + ")") == std::string::npos) {
      out.push_back(fmt::format("chip {}: {}, the plan divides by {}", wanted.chip, *label, divisor));
    }
  };
  if (got.clocks.empty()) return;
  check("System Clock 1", std::to_string(wanted.clocks.sys1_divisor));
  for (std::size_t k = 0; k < wanted.clocks.clocks.size(); ++k) {
    const ChipClock& clock = wanted.clocks.clocks[k];
    check(fmt::format("Clock {}", k), std::to_string(clock.divisor));
    const std::string* label = find(fmt::format("Clock {}", k));
    if (label != nullptr && label->find(fmt::format("sys{}", clock.system)) == std::string::npos) {
      out.push_back(
          fmt::format("chip {}: {}, the plan takes it from sys{}", wanted.chip, *label, clock.system));
    }
  }
}

}  // namespace

DesignerReport read_report(std::string_view html, const std::string& file) {
  DesignerReport out;
  std::string chip;
  enum class Part { other, clocks, cams } part = Part::other;
  std::string label;
  for (const Run& run : visible_text(html)) {
    if (run.tag == "h1") {
      const std::size_t colon = run.text.find(": ");
      const std::string what = run.text.substr(0, colon);
      chip = colon == std::string::npos ? "" : run.text.substr(colon + 2);
      part = what == "Clocks"                        ? Part::clocks
             : what == "Configurable Analog Modules" ? Part::cams
                                                     : Part::other;
      if (what == "Chip") out.chips.push_back({chip, {}});
    } else if (run.tag == "b" && part == Part::cams) {
      const std::size_t open = run.text.rfind('(');
      ReportedCam cam;
      cam.chip = chip;
      cam.name = std::string(trim(run.text.substr(0, open)));
      const std::string kind = open == std::string::npos ? "" : run.text.substr(open + 1);
      cam.cam = kind.substr(0, kind.find_first_of(" )"));
      out.cams.push_back(std::move(cam));
    } else if (run.tag == "label") {
      label = run.text;
    } else if (run.tag == "value" && !label.empty()) {
      if (part == Part::cams && !out.cams.empty()) out.cams.back().rows.emplace_back(label, run.text);
      if (part == Part::clocks) {
        for (DesignerReport::Chip& c : out.chips) {
          if (c.name == chip) c.clocks.emplace_back(label, run.text);
        }
      }
      label.clear();
    }
  }
  if (out.cams.empty()) {
    throw InputError(
        fmt::format("{}: shows no CAMs, expected the HTML report of AnadigmDesigner2 (with 'Configurable "
                    "Analog Modules')",
                    file));
  }
  return out;
}

std::vector<std::string> compare_report(const DesignerReport& report, const Plan& plan, double tolerance) {
  std::vector<std::string> out;
  std::vector<bool> seen(report.cams.size(), false);
  for (const PlacedCam* wanted : plan.cams()) {
    bool found = false;
    for (std::size_t i = 0; i < report.cams.size() && !found; ++i) {
      if (report.cams[i].name != wanted->name) continue;
      found = true;
      seen[i] = true;
      CamComparison(report.cams[i], *wanted, tolerance, out).run();
    }
    if (!found) out.push_back(fmt::format("{} ({}) is not in the report", wanted->name, wanted->cam_name()));
  }
  for (std::size_t i = 0; i < report.cams.size(); ++i) {
    if (!seen[i])
      out.push_back(
          fmt::format("{} ({}) is in the report, not in the plan", report.cams[i].name, report.cams[i].cam));
  }
  for (std::size_t c = 0; c < plan.chips.size() && c < report.chips.size(); ++c) {
    compare_clocks(report.chips[c], plan.chips[c], out);
  }
  return out;
}

}  // namespace bodesmith::fpaa
