#include "signal/formats/traces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "base/whole_number.hpp"
#include "signal/columns.hpp"

namespace bodesmith::formats {
namespace {

[[noreturn]] void fail_at(const Source& source, const std::vector<int>& lines, std::size_t row,
                          const std::string& what) {
  if (lines.empty()) throw InputError(source.file, 0, fmt::format("point {} {}", row + 1, what));
  throw InputError(source.file, lines[row], what);
}

void validate_finite(const Source& source, const std::vector<int>& lines, const std::vector<double>& values,
                     std::string_view what) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) fail_at(source, lines, i, fmt::format("has no finite {}", what));
  }
}

template <class T>
void keep_rows(std::vector<T>& values, const std::vector<bool>& keep) {
  if (values.empty()) return;
  std::size_t to = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (keep[i]) values[to++] = values[i];
  }
  values.resize(to);
}

std::string_view inside_brackets(std::string_view name) {
  if (name.size() > 3 && (name[0] == 'v' || name[0] == 'i') && name[1] == '(' && name.back() == ')')
    return name.substr(2, name.size() - 3);
  return name;
}

std::string folded(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c == ' ' || c == '\t' || c == '"') continue;
    out += lower_case(c);
  }
  return out;
}

/// A signal of rising, uneven times on `count` even ones, by straight lines.
class EvenSignal {
 public:
  EvenSignal(const std::vector<double>& time, const std::vector<double>& value, std::size_t count)
      : time_(time),
        value_(value),
        count_(count),
        step_((time.back() - time.front()) / static_cast<double>(count - 1)) {}

  std::vector<double> samples() const {
    std::vector<double> out(count_);
    std::size_t at = 1;
    for (std::size_t i = 0; i < count_; ++i) {
      const double t = sample_time(i);
      while (at + 1 < time_.size() && time_[at] < t) ++at;
      out[i] = between(at, t);
    }
    return out;
  }

  /// Largest distance of the file's own points from the straight lines between even samples, in parts of the range. Looks
  /// at the samples near these points alone: however many there are, it takes no longer.
  double departure() const {
    const auto [low, high] = std::minmax_element(value_.begin(), value_.end());
    const double range = *high - *low;
    if (!(range > 0.0)) return 0.0;
    double most = 0.0;
    for (std::size_t i = 0; i < time_.size(); ++i) {
      const double place = (time_[i] - time_.front()) / step_;
      const auto k = std::min(whole_number<std::size_t>(place), count_ - 2);
      const double f = place - static_cast<double>(k);
      const double before = sample(k);
      most = std::max(most, std::abs(before + f * (sample(k + 1) - before) - value_[i]));
    }
    return most / range;
  }

 private:
  double sample_time(std::size_t i) const { return time_.front() + step_ * static_cast<double>(i); }
  double sample(std::size_t i) const {
    const double t = sample_time(i);
    const auto at = std::lower_bound(time_.begin() + 1, time_.end() - 1, t) - time_.begin();
    return between(static_cast<std::size_t>(at), t);
  }
  double between(std::size_t at, double t) const {
    const double fraction = std::clamp((t - time_[at - 1]) / (time_[at] - time_[at - 1]), 0.0, 1.0);
    return value_[at - 1] + fraction * (value_[at] - value_[at - 1]);
  }

  const std::vector<double>& time_;
  const std::vector<double>& value_;
  std::size_t count_;
  double step_;
};

bool is_even(const std::vector<double>& time) {
  const double step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (std::abs(time[i] - time[i - 1] - step) > 1e-4 * step) return false;
  }
  return true;
}

/// Simulators write a time twice at a jump, and again where a run went on.
void drop_repeated_times(std::vector<double>& time, std::vector<SignalTrace>& signals) {
  std::vector<bool> keep(time.size(), true);
  for (std::size_t i = 1; i < time.size(); ++i) keep[i] = time[i] != time[i - 1];
  keep_rows(time, keep);
  for (SignalTrace& signal : signals) keep_rows(signal.values, keep);
}

