// LTspice's exported text: a line of names between tabs ("Freq.<tab>V(out)" or "time<tab>V(in)<tab>V(out)"), then rows;
// responses as (-3.01dB,-45°) or as real,imaginary. Several runs stand below lines "Step Information: …"; the first is
// taken, FILE:v(out)@2 takes the second.
#include <fmt/format.h>

#include <charconv>
#include <complex>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "signal/formats/format.hpp"
#include "signal/formats/traces.hpp"

namespace bodesmith::formats {
namespace {

bool is_ltspice_axis(std::string_view name) {
  return name == "Freq." || name == "time";
}

struct LtspiceTable {
  bool over_time = false;
  std::vector<std::string> names;
  std::vector<double> axis;
  std::vector<std::vector<Complex>> values;
  std::vector<int> lines;
  std::size_t runs = 0;
};

class LtspiceReader {
 public:
  LtspiceReader(const Source& source, std::size_t run) : source_(source), wanted_run_(run) {}

  LtspiceTable read() {
    std::string_view text = source_.text;
    while (!text.empty()) {
      ++line_;
      const std::string_view line = trim(next_line(text));
      if (line.empty()) continue;
      if (table_.names.empty()) {
        names(line);
      } else if (line.starts_with("Step Information")) {
        ++table_.runs;
      } else {
        row(line);
      }
    }
    if (table_.runs == 0) table_.runs = 1;
    if (wanted_run_ > table_.runs)
      throw InputError(source_.file, 0,
                       fmt::format("holds {} runs, there is no run {}", table_.runs, wanted_run_));
    if (table_.axis.empty()) throw InputError(source_.file, line_, "ends without a row of numbers");
    return std::move(table_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(source_.file, line_, what); }

  void names(std::string_view line) {
    const auto cells = split(line, '\t');
    table_.over_time = cells[0] == "time";
    for (std::size_t i = 1; i < cells.size(); ++i) table_.names.emplace_back(trim(cells[i]));
    table_.values.resize(table_.names.size());
  }

  void row(std::string_view line) {
    const auto cells = split(line, '\t');
    if (cells.size() != table_.names.size() + 1)
      fail(fmt::format("has {} cells, expected {} as in the header", cells.size(), table_.names.size() + 1));
    double at = 0.0;
    if (!parse_number(cells[0], at)) fail(fmt::format("'{}' is not a finite number", cells[0].substr(0, 40)));
    std::vector<Complex> row;
    for (std::size_t i = 1; i < cells.size(); ++i) row.push_back(value(trim(cells[i])));
    if (std::max<std::size_t>(table_.runs, 1) != wanted_run_) return;
    table_.axis.push_back(at);
    table_.lines.push_back(line_);
    for (std::size_t i = 0; i < row.size(); ++i) table_.values[i].push_back(row[i]);
  }

  Complex value(std::string_view cell) const {
    const auto broken = [&] {
      fail(fmt::format("'{}' is neither a number nor (…dB,…°) nor real,imaginary", cell.substr(0, 60)));
    };
    const std::size_t comma = cell.find(',');
    double a = 0.0;
    double b = 0.0;
    if (!cell.starts_with('(')) {
      if (!parse_number(cell.substr(0, comma), a) ||
          (comma != std::string_view::npos && !parse_number(cell.substr(comma + 1), b)))
        broken();
      return {a, b};
    }
    const std::string_view magnitude = cell.substr(1, comma == std::string_view::npos ? comma : comma - 1);
    if (comma == std::string_view::npos || !cell.ends_with(')') || !magnitude.ends_with("dB") ||
        !parse_number(magnitude.substr(0, magnitude.size() - 2), a))
      broken();
    // The degree sign may be one byte, two, or what another program made of it.
    std::string_view angle = cell.substr(comma + 1);
    const std::size_t end = angle.find_first_not_of("+-.0123456789eE");
    if (end == std::string_view::npos || angle.size() - end > 5 || !parse_number(angle.substr(0, end), b))
      broken();
    return std::polar(from_decibel(a), to_radians(b));
  }

  const Source& source_;
  std::size_t wanted_run_;
  int line_ = 0;
  LtspiceTable table_;
};

class LtspiceText : public Format {
 public:
  std::string_view name() const override { return "LTspice text"; }
  bool recognises(const Source& source) const override {
    const std::string_view line = trim(source.text.substr(0, source.text.find('\n')));
    const std::size_t tab = line.find('\t');
    return tab != std::string_view::npos && is_ltspice_axis(line.substr(0, tab));
  }

  Foreign read(const Source& source) const override {
    Source chosen = source;
    std::size_t run = 1;
    const std::size_t at = chosen.choice.rfind('@');
    if (at != std::string::npos) {
      const std::string digits = chosen.choice.substr(at + 1);
      const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), run);
      if (result.ec != std::errc() || result.ptr != digits.data() + digits.size() || run == 0)
        throw InputError(source.file, 0, fmt::format("'@{}' is no run, expected @1, @2, …", digits));
      chosen.choice.resize(at);
    }
    LtspiceTable table = LtspiceReader(chosen, run).read();
    Words words{std::string(name()), {}};
    if (table.runs > 1) words.notes.push_back(fmt::format("run {} of {} (others: @2, …)", run, table.runs));
    if (!table.over_time) {
      ResponseTrace trace = choose_response(chosen, table.names, table.values);
      words.notes.insert(words.notes.begin(), trace.name);
      return response_columns(chosen, std::move(words), std::move(table.axis), std::move(trace),
                              std::move(table.lines));
    }
    std::vector<SignalTrace> signals;
    for (std::size_t i = 0; i < table.names.size(); ++i) {
      signals.push_back({table.names[i], {}});
      for (const Complex& v : table.values[i]) signals.back().values.push_back(v.real());
    }
    return record_columns(chosen, std::move(words), std::move(table.axis),
                          choose_signals(chosen, std::move(signals)), std::move(table.lines),
                          Steps::made_even);
  }
};

}  // namespace

BODESMITH_ENTRY(Format, ltspice_text, LtspiceText)

}  // namespace bodesmith::formats
