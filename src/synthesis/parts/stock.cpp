#include "synthesis/parts/stock.hpp"

#include <fmt/format.h>

#include "base/documents/document.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith::synthesis {
namespace {

/// One table of the TOML form.
std::optional<Series> parts_of(const Node& table, const std::string& unit) {
  const std::string values = "values_" + unit, least = "least_" + unit, greatest = "greatest_" + unit;
  table.allow_only({values, "series", least, greatest});
  if (table.has(values) && table.has("series"))
    table.at("series").fail("stands together with " + values + ", expected one of the two");
  if (table.has("series")) {
    const Node name = table.at("series");
    try {
      return Series::named(name.string());
    } catch (const InputError& error) {
      name.fail(error.what());
    }
  }
  if (!table.has(values)) return std::nullopt;
  std::vector<double> all;
  for (const Node& value : table.at(values).items()) all.push_back(value.positive());
  if (all.empty()) table.at(values).fail("is empty, expected at least one value");
  return Series::stock("stock", std::move(all));
}

void limits_of(const Node& table, const std::string& unit, std::optional<double>& min,
               std::optional<double>& max) {
  if (table.has("least_" + unit)) min = table.at("least_" + unit).positive();
  if (table.has("greatest_" + unit)) max = table.at("greatest_" + unit).positive();
  if (min && max && *min > *max) {
    table.at("greatest_" + unit).fail(fmt::format("is below least_{}, expected a range", unit));
  }
}

}  // namespace

StockList StockList::parse_toml(std::string_view text, const std::string& file) {
  const Node document = bodesmith::parse_toml(text, file);
  document.expect_schema("stock");
  document.allow_only({"schema", "resistors", "capacitors"});
  StockList out;
  if (document.has("resistors")) {
    const Node table = document.at("resistors");
    out.resistors = parts_of(table, "ohm");
    limits_of(table, "ohm", out.min_ohm, out.max_ohm);
  }
  if (document.has("capacitors")) {
    const Node table = document.at("capacitors");
    out.capacitors = parts_of(table, "f");
    limits_of(table, "f", out.min_f, out.max_f);
  }
  return out;
}

StockList StockList::parse_csv(std::string_view text, const std::string& file) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::vector<std::string> names;
  std::vector<double> ohm, farad;
  int number = 0;
  for (const std::string_view raw : split(text, '\n')) {
    ++number;
    const std::string_view line = trim(raw);
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string_view> cells = split(line, ',');
    const auto fail = [&](const std::string& message) { throw InputError(file, number, message); };
    if (names.empty()) {
      for (const std::string_view cell : cells) {
        names.emplace_back(trim(cell));
        if (names.back() != "resistance_ohm" && names.back() != "capacitance_f")
          fail(fmt::format("the column is called '{}', expected resistance_ohm or capacitance_f",
                           names.back()));
      }
      if (names.size() > 2 || (names.size() == 2 && names[0] == names[1]))
        fail("a column is there twice, expected resistance_ohm and capacitance_f");
      continue;
    }
    if (cells.size() != names.size())
      fail(fmt::format("{} cells, expected {} as in the header", cells.size(), names.size()));
    int filled = 0;
    for (size_t i = 0; i < cells.size(); ++i) {
      const std::string_view cell = trim(cells[i]);
      if (cell.empty()) continue;
      ++filled;
      double value = 0.0;
      if (!parse_quantity(cell, value) || !(value > 0.0)) {
        fail(fmt::format("'{}' is not a value above 0, expected {} such as {}", cell,
                         names[i] == "capacitance_f" ? "farad" : "ohm",
                         names[i] == "capacitance_f" ? "4.7e-9 or 4n7" : "4700 or 4k7"));
      }
      (names[i] == "capacitance_f" ? farad : ohm).push_back(value);
    }
    if (filled != 1) fail(fmt::format("{} values in a row, expected one", filled));
  }
  if (ohm.empty() && farad.empty()) throw InputError(file, number, "no values, expected at least one part");
  StockList out;
  if (!ohm.empty()) out.resistors = Series::stock("stock", std::move(ohm));
  if (!farad.empty()) out.capacitors = Series::stock("stock", std::move(farad));
  return out;
}

StockList StockList::read(const std::filesystem::path& path, Provenance& from) {
  const std::string text = from.read(path);
  return path.extension() == ".csv" ? parse_csv(text, path.string()) : parse_toml(text, path.string());
}

void StockList::apply_to(RealiseOptions& options) const {
  if (resistors) options.resistors = *resistors;
  if (capacitors) options.capacitors = *capacitors;
  options.limits.min_ohm = min_ohm.value_or(options.limits.min_ohm);
  options.limits.max_ohm = max_ohm.value_or(options.limits.max_ohm);
  options.limits.min_f = min_f.value_or(options.limits.min_f);
  options.limits.max_f = max_f.value_or(options.limits.max_f);
}

}  // namespace bodesmith::synthesis
