#include "fpaa/network/switched_netlist.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "fpaa/device/mismatch.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr int kLargestClockRatio = 1000;  ///< whole numbers of the clocks' ratios

/// "2.5p"; nothing where it is no number.
std::optional<double> spice_value(const std::string& word) {
  static const std::map<std::string, double> suffixes = {{"", 1.0},   {"f", 1e-15}, {"p", 1e-12},
                                                         {"n", 1e-9}, {"u", 1e-6},  {"m", 1e-3},
                                                         {"k", 1e3},  {"meg", 1e6}, {"g", 1e9}};
  std::size_t digits = word.size();
  while (digits > 0 && is_letter(word[digits - 1])) --digits;
  const auto suffix = suffixes.find(word.substr(digits));
  double value = 0.0;
  if (suffix == suffixes.end() || !parse_number(word.substr(0, digits), value)) return std::nullopt;
  return value * suffix->second;
}

class NetlistReader {
 public:
  explicit NetlistReader(const std::string& file) : file_(file) {}

  SwitchedNetlist read(std::string_view text) {
    nodes_["0"] = nodes_["gnd"] = 0;
    std::istringstream lines{std::string(text)};
    for (std::string line; std::getline(lines, line);) {
      ++number_;
      read_line(lower_case(line.substr(0, line.find(';'))));
      if (ended_) break;
    }
    if (out_.network.inputs.empty()) fail_file("there is no input, expected a line V1 NODE 0");
    if (!output_) fail_file("there is no .output, expected .output NODE");
    if (out_.network.capacitors.empty()) fail_file("there are no capacitors, expected at least one");
    find_clocks();
    add_output();
    double largest = 0.0;
    for (const auto& c : out_.network.capacitors) largest = std::max(largest, c.size);
    for (auto& c : out_.network.capacitors) c.size /= largest;
    out_.unit_f = largest;
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", file_, number_, what));
  }
  [[noreturn]] void fail_file(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", file_, what));
  }

  void read_line(const std::string& line) {
    std::istringstream in(line);
    std::vector<std::string> words;
    for (std::string word; in >> word;) words.push_back(word);
    if (words.empty() || words[0][0] == '*') return;
    const std::string& name = words[0];
    const auto expect = [&](std::size_t count, const char* form) {
      if (words.size() != count)
        fail(fmt::format("'{}' has {} words, expected {}", name, words.size(), form));
    };
    if (name == ".end") {
      ended_ = true;
    } else if (name == ".clock") {
      expect(3, ".clock NAME FREQUENCY");
      if (std::ranges::find(out_.clocks, words[1]) != out_.clocks.end())
        fail(fmt::format("clock {} is there already, expected one line a clock", words[1]));
      out_.clocks.push_back(words[1]);
      out_.frequencies.push_back({value(words[2], "a frequency in Hz")});
    } else if (name == ".output") {
      expect(2, ".output NODE");
      if (output_) fail("there is an .output already, expected one");
      output_ = node(words[1]);
    } else if (name[0] == 'v') {
      expect(3, "V1 NODE 0");
      if (!out_.network.inputs.empty()) fail("there is an input already, expected one");
      if (node(words[1]) == 0 || node(words[2]) != 0) fail("expected the input between a node and 0");
      out_.network.inputs.push_back(node(words[1]));
    } else if (name[0] == 'c') {
      expect(4, "Cname NODE NODE VALUE");
      out_.network.capacitors.push_back({name, node(words[1]), node(words[2]), value(words[3], "farads")});
    } else if (name[0] == 's') {
      expect(4, "Sname NODE NODE CLOCK.PHASE");
      read_switch(words);
    } else if (name[0] == 'o') {
      read_opamp(words);
    } else {
      fail(fmt::format("'{}' is no element, expected C, S, O, V, .clock or .output", name));
    }
  }

  void read_switch(const std::vector<std::string>& words) {
    const std::size_t dot = words[3].rfind('.');
    const std::string clock = words[3].substr(0, dot);
    const auto at = std::ranges::find(out_.clocks, clock);
    const std::string phase = dot == std::string::npos ? "" : words[3].substr(dot + 1);
    if (at == out_.clocks.end() || (phase != "1" && phase != "2"))
      fail(fmt::format("'{}' is no phase of a clock, expected for instance {}.1 after its .clock line",
                       words[3], out_.clocks.empty() ? "main" : out_.clocks[0]));
    out_.network.switches.push_back(
        {node(words[1]), node(words[2]), static_cast<int>(at - out_.clocks.begin()), phase == "1" ? 1 : 2});
  }