void make_even(const Source& source, Words& words, std::vector<double>& time,
               std::vector<SignalTrace>& signals) {
  drop_repeated_times(time, signals);
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (!(time[i] > time[i - 1]))
      throw InputError(source.file, 0, fmt::format("point {} goes back in time, to {} s", i + 1, time[i]));
  }
  if (time.size() < 2) throw InputError(source.file, 0, "has a single time, expected at least two samples");
  if (is_even(time)) return;
  const std::size_t read = time.size();
  std::size_t count = std::max<std::size_t>(read, 64);
  // However wild the times: a thousand samples a point, half a million, and of many signals no more than 64 MB.
  const std::size_t most = std::min(
      {1024 * read, std::size_t{1} << 19, (std::size_t{1} << 23) / std::max<std::size_t>(signals.size(), 1)});
  double worst = 0.0;
  for (;; count *= 2) {
    worst = 0.0;
    for (const SignalTrace& signal : signals)
      worst = std::max(worst, EvenSignal(time, signal.values, count).departure());
    if (worst < 1e-3 || count >= most) break;
  }
  for (SignalTrace& signal : signals) signal.values = EvenSignal(time, signal.values, count).samples();
  const double step = (time.back() - time.front()) / static_cast<double>(count - 1);
  std::vector<double> at(count);
  for (std::size_t i = 0; i < count; ++i) at[i] = time.front() + step * static_cast<double>(i);
  time = std::move(at);
  words.notes.push_back(fmt::format(
      "{} uneven steps made {} even ones of {} by straight lines, at most {} % of range away from a point of the file",
      read, count, engineering_text(step, "s", 4), rounded_text(100.0 * worst, 2)));
}

std::size_t default_response(const Source& source, const std::vector<std::string>& names) {
  if (names.size() == 1) return 0;
  for (const char* name : {"v(out)", "v(vout)", "v(output)", "vdb(out)"}) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (inside_brackets(folded(names[i])) == inside_brackets(name)) return i;
    }
  }
  throw InputError(
      source.file, 0,
      fmt::format("holds {}: choose one as FILE:NAME or a quotient as FILE:NAME/NAME", join(names, ", ")));
}

}  // namespace

ResponseTrace to_trace(std::string name, const std::vector<Complex>& response) {
  ResponseTrace trace;
  trace.name = std::move(name);
  for (const Complex& h : response) {
    trace.magnitude_db.push_back(to_decibel(std::abs(h)));
    trace.phase_deg.push_back(to_degrees(std::arg(h)));
  }
  return trace;
}

std::string Words::text() const {
  return notes.empty() ? format : format + ": " + join(notes, "; ");
}

Foreign response_columns(const Source& source, Words words, std::vector<double> frequency_hz,
                         ResponseTrace trace, std::vector<int> lines) {
  const std::size_t rows = frequency_hz.size();
  validate_finite(source, lines, frequency_hz, "frequency");
  std::vector<bool> keep(rows, true);
  std::size_t zeros = 0;
  std::size_t silent = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    if (frequency_hz[i] < 0.0)
      fail_at(source, lines, i, fmt::format("has the frequency {} Hz, expected 0 or more", frequency_hz[i]));
    if (frequency_hz[i] == 0.0) {
      keep[i] = false;
      ++zeros;
    } else if (trace.magnitude_db[i] == -INFINITY) {
      keep[i] = false;
      ++silent;
    }
  }
  const std::array<std::vector<double>*, 4> columns = {&frequency_hz, &trace.magnitude_db, &trace.phase_deg,
                                                       &trace.coherence};
  for (auto* column : columns) keep_rows(*column, keep);
  keep_rows(lines, keep);
  if (frequency_hz.empty())
    throw InputError(source.file, 0, "has no point above 0 Hz with a magnitude above 0");
  if (zeros > 0) words.notes.push_back("the point at 0 Hz left out");
  if (silent > 0) words.notes.push_back(fmt::format("{} points of magnitude 0 left out", silent));
  validate_finite(source, lines, trace.magnitude_db, "magnitude");
  validate_finite(source, lines, trace.phase_deg, "phase");
  if (frequency_hz.size() > 1 && std::is_sorted(frequency_hz.rbegin(), frequency_hz.rend())) {
    for (auto* column : columns) std::ranges::reverse(*column);
    std::ranges::reverse(lines);
    words.notes.push_back("falling sweep turned round");
  }
  Foreign out;
  out.names = {std::string(column::frequency_hz), std::string(column::magnitude_db)};
  out.columns = {std::move(frequency_hz), std::move(trace.magnitude_db)};
  if (!trace.phase_deg.empty()) {
    out.names.emplace_back(column::phase_deg);
    out.columns.push_back(std::move(trace.phase_deg));
  }
  if (!trace.coherence.empty()) {
    out.names.emplace_back(column::coherence);
    out.columns.push_back(std::move(trace.coherence));
  }
  out.lines = std::move(lines);
  out.read_as = words.text();
  return out;
}

