// CITI files of network analysers: "CITIFILE A.01.00", "VAR FREQ MAG 201", "DATA S[2,1] RI" for each parameter, the
// frequencies in Hz as a list (VAR_LIST_BEGIN … VAR_LIST_END) or as segments ("SEG start stop count"), then for each DATA
// its pairs between BEGIN and END. Pairs: RI, MAGANGLE, DBANGLE (degrees). S21 unless FILE:s11 says otherwise.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <complex>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "signal/formats/format.hpp"
#include "signal/formats/number_table.hpp"
#include "signal/formats/traces.hpp"

namespace bodesmith::formats {
namespace {

constexpr std::size_t kMostPoints = 10'000'000;

class CitiReader {
 public:
  explicit CitiReader(const Source& source) : source_(source) {}

  Foreign read() {
    std::string_view text = source_.text;
    while (!text.empty() && packages_ < 2) {
      ++line_;
      const std::string_view line = trim(next_line(text));
      if (!line.empty() && line.front() != '!') take(line);
    }
    finish();
    std::vector<std::string> said{"frequency from Hz"};
    if (packages_ > 1) said.emplace_back("the first of several packages");
    ResponseTrace trace = chosen();
    said.insert(said.begin(), trace.name);
    return response_columns(source_, {"CITI file", said}, std::move(frequency_hz_), std::move(trace), {});
  }

 private:
  enum class Part { head, list, segments, values };
  [[noreturn]] void fail(const std::string& what) const { throw InputError(source_.file, line_, what); }

  void take(std::string_view line) {
    if (part_ == Part::list || part_ == Part::values) {
      const bool ends = line == (part_ == Part::list ? "VAR_LIST_END" : "END");
      if (!ends) return take_numbers(line);
      part_ = Part::head;
      return;
    }
    const std::vector<std::string_view> words = split_cells(line, ' ');
    const std::string_view key = words.front();
    if (key == "CITIFILE") {
      ++packages_;
    } else if (key == "VAR") {
      if (words.size() < 2 || (words[1] != "FREQ" && words[1] != "Freq" && words[1] != "freq"))
        fail(fmt::format("has the variable '{}', expected FREQ alone", words.size() < 2 ? "" : words[1]));
    } else if (key == "DATA") {
      if (words.size() != 3 || (words[2] != "RI" && words[2] != "MAGANGLE" && words[2] != "DBANGLE"))
        fail("expected DATA NAME and RI, MAGANGLE or DBANGLE");
      std::string name;
      for (const char c : words[1]) {
        if (is_letter_or_digit(c)) name += c;
      }
      names_.push_back(name);
      forms_.emplace_back(words[2]);
    } else if (key == "VAR_LIST_BEGIN") {
      part_ = Part::list;
    } else if (key == "SEG_LIST_BEGIN") {
      part_ = Part::segments;
    } else if (key == "SEG_LIST_END") {
      part_ = Part::head;
    } else if (key == "SEG" && part_ == Part::segments) {
      take_segment(words);
    } else if (key == "BEGIN") {
      if (values_.size() == names_.size()) fail("begins values of no DATA line");
      values_.emplace_back();
      part_ = Part::values;
    } else if (key != "NAME" && key != "COMMENT" && key != "CONSTANT" && !key.starts_with('#')) {
      fail(fmt::format("'{}' is not a keyword of a CITI file that is known here", key.substr(0, 40)));
    }
  }

  double number(std::string_view word) const {
    double value = 0.0;
    if (!parse_number(word, value)) fail(fmt::format("'{}' is not a finite number", word.substr(0, 40)));
    return value;
  }

  void take_numbers(std::string_view line) {
    if (part_ == Part::list) {
      frequency_hz_.push_back(number(line));
      return;
    }
    const std::vector<std::string_view> pair = split_cells(line, ',');
    if (pair.size() != 2) fail(fmt::format("has {} numbers, expected 2", pair.size()));
    const double a = number(pair[0]);
    const double b = number(pair[1]);
    const std::string& form = forms_[values_.size() - 1];
    values_.back().push_back(form == "RI"
                                 ? Complex(a, b)
                                 : std::polar(form == "DBANGLE" ? from_decibel(a) : std::abs(a),
                                              to_radians(a < 0.0 && form == "MAGANGLE" ? b + 180.0 : b)));
  }

  void take_segment(const std::vector<std::string_view>& words) {
    std::size_t count = 0;
    if (words.size() == 4) std::from_chars(words[3].data(), words[3].data() + words[3].size(), count);
    if (count == 0 || count > kMostPoints - std::min(kMostPoints, frequency_hz_.size()))
      fail("expected SEG, a start, a stop and a count of frequencies");
    const double from = number(words[1]);
    const double to = number(words[2]);
    for (std::size_t i = 0; i < count; ++i)
      frequency_hz_.push_back(
          count == 1 ? from : from + (to - from) * static_cast<double>(i) / static_cast<double>(count - 1));
  }

  void finish() {
    if (part_ != Part::head) fail("the file ends within a list, expected its END");
    if (names_.empty() || values_.size() != names_.size())
      fail(fmt::format("the file ends with values of {} of {} DATA lines", values_.size(), names_.size()));
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (values_[i].size() != frequency_hz_.size())
        fail(fmt::format("{} has {} values for {} frequencies", names_[i], values_[i].size(),
                         frequency_hz_.size()));
    }
  }

  ResponseTrace chosen() const {
    Source with = source_;
    std::erase_if(with.choice, [](char c) { return c == '[' || c == ']' || c == ','; });
    if (with.choice.empty() && find_name(names_, "S21")) with.choice = "S21";
    return choose_response(with, names_, values_);
  }

  const Source& source_;
  Part part_ = Part::head;
  int line_ = 0;
  int packages_ = 0;
  std::vector<double> frequency_hz_;
  std::vector<std::string> names_;
  std::vector<std::string> forms_;
  std::vector<std::vector<Complex>> values_;
};

class CitiFile : public Format {
 public:
  std::string_view name() const override { return "CITI file"; }
  bool recognises(const Source& source) const override { return source.text.starts_with("CITIFILE "); }
  Foreign read(const Source& source) const override { return CitiReader(source).read(); }
};

}  // namespace

BODESMITH_ENTRY(Format, citi_file, CitiFile)

}  // namespace bodesmith::formats