  void read_opamp(const std::vector<std::string>& words) {
    constexpr const char* kForm = "Oname PLUS MINUS OUT, or with noise=5n gbw=10meg behind it";
    if (words.size() != 4 && words.size() != 6)
      fail(fmt::format("'{}' has {} words, expected {}", words[0], words.size(), kForm));
    SwitchedNetwork::OpAmp out{.plus = node(words[1]), .minus = node(words[2]), .out = node(words[3])};
    double noise = 0.0;
    for (std::size_t i = 4; i < words.size(); ++i) {
      const std::size_t equals = words[i].find('=');
      const std::string key = words[i].substr(0, equals);
      const std::string given = equals == std::string::npos ? "" : words[i].substr(equals + 1);
      if (key == "noise") {
        noise = value(given, "V/rtHz");
      } else if (key == "gbw") {
        out.gain_bandwidth = {value(given, "Hz")};
      } else {
        fail(fmt::format("'{}' is no figure of an op-amp, expected {}", words[i], kForm));
      }
    }
    if ((noise > 0.0) != (out.gain_bandwidth.value > 0.0)) fail(fmt::format("expected {}", kForm));
    out_.network.opamps.push_back(out);
    out_.opamp_noise_v_per_rthz.push_back(noise);
  }

  double value(const std::string& word, const char* what) const {
    const std::optional<double> out = spice_value(word);
    if (!out || !(*out > 0.0) || !std::isfinite(*out))
      fail(fmt::format("'{}' is no value, expected {} above 0", word, what));
    return *out;
  }

  int node(const std::string& name) {
    const auto [at, fresh] = nodes_.try_emplace(name, out_.network.nodes);
    if (fresh) out_.network.add_node();
    return at->second;
  }

  /// A tick that all half periods are whole numbers of.
  void find_clocks() {
    if (out_.clocks.empty()) fail_file("there is no clock, expected a line .clock NAME FREQUENCY");
    double fastest = 0.0;
    for (const Hertz f : out_.frequencies) fastest = std::max(fastest, f.value);
    for (int scale = 1; scale <= kLargestClockRatio; ++scale) {
      out_.ticks.clear();
      for (const Hertz f : out_.frequencies) {
        const double periods = scale * fastest / f.value;
        if (periods > 1e12 || std::abs(periods - std::round(periods)) > 1e-9 * periods) break;
        out_.ticks.push_back(2 * nearest_whole<std::int64_t>(periods));
      }
      out_.ticks_per_second = 2.0 * scale * fastest;
      if (out_.ticks.size() == out_.clocks.size()) return;
    }
    fail_file("the clocks' frequencies stand in no ratio of whole numbers up to 1000, expected one");
  }

  /// An op-amp's output, or a follower of another node.
  void add_output() {
    SwitchedNetwork& network = out_.network;
    for (std::size_t k = 0; k < network.opamps.size(); ++k) {
      if (network.opamps[k].out == *output_) {
        network.output = static_cast<int>(k);
        return;
      }
    }
    const int out = network.add_node();
    network.opamps.push_back({.plus = *output_, .minus = out, .out = out});
    out_.opamp_noise_v_per_rthz.push_back(0.0);
    network.output = static_cast<int>(network.opamps.size()) - 1;
  }

  const std::string& file_;
  int number_ = 0;
  bool ended_ = false;
  std::map<std::string, int> nodes_;
  std::optional<int> output_;
  SwitchedNetlist out_;
};

}  // namespace

SwitchedNetlist SwitchedNetlist::read(std::string_view text, const std::string& file) {
  return NetlistReader(file).read(text);
}

PeriodicNetworks SwitchedNetlist::networks(std::optional<double> temperature_k) const {
  using Source = PeriodicNetworks::Source;
  SwitchedNetwork noisy = network;
  for (std::size_t k = 0; temperature_k && k < noisy.opamps.size(); ++k)
    noisy.opamps[k].noise_per_hz = std::pow(opamp_noise_v_per_rthz[k], 2) / thermal_v2(*temperature_k);
  PeriodicNetworks out(ticks_per_second);
  out.set_output(out.add(ClockedNetwork(noisy, ticks, temperature_k.has_value()),
                         {Source{Source::Kind::board_input, 0}}));
  return out;
}

double SwitchedNetlist::thermal_v2(double temperature_k) const {
  return std::pow(NoiseModel{.unit_capacitance_f = unit_f, .temperature_k = temperature_k}.unit_noise_v(), 2);
}

}  // namespace bodesmith::fpaa
