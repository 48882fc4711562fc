// Raw files of ngspice and LTspice: a header of "Key: value" lines (UTF-16 in LTspice), a table of variables, then
// "Values:" with numbers as text or "Binary:" with numbers as they lie in memory. The first variable is frequency or time.
//   AC            every variable a pair of doubles (the frequency too)
//   transient     ngspice: doubles. LTspice: the time a double, the rest floats, unless the flags say "double"
//   "fastaccess"  variable by variable instead of point by point
//   "stepped"     several runs, one after the other; FILE:v(out)@2 takes the second
// LTspice marks points by times below 0; their absolute values count.
#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstring>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "signal/formats/format.hpp"
#include "signal/formats/text_encoding.hpp"
#include "signal/formats/traces.hpp"

namespace bodesmith::formats {
namespace {

using Complex = std::complex<double>;

struct RawPlot {
  std::string name;
  std::string program;
  bool complex = false;
  bool doubles = false;  ///< LTspice: all of them
  bool by_variable = false;
  bool ltspice = false;
  std::size_t points = 0;
  std::vector<std::string> variables;
  std::vector<std::vector<Complex>> values;  ///< of each variable
};

/// Lines of the header in either encoding, with the byte where each begins.
class RawCursor {
 public:
  explicit RawCursor(std::string_view bytes)
      : bytes_(bytes), wide_(begins_as_utf16(bytes, "Title:")), at_(bytes.starts_with("\xFF\xFE") ? 2 : 0) {
    if (at_ == 2) wide_ = true;
  }
  std::size_t byte() const { return at_; }
  bool at_end() const { return at_ >= bytes_.size(); }
  std::string_view rest() const { return bytes_.substr(std::min(at_, bytes_.size())); }
  void skip(std::size_t count) { at_ += count; }
  void skip_space() {
    while (!at_end() && is_blank(bytes_[at_])) ++at_;
  }

  /// Nothing when no line ends any more within a reasonable length.
  std::optional<std::string> line() {
    std::string out;
    const std::size_t width = wide_ ? 2 : 1;
    for (std::size_t at = at_; at + width <= bytes_.size() && out.size() < 100'000; at += width) {
      if (bytes_[at] == '\n' && (!wide_ || bytes_[at + 1] == 0)) {
        at_ = at + width;
        return std::string(trim(out));
      }
      out += bytes_[at];
    }
    return std::nullopt;
  }

 private:
  std::string_view bytes_;
  bool wide_;
  std::size_t at_;
};

class RawReader {
 public:
  explicit RawReader(const Source& source) : source_(source), cursor_(source.bytes) {}

