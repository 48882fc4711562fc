// Touchstone 1 and 2 (IBIS Open Forum): network parameters over frequency. An option line "# GHZ S MA R 50" (unit,
// parameter, pairs as magnitude-angle MA, decibel-angle DB or real-imaginary RI, reference resistance), '!' comments,
// in version 2 keywords in square brackets. A point is a frequency and n*n pairs, the first line of a point has an odd
// count of numbers, continuation lines an even one: so the number of ports follows from the content. Two ports stand as
// 11 21 12 22 unless [Two-Port Data Order] says 12_21; more ports row by row. Version 1 divides Z by R and multiplies Y
// by it (G and H likewise); version 2 does not.
#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "base/whole_number.hpp"
#include "signal/formats/format.hpp"
#include "signal/formats/traces.hpp"

namespace bodesmith::formats {
namespace {

struct TouchstoneOptions {
  double scale = 1e9;
  std::string unit = "GHz";
  char parameter = 'S';
  std::string pairs = "MA";
  double reference_ohm = 50.0;
};

/// False when a word is none of an option line's.
bool parse_options(std::string_view line, TouchstoneOptions& options) {
  const auto words = split_words(line.substr(1));
  bool reference = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string word = upper_case(words[i]);
    if (word == "HZ" || word == "KHZ" || word == "MHZ" || word == "GHZ") {
      options.unit = word == "HZ" ? "Hz" : word == "KHZ" ? "kHz" : word == "MHZ" ? "MHz" : "GHz";
      options.scale = word == "HZ" ? 1.0 : word == "KHZ" ? 1e3 : word == "MHZ" ? 1e6 : 1e9;
    } else if (word.size() == 1 && std::string_view("SYZGH").find(word[0]) != std::string_view::npos) {
      options.parameter = word[0];
    } else if (word == "MA" || word == "DB" || word == "RI") {
      options.pairs = word;
    } else if (word == "R" && !reference) {
      reference = true;
      // Without its number it says nothing of S parameters, which need none.
      if (i + 1 < words.size() && parse_number(words[i + 1], options.reference_ohm)) {
        ++i;
      } else if (options.parameter != 'S') {
        return false;
      }
      // Some programs write an imaginary part of it too.
      double ignored = 0.0;
      if (i + 1 < words.size() && parse_number(words[i + 1], ignored)) ++i;
    } else {
      return false;
    }
  }
  return options.reference_ohm > 0.0;
}

/// At least a parameter, a way of writing pairs and a unit of frequency: nothing else begins so.
bool is_like_options(std::string_view line) {
  int parameters = 0;
  int pairs = 0;
  int units = 0;
  for (const std::string_view given : split_words(line.substr(1))) {
    const std::string word = upper_case(given);
    parameters += word.size() == 1 && std::string_view("SYZGH").find(word[0]) != std::string_view::npos;
    pairs += word == "MA" || word == "DB" || word == "RI";
    units += word.ends_with("HZ");
  }
  return parameters == 1 && pairs == 1 && units == 1;
}

struct Network {
  TouchstoneOptions options;
  bool version2 = false;
  bool order_12_21 = false;
  std::size_t ports = 0;  ///< 0: from the content
  std::string matrix = "FULL";
  std::size_t announced = 0;  ///< frequencies; 0: not said
  double frequency_before = -1.0;
  std::vector<double> frequency_hz;
  std::vector<std::vector<double>> numbers;  ///< of each point, without its frequency
  std::vector<int> lines;
  bool noise_left_out = false;
};

std::size_t numbers_per_point(const Network& network) {
  const std::size_t n = network.ports;
  return network.matrix == "FULL" ? 2 * n * n : n * (n + 1);
}

class TouchstoneReader {
 public:
  explicit TouchstoneReader(const Source& source) : source_(source) {}

