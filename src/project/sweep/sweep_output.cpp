#include <fmt/format.h>

#include <algorithm>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "project/report/report_chapters.hpp"
#include "project/sweep/sweep.hpp"

namespace bodesmith::project {
namespace {

using Status = SweptVariant::Status;

/// The names of all figures, in the order in which they first stand.
std::vector<std::string> figure_names(const Sweep& sweep) {
  std::vector<std::string> out;
  for (const SweptVariant& variant : sweep.variants) {
    for (const auto& [name, value] : variant.figures) {
      if (std::ranges::find(out, name) == out.end()) out.push_back(name);
    }
  }
  return out;
}

const double* figure(const SweptVariant& variant, const std::string& name) {
  for (const auto& [key, value] : variant.figures) {
    if (key == name) return &value;
  }
  return nullptr;
}

/// A cell of a CSV: in quotes where it holds a comma or a quote.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

/// By what a person would choose: tracking before tolerances before the error at the target.
const SweptVariant* best_variant(const Sweep& sweep, std::string& by) {
  const std::vector<std::string> names = figure_names(sweep);
  for (const char* name : {"tracking_percent", "yield_db", "target_db"}) {
    if (std::ranges::find(names, name) == names.end()) continue;
    const SweptVariant* best = nullptr;
    for (const SweptVariant& variant : sweep.variants) {
      const double* const value = variant.status == Status::done ? figure(variant, name) : nullptr;
      if (value != nullptr && (best == nullptr || *value < *figure(*best, name))) best = &variant;
    }
    by = name;
    return best;
  }
  return nullptr;
}

}  // namespace

Json sweep_json(const Sweep& sweep) {
  Json out;
  out["project"] = sweep.project;
  out["variants"] = Json::array();
  for (const SweptVariant& variant : sweep.variants) {
    Json one = {{"name", variant.name}, {"changes", Json::object()}, {"status", to_string(variant.status)}};
    for (std::size_t k = 0; k < sweep.keys.size(); ++k) {
      if (!variant.values[k].empty()) one["changes"][sweep.keys[k]] = variant.values[k];
    }
    if (!variant.message.empty()) one["message"] = variant.message;
    one["figures"] = Json::object();
    for (const auto& [key, value] : variant.figures) one["figures"][key] = value;
    one["kept"] = variant.kept;
    one["timing_s"] = {{"compute", variant.compute_s}};
    out["variants"].push_back(std::move(one));
  }
  std::string by;
  if (const SweptVariant* best = best_variant(sweep, by)) out["best"] = {{"name", best->name}, {"by", by}};
  out["timing_s"] = {{"compute", sweep.compute_s}};
  return out;
}

std::string sweep_csv(const Sweep& sweep) {
  const std::vector<std::string> names = figure_names(sweep);
  std::vector<std::string> head = {"variant"};
  for (const std::string& key : sweep.keys) head.push_back(cell(key));
  head.emplace_back("status");
  head.insert(head.end(), names.begin(), names.end());
  head.emplace_back("compute_s");
  head.emplace_back("message");
  std::string out = join(head, ",") + "\n";
  for (const SweptVariant& variant : sweep.variants) {
    std::vector<std::string> row = {cell(variant.name)};
    for (const std::string& value : variant.values) row.push_back(cell(value));
    row.emplace_back(to_string(variant.status));
    for (const std::string& name : names) {
      const double* const value = figure(variant, name);
      row.push_back(value == nullptr ? "" : number_text(*value));
    }
    row.push_back(rounded_text(variant.compute_s));
    row.push_back(cell(variant.message));
    out += join(row, ",") + "\n";
  }
  return out;
}

std::string sweep_summary(const Sweep& sweep) {
  const std::vector<std::string> names = figure_names(sweep);
  report::Table table{{"variant", "status"}, {}, {}};
  table.head.insert(table.head.end(), names.begin(), names.end());
  std::string refused;
  for (const SweptVariant& variant : sweep.variants) {
    std::string status(to_string(variant.status));
    std::replace(status.begin(), status.end(), '_', ' ');
    std::vector<std::string>& row = table.rows.emplace_back(std::vector{variant.name, status});
    for (const std::string& name : names) {
      const double* const value = figure(variant, name);
      row.push_back(value == nullptr ? "" : rounded_text(*value, 3));
    }
    if (!variant.message.empty()) refused += variant.name + ": " + variant.message + "\n";
  }
  std::string out = fmt::format("{}: {} variants\n", sweep.project, sweep.variants.size()) +
                    text_of("variant", table) + refused;
  const auto kept =
      std::ranges::count_if(sweep.variants, [](const SweptVariant& variant) { return variant.kept; });
  if (kept > 0) out += fmt::format("{} of them kept from an earlier sweep\n", kept);
  std::string by;
  if (const SweptVariant* best = best_variant(sweep, by))
    out += fmt::format("best by {}: {} ({})\n", by, best->name, best->what);
  return out + "table: sweep.csv\n";
}

}  // namespace bodesmith::project
