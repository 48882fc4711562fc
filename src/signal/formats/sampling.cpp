#include "signal/formats/sampling.hpp"

#include <algorithm>

#include "base/text.hpp"

namespace bodesmith::formats {
namespace {

constexpr std::string_view kStepKeys[] = {"delta_x", "hresolution", "time interval", "xinc",
                                          "sample interval"};
constexpr std::string_view kStartKeys[] = {"x0", "hoffset", "xorg"};

/// The one number behind a key; nothing where its cells differ or are none.
std::optional<double> only_number(const std::vector<std::string_view>& cells, bool decimal_comma) {
  std::optional<double> only;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    std::string cell(trim(cells[i]));
    if (cell.empty()) continue;
    if (decimal_comma) std::replace(cell.begin(), cell.end(), ',', '.');
    if (cell.back() == 'S') cell.back() = 's';
    double value = 0.0;
    if (!parse_quantity(cell, value) || (only && *only != value)) return std::nullopt;
    only = value;
  }
  return only;
}

}  // namespace

std::optional<Sampling> sampling_above(const NumberTable& table) {
  Sampling out;
  for (const std::string& line : table.above) {
    const char separator = line.find('\t') != std::string::npos  ? '\t'
                           : line.find(';') != std::string::npos ? ';'
                                                                 : ',';
    const std::vector<std::string_view> cells = formats::split_cells(line, separator);
    std::string key = lower_case(cells.front());
    while (key.ends_with(':') || key.ends_with(' ')) key.pop_back();
    // LabVIEW's spectra have steps of frequency.
    if (key == "x_dimension" && line.find("Time") == std::string::npos) return std::nullopt;
    const auto is_in = [&](const auto& keys) {
      return std::find(std::begin(keys), std::end(keys), key) != std::end(keys);
    };
    if (!is_in(kStepKeys) && !is_in(kStartKeys)) continue;
    const auto value = only_number(cells, table.decimal_comma);
    if (!value) return std::nullopt;
    if (is_in(kStartKeys)) {
      out.start_s = *value;
    } else {
      out.key = cells.front();
      out.step_s = *value;
    }
  }
  if (!(out.step_s > 0.0)) return std::nullopt;
  return out;
}

}  // namespace bodesmith::formats