Foreign record_columns(const Source& source, Words words, std::vector<double> time_s,
                       std::vector<SignalTrace> signals, std::vector<int> lines, Steps steps) {
  validate_finite(source, lines, time_s, "time");
  for (const SignalTrace& signal : signals)
    validate_finite(source, lines, signal.values, "value of " + signal.name);
  if (time_s.empty()) throw InputError(source.file, 0, "has no samples");
  if (steps == Steps::made_even) {
    const std::vector<double> of_lines = time_s;
    make_even(source, words, time_s, signals);
    if (time_s != of_lines) lines.clear();
  }
  Foreign out;
  out.names = {std::string(column::time_s), std::string(column::input)};
  out.columns = {std::move(time_s), std::move(signals[0].values)};
  words.notes.insert(words.notes.begin(), "u is " + signals[0].name);
  if (signals.size() > 1) {
    out.names.emplace_back(column::output);
    out.columns.push_back(std::move(signals[1].values));
    words.notes.front() += ", y is " + signals[1].name;
  }
  out.lines = std::move(lines);
  out.read_as = words.text();
  return out;
}

std::optional<std::size_t> find_name(const std::vector<std::string>& names, std::string_view wanted) {
  const std::string key = folded(wanted);
  const auto only = [&](const auto& fits) {
    std::optional<std::size_t> found;
    std::size_t count = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!fits(folded(names[i]))) continue;
      ++count;
      found = i;
    }
    return std::pair(count, found);
  };
  if (const auto [count, found] = only([&](const std::string& name) { return name == key; }); count > 0)
    return count == 1 ? found : std::nullopt;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name = folded(names[i]);
    if (inside_brackets(name) == key || name == inside_brackets(key)) return i;
  }
  const auto [count, found] =
      only([&](const std::string& name) { return name.find(key) != std::string::npos; });
  return count == 1 ? found : std::nullopt;
}

std::size_t require_name(const Source& source, const std::vector<std::string>& names,
                         std::string_view wanted) {
  if (const auto found = find_name(names, wanted)) return *found;
  throw InputError(source.file, 0, fmt::format("has no single '{}', found: {}", wanted, join(names, ", ")));
}

Choice split_choice(std::string_view choice) {
  int depth = 0;
  for (std::size_t i = 0; i < choice.size(); ++i) {
    if (choice[i] == '(') ++depth;
    if (choice[i] == ')') --depth;
    if (depth == 0 && (choice[i] == '/' || choice[i] == ','))
      return {std::string(trim(choice.substr(0, i))), std::string(trim(choice.substr(i + 1))), choice[i]};
  }
  return {std::string(trim(choice)), "", 0};
}