  Network read() {
    std::string_view text = source_.text;
    while (!text.empty() && !done_) {
      ++line_;
      const std::string_view whole = next_line(text), line = trim(whole.substr(0, whole.find('!')));
      if (!line.empty()) take(line);
    }
    finish();
    return std::move(network_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(source_.file, line_, what); }

  void take(std::string_view line) {
    if (line.front() == '#') {
      if (seen_options_) return;  // only the first counts
      seen_options_ = true;
      if (!parse_options(line, network_.options))
        fail(fmt::format("'{}' is not a Touchstone option line such as # GHZ S MA R 50", line.substr(0, 60)));
    } else if (line.front() == '[') {
      keyword(line);
    } else if (in_information_) {
      return;
    } else {
      data(line);
    }
  }

  void keyword(std::string_view line) {
    const std::size_t close = line.find(']');
    if (close == std::string_view::npos) fail("has a '[' without ']'");
    const std::string key = upper_case(trim(line.substr(1, close - 1)));
    const std::string value = upper_case(trim(line.substr(close + 1)));
    const auto count = [&] {
      std::size_t out = 0;
      const auto result = std::from_chars(value.data(), value.data() + value.size(), out);
      if (result.ec != std::errc() || out == 0 || out > 1'000'000'000)
        fail(fmt::format("[{}] is '{}', expected a whole number above 0", key, value));
      return out;
    };
    if (key == "VERSION") {
      if (!value.starts_with("2."))
        fail(fmt::format("is Touchstone version '{}', expected 2.0 or 2.1", value));
      network_.version2 = true;
    } else if (key == "NUMBER OF PORTS") {
      network_.ports = count();
      if (network_.ports > 99) fail(fmt::format("has {} ports, expected at most 99", network_.ports));
    } else if (key == "NUMBER OF FREQUENCIES") {
      network_.announced = count();
    } else if (key == "TWO-PORT DATA ORDER" || key == "TWO-PORT ORDER") {
      if (value != "12_21" && value != "21_12")
        fail(fmt::format("has the order '{}', expected 12_21 or 21_12", value));
      network_.order_12_21 = value == "12_21";
    } else if (key == "MATRIX FORMAT") {
      if (value != "FULL" && value != "LOWER" && value != "UPPER")
        fail(fmt::format("has the matrix format '{}', expected full, lower or upper", value));
      network_.matrix = value;
    } else if (key == "MIXED-MODE ORDER") {
      fail("has mixed-mode parameters, expected single-ended ones");
    } else if (key == "REFERENCE") {
      in_reference_ = true;
      for (const std::string_view word : split_words(value)) check_reference(word);
    } else if (key == "BEGIN INFORMATION") {
      in_information_ = true;
    } else if (key == "END INFORMATION") {
      in_information_ = false;
    } else if (key == "NETWORK DATA") {
      in_reference_ = false;
    } else if (key == "NOISE DATA") {
      network_.noise_left_out = true;
      done_ = true;
    } else if (key == "END") {
      ended_ = true;
      done_ = true;
    }  // others change nothing here
  }

  void check_reference(std::string_view word) {
    double ohm = 0.0;
    if (!parse_number(word, ohm)) fail(fmt::format("'{}' is not a reference resistance", word.substr(0, 40)));
  }

  void data(std::string_view line) {
    if (in_reference_) {
      for (const std::string_view word : split_words(line)) check_reference(word);
      return;
    }
    row_.clear();
    for (const std::string_view word : split_words(line)) {
      double value = 0.0;
      if (!parse_number(word, value)) fail(fmt::format("'{}' is not a finite number", word.substr(0, 40)));
      row_.push_back(value);
    }
    if (!seen_options_) fail("has numbers before the option line, expected one such as # GHZ S MA R 50");
    const bool new_point = network_.ports > 0 ? open_ == 0 : row_.size() % 2 == 1;
    if (!new_point) {
      if (network_.numbers.empty()) fail("has an even count of numbers, expected a frequency and pairs");
      append(row_, 0);
      return;
    }
    // Version 1: noise parameters of a two-port follow where the frequency falls back.
    if (!network_.version2 && network_.frequency_before >= 0.0 && row_.size() == 5 &&
        row_[0] * network_.options.scale <= network_.frequency_before) {
      network_.noise_left_out = true;
      done_ = true;
      return;
    }
    if (row_.size() % 2 == 0)
      fail(fmt::format("has {} numbers, expected a frequency and pairs", row_.size()));
    close_point();
    const double hz = row_[0] * network_.options.scale;
    if (!(hz >= 0.0)) fail(fmt::format("has the frequency {} {}", row_[0], network_.options.unit));
    if (!(hz > network_.frequency_before)) fail("has a frequency that does not rise");
    network_.frequency_before = hz;
    network_.frequency_hz.push_back(hz);
    network_.lines.push_back(line_);
    network_.numbers.emplace_back();
    append(row_, 1);
  }

  void append(const std::vector<double>& row, std::size_t from) {
    auto& point = network_.numbers.back();
    point.insert(point.end(), row.begin() + static_cast<std::ptrdiff_t>(from), row.end());
    if (point.size() > 2 * 99 * 99) fail("belongs to a point of more than 99 ports");
    if (network_.ports == 0) return;
    if (point.size() > numbers_per_point(network_))
      fail(fmt::format("ends with {} numbers of a point, expected {} for {} ports", point.size(),
                       numbers_per_point(network_), network_.ports));
    open_ = numbers_per_point(network_) - point.size();
  }

  /// A point is finished where the next one begins: it has as many numbers as the first one.
  void close_point() {
    if (network_.numbers.empty()) return;
    const std::size_t got = network_.numbers.back().size();
    if (network_.ports == 0) {
      const auto n = nearest_whole<std::size_t>(std::sqrt(static_cast<double>(got) / 2.0));
      if (n == 0 || 2 * n * n != got)
        throw InputError(
            source_.file, network_.lines.back(),
            fmt::format("begins a point of {} numbers, expected 2, 8, 18, … for 1, 2, 3, … ports", got));
      network_.ports = n;
    }
    if (got != numbers_per_point(network_))
      throw InputError(source_.file, network_.lines.back(),
                       fmt::format("begins a point of {} numbers, expected {} for {} ports", got,
                                   numbers_per_point(network_), network_.ports));
    open_ = 0;
  }

  void finish() {
    close_point();
    if (network_.numbers.empty()) throw InputError(source_.file, 0, "has no network data");
    if (network_.announced > 0 && network_.announced != network_.numbers.size())
      throw InputError(source_.file, line_,
                       fmt::format("ends after {} points, expected {} as [Number of Frequencies] says",
                                   network_.numbers.size(), network_.announced));
    if (network_.version2 && !ended_ && !network_.noise_left_out)
      throw InputError(source_.file, line_, "ends without [End]");
  }

  const Source& source_;
  Network network_;
  int line_ = 0;
  std::size_t open_ = 0;  ///< numbers that the current point still lacks
  std::vector<double> row_;
  bool seen_options_ = false;
  bool in_information_ = false;
  bool in_reference_ = false;
  bool ended_ = false;
  bool done_ = false;
};

struct Parameter {
  std::size_t row = 0;
  std::size_t column = 0;
};

Parameter chosen_parameter(const Source& source, const Network& network) {
  const std::size_t n = network.ports;
  if (source.choice.empty()) return n == 1 ? Parameter{0, 0} : Parameter{1, 0};
  const std::string word = upper_case(source.choice);
  const std::string digits = word.substr(1);
  const std::size_t comma = digits.find_first_of(",_");
  std::size_t i = 0;
  std::size_t j = 0;
  const auto number = [](std::string_view text, std::size_t& out) {
    const auto result = std::from_chars(text.data(), text.data() + text.size(), out);
    return !text.empty() && result.ec == std::errc() && result.ptr == text.data() + text.size();
  };
  const bool parsed =
      comma == std::string::npos
          ? digits.size() == 2 && number(digits.substr(0, 1), i) && number(digits.substr(1), j)
          : number(digits.substr(0, comma), i) && number(digits.substr(comma + 1), j);
  if (!parsed || word[0] != network.options.parameter || i < 1 || j < 1 || i > n || j > n)
    throw InputError(source.file, 0,
                     fmt::format("has no '{}', it holds {}11 to {}{}{}", source.choice,
                                 network.options.parameter, network.options.parameter, n, n));
  return {i - 1, j - 1};
}

/// Place of a parameter among the pairs of a point.
std::size_t pair_place(const Network& network, Parameter p) {
  const std::size_t n = network.ports;
  if (network.matrix == "LOWER") {
    if (p.column > p.row) std::swap(p.row, p.column);
    return p.row * (p.row + 1) / 2 + p.column;
  }
  if (network.matrix == "UPPER") {
    if (p.column < p.row) std::swap(p.row, p.column);
    return p.row * n - p.row * (p.row + 1) / 2 + p.column;
  }
  if (n == 2 && !network.order_12_21) return p.column * 2 + p.row;
  return p.row * n + p.column;
}

/// What a version 1 file divided by or multiplied with its reference resistance.
double unit_scale(const Network& network, Parameter p) {
  const double r = network.options.reference_ohm;
  if (network.version2) return 1.0;
  switch (network.options.parameter) {
    case 'Z':
      return r;
    case 'Y':
      return 1.0 / r;
    case 'H':
      return p.row != p.column ? 1.0 : p.row == 0 ? r : 1.0 / r;
    case 'G':
      return p.row != p.column ? 1.0 : p.row == 0 ? 1.0 / r : r;
    default:
      return 1.0;
  }
}

ResponseTrace parameter_trace(const Network& network, Parameter p) {
  const std::size_t place = 2 * pair_place(network, p);
  const double scale = unit_scale(network, p);
  ResponseTrace trace;
  trace.name = fmt::format("{}{}{}", network.options.parameter, p.row + 1, p.column + 1);
  for (const std::vector<double>& point : network.numbers) {
    const double a = point[place];
    const double b = point[place + 1];
    if (network.options.pairs == "RI") {
      trace.magnitude_db.push_back(to_decibel(scale * std::hypot(a, b)));
      trace.phase_deg.push_back(to_degrees(std::atan2(b, a)));
    } else {
      // A magnitude below 0 is one above 0 turned by half a turn.
      trace.magnitude_db.push_back(network.options.pairs == "DB" ? a + to_decibel(scale)
                                                                 : to_decibel(scale * std::abs(a)));
      trace.phase_deg.push_back(network.options.pairs == "MA" && a < 0.0 ? b + 180.0 : b);
    }
  }
  return trace;
}

class Touchstone : public Format {
 public:
  std::string_view name() const override { return "Touchstone"; }

  bool recognises(const Source& source) const override {
    std::string_view text = source.text;
    bool options = false;
    for (int line_number = 0; line_number < 200 && !text.empty(); ++line_number) {
      const std::string_view whole = next_line(text), line = trim(whole.substr(0, whole.find('!')));
      if (line.empty()) continue;
      if (upper_case(line.substr(0, 9)) == "[VERSION]") return true;
      if (line.front() == '#') {
        TouchstoneOptions ignored;
        if (options || (!parse_options(line, ignored) && !is_like_options(line))) return false;
        options = true;
        continue;
      }
      double value = 0.0;
      const auto words = split_words(line);
      return options && words.size() >= 3 && words.size() % 2 == 1 && parse_number(words[0], value);
    }
    return false;
  }

  Foreign read(const Source& source) const override {
    Network network = TouchstoneReader(source).read();
    const Parameter p = chosen_parameter(source, network);
    ResponseTrace trace = parameter_trace(network, p);
    const std::string pairs = network.options.pairs == "MA"   ? "magnitude and angle"
                              : network.options.pairs == "DB" ? "dB and angle"
                                                              : "real and imaginary part";
    Words words{fmt::format("Touchstone {}", network.version2 ? 2 : 1),
                {fmt::format("{} of {} port{}", trace.name, network.ports, network.ports == 1 ? "" : "s"),
                 pairs, "frequency from " + network.options.unit}};
    if (network.options.parameter != 'S') {
      words.notes.push_back(network.version2 ? std::string("not normalised")
                                             : fmt::format("normalised to {} ohm, undone",
                                                           rounded_text(network.options.reference_ohm)));
    }
    if (network.noise_left_out) words.notes.emplace_back("noise parameters left out");
    return response_columns(source, std::move(words), std::move(network.frequency_hz), std::move(trace),
                            std::move(network.lines));
  }
};

}  // namespace

BODESMITH_ENTRY(Format, touchstone, Touchstone)

}  // namespace bodesmith::formats