  /// The first plot over frequency or time.
  RawPlot read() {
    std::string seen;
    while (true) {
      RawPlot plot = header();
      const std::string axis = plot.variables.empty() ? "" : lower_case(plot.variables.front());
      const bool wanted = plot.variables.size() >= 2 && (axis == "frequency" || axis == "time");
      values(plot, wanted);
      if (wanted) return plot;
      seen += (seen.empty() ? "" : ", ") + plot.name;
      cursor_.skip_space();
      if (cursor_.at_end())
        throw InputError(
            source_.file, 0,
            fmt::format("holds no AC or transient analysis over frequency or time, found: {}", seen));
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { fail_at(cursor_.byte(), what); }
  [[noreturn]] void fail_at(std::size_t byte, const std::string& what) const {
    throw InputError(source_.file, 0, fmt::format("byte {}: {}", byte, what));
  }

  std::string next_line() {
    const std::size_t begin = cursor_.byte();
    if (auto line = cursor_.line()) return *line;
    fail_at(begin, "the file ends within the header");
  }

  std::size_t count(std::string_view value, std::size_t byte) const {
    std::size_t out = 0;
    const auto result = std::from_chars(value.data(), value.data() + value.size(), out);
    if (result.ec != std::errc() || out > (std::size_t{1} << 40))
      fail_at(byte, fmt::format("'{}' is not a count", value.substr(0, 40)));
    return out;
  }

  RawPlot header() {
    RawPlot plot;
    std::size_t variables = 0;
    while (true) {
      const std::size_t begin = cursor_.byte();
      const std::string line = next_line();
      const std::size_t colon = line.find(':');
      if (line.empty()) continue;
      if (colon == std::string::npos)
        fail_at(begin, fmt::format("'{}' is no header line", line.substr(0, 40)));
      const std::string key = lower_case(line.substr(0, colon));
      const std::string value(trim(std::string_view(line).substr(colon + 1)));
      if (key == "plotname") plot.name = value;
      if (key == "command") {
        plot.program = value;
        plot.ltspice = value.find("LTspice") != std::string::npos ||
                       value.find("Linear Technology") != std::string::npos;
      }
      if (key == "flags") {
        const std::string flags = lower_case(value);
        plot.complex = flags.find("complex") != std::string::npos;
        plot.doubles = flags.find("double") != std::string::npos;
        plot.by_variable = flags.find("fastaccess") != std::string::npos;
        // ngspice writes "real" or "complex"; LTspice adds "forward".
        plot.ltspice = plot.ltspice || flags.find("forward") != std::string::npos;
      }
      if (key == "no. variables") variables = count(value, begin);
      if (key == "no. points") plot.points = count(value, begin);
      if (key == "variables") {
        if (variables == 0 || variables > 1'000'000)
          fail_at(begin, "no count of variables before their names");
        for (std::size_t i = 0; i < variables; ++i) plot.variables.push_back(variable());
      }
      if (key == "binary" || key == "values") {
        text_ = key == "values";
        if (plot.variables.empty()) fail_at(begin, "the values begin before the names of the variables");
        if (plot.points == 0) fail_at(begin, "the header says that there are no points");
        return plot;
      }
    }
  }

  std::string variable() {
    const std::size_t begin = cursor_.byte();
    std::vector<std::string> cells;
    const std::string line = next_line();
    for (const std::string_view cell : split(line, '\t')) {
      if (!trim(cell).empty()) cells.emplace_back(trim(cell));
    }
    if (cells.size() < 3) {
      cells.clear();
      for (const std::string_view cell : split(line, ' ')) {
        if (!trim(cell).empty()) cells.emplace_back(trim(cell));
      }
    }
    if (cells.size() < 3)
      fail_at(begin, fmt::format("'{}' is no variable: number, name, type", line.substr(0, 40)));
    return cells[1];
  }

  void values(RawPlot& plot, bool keep) {
    if (text_) {
      text_values(plot);
    } else {
      binary_values(plot, keep);
    }
  }

  static double number_at(std::string_view bytes, std::size_t at) {
    std::uint64_t raw = 0;
    std::memcpy(&raw, bytes.data() + at, 8);
    return std::bit_cast<double>(raw);
  }
  static double float_at(std::string_view bytes, std::size_t at) {
    std::uint32_t raw = 0;
    std::memcpy(&raw, bytes.data() + at, 4);
    return std::bit_cast<float>(raw);
  }

  void binary_values(RawPlot& plot, bool keep) {
    const std::size_t n = plot.variables.size();
    const bool floats = plot.ltspice && !plot.complex && !plot.doubles;
    const std::size_t other = plot.complex ? 16 : floats ? 4 : 8;
    const std::size_t first = plot.complex ? 16 : 8;
    const std::size_t per_point = first + (n - 1) * other;
    const std::string_view bytes = cursor_.rest();
    if (bytes.size() / per_point < plot.points)
      fail_at(cursor_.byte() + bytes.size(),
              fmt::format("the file ends within point {} of {}", bytes.size() / per_point + 1, plot.points));
    if (keep) {
      plot.values.assign(n, std::vector<Complex>(plot.points));
      for (std::size_t v = 0; v < n; ++v) {
        for (std::size_t i = 0; i < plot.points; ++i) {
          const std::size_t size = v == 0 ? first : other;
          const std::size_t before = v == 0 ? 0 : first + (v - 1) * other;
          const std::size_t at = plot.by_variable ? before * plot.points + i * size : i * per_point + before;
          plot.values[v][i] = plot.complex ? Complex(number_at(bytes, at), number_at(bytes, at + 8))
                                           : Complex(size == 4 ? float_at(bytes, at) : number_at(bytes, at));
        }
      }
    }
    cursor_.skip(per_point * plot.points);
  }

  /// "index value", then one value a line; a complex value is "re,im".
  void text_values(RawPlot& plot) {
    plot.values.assign(plot.variables.size(), {});
    std::string line;
    std::size_t begin = 0;
    const auto next_filled = [&] {
      do {
        begin = cursor_.byte();
        if (auto got = cursor_.line()) {
          line = *got;
        } else {
          // The last line may lack its end.
          line = std::string(trim(cursor_.rest()));
          if (line.find('\0') != std::string::npos) line.clear();
          cursor_.skip(cursor_.rest().size());
          if (line.empty()) fail_at(begin, "the file ends before its last point");
        }
      } while (line.empty());
    };
    for (std::size_t i = 0; i < plot.points; ++i) {
      for (std::size_t v = 0; v < plot.variables.size(); ++v) {
        next_filled();
        std::string_view value = line;
        if (v == 0) {
          const std::size_t blank = value.find_first_of(" \t");
          if (blank == std::string_view::npos || count(value.substr(0, blank), begin) != i)
            fail_at(begin, fmt::format("'{}' does not begin point {}", value.substr(0, 40), i));
          value = trim(value.substr(blank));
        }
        plot.values[v].push_back(text_value(value, begin));
      }
    }
  }

  Complex text_value(std::string_view value, std::size_t byte) const {
    const std::size_t comma = value.find(',');
    double re = 0.0;
    double im = 0.0;
    if (!parse_number(value.substr(0, comma), re) ||
        (comma != std::string_view::npos && !parse_number(value.substr(comma + 1), im)))
      fail_at(byte, fmt::format("'{}' is not a finite number", value.substr(0, 40)));
    return {re, im};
  }

  const Source& source_;
  RawCursor cursor_;
  bool text_ = false;
};

/// The rows of run `number` (from 1): runs begin where the axis falls back. 0 runs when there is no such one.
struct RawRun {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t runs = 0;
};
RawRun find_run(const std::vector<double>& axis, std::size_t number) {
  RawRun out;
  std::vector<std::size_t> begins{0};
  for (std::size_t i = 1; i < axis.size(); ++i) {
    if (axis[i] < axis[i - 1]) begins.push_back(i);
  }
  out.runs = begins.size();
  if (number <= out.runs) {
    out.begin = begins[number - 1];
    out.end = number < out.runs ? begins[number] : axis.size();
  }
  return out;
}

class SpiceRaw : public Format {
 public:
  std::string_view name() const override { return "SPICE raw file"; }
  bool recognises(const Source& source) const override {
    const std::string_view b = source.bytes;
    const bool narrow = b.starts_with("Title:") && (b.find("\nPlotname:") != std::string_view::npos ||
                                                    b.find("\nDate:") != std::string_view::npos);
    return narrow || begins_as_utf16(b, "Title:") ||
           begins_as_utf16(b.substr(std::min<std::size_t>(2, b.size())), "Title:");
  }

  Foreign read(const Source& source) const override {
    Source chosen = source;
    std::size_t run_number = 1;
    const std::size_t at_sign = chosen.choice.rfind('@');
    if (at_sign != std::string::npos) {
      double number = 0.0;
      if (!parse_number(chosen.choice.substr(at_sign + 1), number) || !(number >= 1.0) || number > 1e6 ||
          number != std::floor(number))
        throw InputError(source.file, 0,
                         fmt::format("'{}' is no run, expected @1, @2, …", chosen.choice.substr(at_sign)));
      run_number = static_cast<std::size_t>(number);
      chosen.choice.resize(at_sign);
    }
    RawPlot plot = RawReader(chosen).read();
    std::vector<double> axis;
    for (const Complex& value : plot.values.front())
      axis.push_back(plot.ltspice ? std::abs(value.real()) : value.real());
    const bool over_time = lower_case(plot.variables.front()) == "time";
    const RawRun run = find_run(axis, run_number);
    if (run.end == 0)
      throw InputError(source.file, 0,
                       fmt::format("holds {} runs, there is no run {}", run.runs, run_number));
    axis = {axis.begin() + static_cast<std::ptrdiff_t>(run.begin),
            axis.begin() + static_cast<std::ptrdiff_t>(run.end)};
    Words words{fmt::format("{} raw file", plot.ltspice ? "LTspice" : "SPICE"), {}};
    if (run.runs > 1)
      words.notes.push_back(fmt::format("run {} of {} (others: @2, …)", run_number, run.runs));
    return over_time ? record_of_plot(chosen, plot, run, std::move(axis), std::move(words))
                     : response_of_plot(chosen, plot, run, std::move(axis), std::move(words));
  }

 private:
  static Foreign record_of_plot(const Source& source, const RawPlot& plot, const RawRun& run,
                                std::vector<double> time, Words words) {
    std::vector<SignalTrace> signals;
    for (std::size_t v = 1; v < plot.variables.size(); ++v) {
      SignalTrace signal{plot.variables[v], {}};
      for (std::size_t i = run.begin; i < run.end; ++i) signal.values.push_back(plot.values[v][i].real());
      signals.push_back(std::move(signal));
    }
    return record_columns(source, std::move(words), std::move(time),
                          choose_signals(source, std::move(signals)), {}, Steps::made_even);
  }
  static Foreign response_of_plot(const Source& source, const RawPlot& plot, const RawRun& run,
                                  std::vector<double> frequency, Words words) {
    std::vector<std::string> names;
    std::vector<std::vector<Complex>> values;
    for (std::size_t v = 1; v < plot.variables.size(); ++v) {
      names.push_back(plot.variables[v]);
      values.emplace_back(plot.values[v].begin() + static_cast<std::ptrdiff_t>(run.begin),
                          plot.values[v].begin() + static_cast<std::ptrdiff_t>(run.end));
    }
    ResponseTrace trace = choose_response(source, names, values);
    words.notes.insert(words.notes.begin(), trace.name);
    return response_columns(source, std::move(words), std::move(frequency), std::move(trace), {});
  }
};

}  // namespace

BODESMITH_ENTRY(Format, spice_raw, SpiceRaw)

}  // namespace bodesmith::formats
