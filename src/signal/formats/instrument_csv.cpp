// Instruments whose numbers do not stand below headings, one line of the table below each:
// - Tektronix TDS ("Record Length,2500,,-0.0005,0.02,"): keys and values in the first columns, time and value next to them.
// - Rigol ("X,CH1,CH2,Start,Increment," and "Sequence,Volt,Volt,-6e-03,1e-05"): counts of samples, start and step above.
// - GW Instek ("Memory Length,4000" … "Waveform Data,"): values or times and values below; whole numbers are codes of the
//   converter, 25 a division ("Vertical Scale"), the step is the "Sampling Period".
// And tables with headings between BEGIN and END (Keysight's network analysers: "!CSV A.01.01"; "! DATA UNIT dB").
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "signal/formats/format.hpp"
#include "signal/formats/table_meaning.hpp"

namespace bodesmith::formats {
namespace {

constexpr std::size_t kHead = 4000;  ///< bytes in which an instrument's marks stand

enum class Axis { times, counts, none_or_times };

struct Layout {
  std::string_view name;
  std::string_view first_mark;   ///< begins the text
  std::string_view second_mark;  ///< stands near its beginning
  std::string_view data_below;   ///< begins the line above the numbers; empty: they stand next to the keys
  std::size_t first_column;      ///< of the numbers
  Axis axis;
  std::string_view start_key;
  std::string_view step_key;
  std::string_view code_key;  ///< volts of kCodesPerDivision of whole numbers
};
constexpr double kCodesPerDivision = 25.0;

constexpr Layout kLayouts[] = {
    {"Tektronix TDS CSV", "Record Length,", "Sample Interval,", "", 3, Axis::times, "", "", ""},
    {"Rigol CSV", "X,CH", "Start,Increment", "Sequence", 0, Axis::counts, "Start", "Increment", ""},
    {"GW Instek CSV", "Memory Length,", "Sampling Period,", "Waveform Data", 0, Axis::none_or_times, "",
     "Sampling Period", "Vertical Scale"},
};

/// Newer Tektronix scopes put keys in quotation marks; other makers begin alike and have their numbers below.
const Layout* layout_of(const Source& source) {
  std::string head(source.text.substr(0, kHead));
  std::erase(head, '"');
  const std::vector<std::string_view> first =
      split_cells(std::string_view(head).substr(0, head.find('\n')), ',');
  double number = 0.0;
  for (const Layout& layout : kLayouts) {
    if (layout.data_below.empty() &&
        (first.size() <= layout.first_column || !parse_number(first[layout.first_column], number)))
      continue;
    if (head.starts_with(layout.first_mark) && head.find(layout.second_mark) != std::string::npos)
      return &layout;
  }
  return nullptr;
}

class LayoutReader {
 public:
  LayoutReader(const Source& source, const Layout& layout) : source_(source), layout_(layout) {}

  NumberTable read(Words& words) {
    std::string_view text = source_.text;
    bool in_data = layout_.data_below.empty();
    for (int line_number = 1; !text.empty(); ++line_number) {
      const std::string_view line = next_line(text);
      const std::vector<std::string_view> cells = split_cells(line, ',');
      const bool marked = !layout_.data_below.empty() && line.starts_with(layout_.data_below);
      if (!in_data || layout_.first_column > 0) take_keys(cells, marked);
      if (in_data) take_numbers(cells, line_number);
      in_data = in_data || marked;
    }
    if (table_.columns.empty()) throw InputError(source_.file, 0, "has no rows of numbers");
    return finished(words);
  }

 private:
  /// "Key,Value", and where a line stands above the marked one: a key above each of its values.
  void take_keys(const std::vector<std::string_view>& cells, bool marked) {
    if (marked && layout_.axis == Axis::counts) {
      for (std::size_t i = 0; i < std::min(cells.size(), above_.size()); ++i) {
        words_[above_[i]] = cells[i];
        if (i > 0 && is_unit_alone(std::string(cells[i])))
          channels_.push_back(fmt::format("{} ({})", above_[i], cells[i]));
      }
    } else if (cells.size() > 1 && !cells[0].empty()) {
      words_[std::string(cells[0])] = cells[1];
    }
    above_.assign(cells.begin(), cells.end());
  }

  void take_numbers(const std::vector<std::string_view>& cells, int line_number) {
    std::vector<double> row;
    for (std::size_t i = layout_.first_column; i < cells.size(); ++i) {
      double value = 0.0;
      if (cells[i].empty()) continue;
      if (!parse_number(cells[i], value))
        throw InputError(source_.file, line_number,
                         fmt::format("'{}' is not a finite number", cells[i].substr(0, 40)));
      row.push_back(value);
    }
    if (row.empty()) return;
    if (table_.columns.empty()) table_.columns.resize(row.size());
    if (row.size() != table_.columns.size())
      throw InputError(
          source_.file, line_number,
          fmt::format("has {} numbers, expected {} as in the rows above", row.size(), table_.columns.size()));
    for (std::size_t i = 0; i < row.size(); ++i) table_.columns[i].push_back(row[i]);
    table_.lines.push_back(line_number);
  }

  double number_of(std::string_view key) const {
    double value = 0.0;
    const auto found = words_.find(std::string(key));
    if (found == words_.end() || !parse_number(found->second, value))
      throw InputError(source_.file, 0, fmt::format("has no number for '{}'", key));
    return value;
  }
  std::string word(const std::string& key, const std::string& otherwise) const {
    const auto found = words_.find(key);
    return found == words_.end() || found->second.empty() ? otherwise : found->second;
  }

