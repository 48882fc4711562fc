// Hantek oscilloscopes. The DSO-6000 series: "#CHANNEL:CH1", "#CLOCK=20.0uS" (the step), "#SIZE=…", "#UNITS:V", one value
// a line, the next channel below the first. The DSO-5000 series: "#timebase=2000000(ns)", ",#voltbase=1000000(mv/100)",
// "#size=…", then time and value; which of V and mV the value is its firmware does not say.
#include <fmt/format.h>

#include "base/error.hpp"
#include "base/text.hpp"
#include "signal/formats/format.hpp"
#include "signal/formats/headings.hpp"
#include "signal/formats/number_table.hpp"
#include "signal/formats/traces.hpp"

namespace bodesmith::formats {
namespace {

class HantekReader {
 public:
  explicit HantekReader(const Source& source) : source_(source) {}

  Foreign read() {
    for (const std::string_view whole : split(source_.text, '\n')) {
      ++line_;
      const std::string_view line = trim(whole);
      if (line.empty()) continue;
      if (line.starts_with('#') || line.starts_with(",#")) {
        take_key(line.substr(line.find('#') + 1));
      } else {
        take_numbers(line);
      }
    }
    finish();
    Words words{"Hantek oscilloscope text", {}};
    if (time_.empty()) {
      for (std::size_t i = 0; i < lines_.size(); ++i) time_.push_back(step_s_ * static_cast<double>(i));
      words.notes.push_back(fmt::format("steps of {}", engineering_text(step_s_, "s", 6)));
    } else {
      words.notes.emplace_back("values as they stand, V or mV by the scope's firmware");
    }
    return record_columns(source_, std::move(words), std::move(time_),
                          choose_signals(source_, std::move(signals_)), std::move(lines_),
                          Steps::as_they_are);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(source_.file, line_, what); }

  void take_key(std::string_view line) {
    const std::size_t end = line.find_first_of("=:");
    const std::string key = lower_case(trim(line.substr(0, end)));
    std::string value(end == std::string_view::npos ? "" : trim(line.substr(end + 1)));
    if (key == "channel") {
      signals_.push_back({value, {}});
      scale_ = 1.0;
    } else if (key == "clock") {
      if (!value.empty() && value.back() == 'S') value.back() = 's';
      double step = 0.0;
      if (!parse_quantity(value, step) || !(step > 0.0)) fail(fmt::format("'{}' is not a time step", value));
      if (step_s_ > 0.0 && step != step_s_) fail("has another time step than the channel above");
      step_s_ = step;
    } else if (key == "units") {
      scale_ = parse_heading("x (" + value + ")").scale;
    } else if (key == "threshold") {
      fail("is the logic analyser's threshold, expected an analogue channel");
    }
  }

  void take_numbers(std::string_view line) {
    std::vector<double> numbers;
    for (const std::string_view cell : formats::split_cells(line, ',')) {
      double value = 0.0;
      if (cell.empty()) continue;
      if (!parse_number(cell, value)) fail(fmt::format("'{}' is not a finite number", cell.substr(0, 40)));
      numbers.push_back(value);
    }
    const bool times = signals_.empty() || !time_.empty();
    if (numbers.size() != (times ? 2 : 1))
      fail(fmt::format("has {} numbers, expected {}", numbers.size(), times ? 2 : 1));
    if (signals_.empty()) signals_.push_back({"the channel", {}});
    if (times) time_.push_back(numbers.front());
    signals_.back().values.push_back(scale_ * numbers.back());
    if (signals_.size() == 1) lines_.push_back(line_);
  }

  void finish() const {
    for (const SignalTrace& signal : signals_) {
      if (signal.values.size() != lines_.size())
        throw InputError(source_.file, 0,
                         fmt::format("has {} values of {}, expected {} as of {}", signal.values.size(),
                                     signal.name, lines_.size(), signals_.front().name));
    }
    if (time_.empty() && step_s_ == 0.0)
      throw InputError(source_.file, 0, "has no #CLOCK, the step between samples");
  }

  const Source& source_;
  int line_ = 0;
  double step_s_ = 0.0;
  double scale_ = 1.0;
  std::vector<double> time_;
  std::vector<SignalTrace> signals_;
  std::vector<int> lines_;
};

class HantekText : public Format {
 public:
  std::string_view name() const override { return "Hantek oscilloscope text"; }
  bool recognises(const Source& source) const override {
    std::string_view head = source.text.substr(0, 100);
    if (head.starts_with("# ")) head.remove_prefix(1);
    return head.starts_with("#CHANNEL:") || head.starts_with(" CHANNEL:") || head.starts_with("#timebase=");
  }
  Foreign read(const Source& source) const override { return HantekReader(source).read(); }
};

}  // namespace

BODESMITH_ENTRY(Format, hantek_text, HantekText)

}  // namespace bodesmith::formats