ResponseTrace choose_response(const Source& source, const std::vector<std::string>& names,
                              const std::vector<std::vector<Complex>>& values) {
  if (names.empty()) throw InputError(source.file, 0, "holds frequencies and nothing else");
  if (source.choice.empty()) {
    const std::size_t i = default_response(source, names);
    return to_trace(names[i], values[i]);
  }
  const Choice choice = split_choice(source.choice);
  if (choice.between == ',')
    throw InputError(
        source.file, 0,
        fmt::format("'{}' names two signals; a response is one, or a quotient a/b", source.choice));
  const std::size_t above = require_name(source, names, choice.first);
  if (choice.between == 0) return to_trace(names[above], values[above]);
  const std::size_t below = require_name(source, names, choice.second);
  std::vector<Complex> quotient = values[above];
  for (std::size_t i = 0; i < quotient.size(); ++i) quotient[i] /= values[below][i];
  return to_trace(names[above] + "/" + names[below], quotient);
}

namespace {

constexpr std::string_view kInputWords[] = {"u",          "in",       "input",     "vin",     "drive",
                                            "excitation", "stimulus", "reference", "command", "eingang"};
constexpr std::string_view kOutputWords[] = {"y",        "out",          "output",      "vout",
                                             "response", "measured",     "measurement", "sensor",
                                             "position", "displacement", "answer",      "ausgang"};

/// What a signal's name says: "Out1", "Input (V)", "V(out)". The word in of "Output in V" is none.
enum class Role { none, input, output };
Role role_of(std::string_view name) {
  Role role = Role::none;
  const std::string small = lower_case(name);
  for (std::size_t at = 0; at < small.size();) {
    std::size_t end = at;
    while (end < small.size() && is_letter(small[end])) ++end;
    const std::string_view word = std::string_view(small).substr(at, end - at);
    const auto is_in = [&](const auto& words) {
      return std::find(std::begin(words), std::end(words), word) != std::end(words);
    };
    if (is_in(kOutputWords)) return Role::output;
    if (is_in(kInputWords)) role = Role::input;
    at = end + 1;
  }
  return role;
}

/// Input and output where the names of just one signal say so each, or of one of two.
std::optional<std::vector<std::size_t>> called_in_and_out(const std::vector<std::string>& names) {
  std::vector<std::size_t> in;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Role role = role_of(names[i]);
    if (role == Role::input) in.push_back(i);
    if (role == Role::output) out.push_back(i);
  }
  if (in.size() == 1 && out.size() == 1) return std::vector{in[0], out[0]};
  if (names.size() != 2) return std::nullopt;
  const bool turned = (in.size() == 1 && in[0] == 1) || (out.size() == 1 && out[0] == 0);
  return turned ? std::vector<std::size_t>{1, 0} : std::vector<std::size_t>{0, 1};
}

}  // namespace

std::vector<std::size_t> choose_signals(const Source& source, const std::vector<std::string>& names) {
  if (names.empty()) throw InputError(source.file, 0, "holds times and nothing else");
  if (!source.choice.empty()) {
    const Choice choice = split_choice(source.choice);
    if (choice.between == '/')
      throw InputError(source.file, 0,
                       fmt::format("'{}' is a quotient; a time record has none", source.choice));
    std::vector<std::size_t> out{require_name(source, names, choice.first)};
    if (choice.between == ',') out.push_back(require_name(source, names, choice.second));
    return out;
  }
  if (names.size() == 1) return {0};
  const auto in = find_name(names, "v(in)");
  const auto vin = in ? in : find_name(names, "v(vin)");
  const auto out = find_name(names, "v(out)");
  const auto vout = out ? out : find_name(names, "v(vout)");
  if (vin && vout && *vin != *vout) return {*vin, *vout};
  if (const auto called = called_in_and_out(names)) return *called;
  throw InputError(
      source.file, 0,
      fmt::format("holds {}: choose input and output as FILE:NAME,NAME (or one signal)", join(names, ", ")));
}

std::vector<SignalTrace> choose_signals(const Source& source, std::vector<SignalTrace> signals) {
  std::vector<std::string> names;
  for (const SignalTrace& signal : signals) names.push_back(signal.name);
  std::vector<SignalTrace> out;
  for (const std::size_t i : choose_signals(source, names)) out.push_back(signals[i]);
  return out;
}

}  // namespace bodesmith::formats