  NumberTable finished(Words& words) {
    const bool own_axis = layout_.axis != Axis::none_or_times || table_.columns.size() > 1;
    if (!own_axis) table_.columns.insert(table_.columns.begin(), std::vector<double>(table_.rows()));
    std::vector<double>& time = table_.columns.front();
    if (layout_.axis == Axis::counts || !own_axis) {
      const double start = layout_.start_key.empty() ? 0.0 : number_of(layout_.start_key);
      const double step = number_of(layout_.step_key);
      for (std::size_t i = 0; i < time.size(); ++i)
        time[i] = start + step * (own_axis ? time[i] : static_cast<double>(i));
      words.notes.push_back(fmt::format("steps of {}", engineering_text(step, "s", 6)));
    }
    table_.headings = {fmt::format("Time ({})", word("Horizontal Units", "s"))};
    if (channels_.empty())
      channels_ = {fmt::format("{} ({})", word("Source", "signal"), word("Vertical Units", "V"))};
    table_.headings.insert(table_.headings.end(), channels_.begin(), channels_.end());
    if (table_.headings.size() != table_.columns.size())
      throw InputError(
          source_.file, table_.lines.front(),
          fmt::format("has {} numbers, expected {}", table_.columns.size(), table_.headings.size()));
    if (!own_axis) scale_codes(words);
    return std::move(table_);
  }

  void scale_codes(Words& words) {
    std::vector<double>& values = table_.columns.back();
    if (!std::ranges::all_of(values, [](double v) { return v == std::floor(v); })) return;
    const double volts = number_of(layout_.code_key) / kCodesPerDivision;
    for (double& value : values) value *= volts;
    words.notes.push_back(fmt::format("codes of {}", engineering_text(volts, "V", 6)));
  }

  const Source& source_;
  const Layout& layout_;
  NumberTable table_;
  std::map<std::string, std::string> words_;
  std::vector<std::string> above_;
  std::vector<std::string> channels_;
};

class InstrumentCsv : public Format {
 public:
  std::string_view name() const override { return "oscilloscope CSV"; }
  bool recognises(const Source& source) const override { return layout_of(source) != nullptr; }
  Foreign read(const Source& source) const override {
    const Layout& layout = *layout_of(source);
    Words words{std::string(layout.name), {}};
    NumberTable table = LayoutReader(source, layout).read(words);
    return read_by_headings(source, std::move(table), std::move(words));
  }
};

struct Block {
  std::size_t begin = 0;  ///< of the first line below BEGIN
  std::size_t end = 0;    ///< of the line END
  std::size_t count = 0;  ///< blocks in the text
};

/// The first lines between BEGIN and END.
std::optional<Block> first_block(std::string_view text) {
  Block out;
  bool open = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = trim(text.substr(at, end - at));
    if (line == "BEGIN" || line.starts_with("BEGIN ")) {
      if (out.count++ == 0) {
        out.begin = std::min(end + 1, text.size());
        open = true;
      }
    } else if (line == "END" && open) {
      out.end = at;
      open = false;
    } else if (out.count == 0 && !line.empty() && line.front() != '!') {
      return std::nullopt;
    }
    at = end + 1;
  }
  if (out.count == 0) return std::nullopt;
  if (open) out.end = text.size();
  return out;
}

class BlockCsv : public Format {
 public:
  std::string_view name() const override { return "network analyser CSV"; }
  bool recognises(const Source& source) const override { return first_block(source.text).has_value(); }
  Foreign read(const Source& source) const override {
    const Block block = *first_block(source.text);
    // Lines keep their numbers.
    std::string inside(source.text.substr(0, block.end));
    for (std::size_t i = 0; i < block.begin; ++i) {
      if (inside[i] != '\n') inside[i] = ' ';
    }
    Source part = source;
    part.text = inside;
    NumberTable table = read_table(part);
    if (table.headings.empty()) table.headings = units_above(source, block, table);
    Words words{std::string(name()), {}};
    if (block.count > 1) words.notes.push_back(fmt::format("the first of {} blocks", block.count));
    return read_by_headings(part, std::move(table), std::move(words));
  }

 private:
  /// "! FREQ UNIT Hz", "! DATA UNIT dB"
  static std::vector<std::string> units_above(const Source& source, const Block& block,
                                              const NumberTable& table) {
    std::map<std::string, std::string> units;
    for (const std::string_view line : split(source.text.substr(0, block.begin), '\n')) {
      for (const char* key : {"FREQ UNIT", "DATA UNIT"}) {
        const std::size_t at = line.find(key);
        if (at != std::string_view::npos) units[key] = trim(line.substr(at + std::string_view(key).size()));
      }
    }
    if (units.size() != 2 || table.columns.size() != 2)
      throw InputError(source.file, table.lines.front(),
                       "begins a block without headings, expected Freq(Hz) and what was measured above it");
    return {fmt::format("Frequency ({})", units["FREQ UNIT"]), fmt::format("Level ({})", units["DATA UNIT"])};
  }
};

}  // namespace

BODESMITH_ENTRY(Format, instrument_csv, InstrumentCsv)
BODESMITH_ENTRY(Format, block_csv, BlockCsv)

}  // namespace bodesmith::formats
