// SPICE back to netlists: a line is an element, its first letter and its last word say which.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "base/error.hpp"
#include "base/text.hpp"
#include "schematic/elements/element.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::schematic {
namespace {

using Words = std::vector<std::string>;

Words words_of(std::string_view line) {
  Words out;
  for (const std::string_view word : split(line, ' ')) {
    if (!trim(word).empty()) out.emplace_back(trim(word));
  }
  return out;
}

/// Data sheets' figures are short: what a product with twelve digits has left of them.
double short_number(double value) {
  double out = value;
  parse_number(fmt::format("{:.10g}", value), out);
  return out;
}

class Reader {
 public:
  Reader(const std::string& text, const std::string& file) : file_(file) {
    for (const std::string_view raw : split(text, '\n')) lines_.emplace_back(trim(raw));
  }

  SpiceLibrary read() {
    head();
    while (at_ < lines_.size()) block();
    if (out_.subcircuits.empty()) throw InputError(file_ + ": has no subcircuit, expected .subckt NAME PINS");
    for (Subcircuit& one : out_.subcircuits) {
      one.netlist.opamp = models_.opamp;
      one.netlist.fast_opamp = models_.fast_opamp;
      one.netlist.multiplier = models_.multiplier;
      one.netlist.analog_switch = models_.analog_switch;
      one.netlist.diode = models_.diode;
    }
    if (out_.top.empty()) out_.top = out_.subcircuits.back().name;
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file_, static_cast<int>(at_ + 1), what);
  }
  double number(const std::string& word) const {
    double out = 0.0;
    if (!parse_number(word, out)) fail(fmt::format("'{}' is no number", word));
    return out;
  }

  /// Comments up to the first line that holds nothing but a star.
  void head() {
    for (; at_ < lines_.size() && lines_[at_].starts_with("* "); ++at_) {
      const std::string line = lines_[at_].substr(2);
      std::smatch found;
      static const std::regex kWritten("Written by (.*)\\. Top: \\.subckt (\\S+) .*");
      if (out_.title.empty()) {
        out_.title = line;
      } else if (out_.written_by.empty() && std::regex_match(line, found, kWritten)) {
        out_.written_by = found[1];
        out_.top = found[2];
      } else {
        out_.notes.push_back(line);
      }
    }
  }

  /// A subcircuit or a model, with the comments above it.
  void block() {
    Words comments;
    for (; at_ < lines_.size(); ++at_) {
      const std::string& line = lines_[at_];
      if (line == "*") {
        comments.clear();
      } else if (line.starts_with("* ")) {
        comments.push_back(line.substr(2));
      } else if (!line.empty()) {
        break;
      }
    }
    if (at_ >= lines_.size()) return;
    const Words words = words_of(lines_[at_]);
    if (words[0] == ".model") return model(words);
    if (words[0] != ".subckt" || words.size() < 2) fail("expected .subckt, .model or a comment");
    if (words[1].starts_with("bodesmith_")) return model_subcircuit(words[1], comments);
    Subcircuit one;
    one.name = words[1];
    one.pins.assign(words.begin() + 2, words.end());
    one.comments = comments;
    one.netlist.groups = {{"", Purpose::stage}};
    groups_seen_ = 0;
    for (++at_; at_ < lines_.size() && !lines_[at_].starts_with(".ends"); ++at_) element(one.netlist);
    if (at_ == lines_.size()) fail(".subckt is not ended, expected .ends");
    ++at_;
    out_.subcircuits.push_back(std::move(one));
  }

  void element(Netlist& into) {
    const std::string& line = lines_[at_];
    if (line.empty()) return;
    if (line.starts_with("* ")) {
      into.groups.push_back({line.substr(2), Purpose::stage});
      return;
    }
    const Words w = words_of(line);
    const std::size_t group = place(w, into);
    const auto expect = [&](std::size_t count) {
      if (w.size() != count) fail(fmt::format("has {} words, expected {}", w.size(), count));
    };
    switch (line[0]) {
      case 'R':
      case 'C':
        expect(4);
        into.parts.push_back({line[0] == 'R' ? Part::Kind::resistor : Part::Kind::capacitor, w[0], "", group,
                              w[1], w[2], "exact", number(w[3]), number(w[3])});
        return;
      case 'D':
        expect(4);
        into.parts.push_back({Part::Kind::diode, w[0], "", group, w[1], w[2], "", 0.0, 0.0});
        return;
      case 'V':
        expect(4);
        if (w[2] != "0") fail("a source stands between two nodes, expected one to ground");
        into.sources.push_back({w[0], "", w[1], number(w[3]), group});
        return;
      case 'E':
        return level(line, w, group, into);
      case 'X':
        return instance(w, group, into);
      default:
        fail(fmt::format("'{}' is no element of these netlists, expected R, C, D, V, E or X", w[0]));
    }
  }

  /// Within a group elements stand in a fixed order, as they are printed; one that comes too late begins another group.
  std::size_t place(const Words& w, Netlist& into) {
    int rank = w[0][0] == 'V' ? 0 : w[0][0] == 'E' ? 4 : 1;
    if (w[0][0] == 'E' && w.size() > 4 && w[4].find("tanh") == std::string::npos) rank = 5;
    if (w[0][0] == 'X') {
      const std::string& of = w.back();
      rank = of == "bodesmith_multiplier" ? 2 : of == "bodesmith_switch" ? 6 : of.ends_with("_opamp") ? 3 : 7;
    }
    if (into.groups.size() != groups_seen_) rank_ = 0;
    if (rank < rank_) into.groups.push_back({"", Purpose::stage});
    groups_seen_ = into.groups.size();
    rank_ = rank;
    return groups_seen_ - 1;
  }

  void instance(const Words& w, std::size_t group, Netlist& into) {
    if (w.size() < 3) fail("expected X NAME NODES SUBCIRCUIT");
    const std::string name = w[0].substr(1), &of = w.back();
    if (of == "bodesmith_opamp" || of == "bodesmith_fast_opamp") {
      if (w.size() != 5) fail("an op-amp has three pins");
      into.opamps.push_back({name, "", group, w[1], w[2], w[3], of == "bodesmith_fast_opamp"});
    } else if (of == "bodesmith_multiplier") {
      if (w.size() != 6) fail("a multiplier has four pins");
      into.multipliers.push_back({name, "", group, w[1], w[2], w[3], w[4], 0.0});
    } else if (of == "bodesmith_switch") {
      if (w.size() != 5) fail("a contact has three pins");
      into.contacts.push_back({name, group, w[1], w[2], w[3], static_cast<int>(into.contacts.size())});
    } else {
      into.instances.push_back({name, group, {w.begin() + 1, w.end() - 1}, of});
    }
  }

  /// `Ename name 0 VALUE={ 0.5+0.5*tanh(…) }` or a product of levels.
  void level(const std::string& line, const Words& w, std::size_t group, Netlist& into) {
    static const std::regex kValue(R"(E(\S+) (\S+) 0 VALUE=\{ (.*) \})");
    static const std::regex kTanh(
        R"(0\.5\+0\.5\*tanh\((?:([-+.\deE]+)\*)?(?:v\((\S+?)\)|\(v\((\S+?)\)-([-+.\deE]+)\))\))");
    std::smatch value, tanh;
    if (w.size() < 4 || !std::regex_match(line, value, kValue) || value[1] != value[2])
      fail("expected Ename name 0 VALUE={ … }");
    const std::string expression = value[3];
    if (std::regex_match(expression, tanh, kTanh)) {
      Comparator one{group, tanh[2].matched ? tanh[2] : tanh[3], value[1]};
      if (tanh[1].matched) one.gain = number(tanh[1]);
      if (tanh[4].matched) one.threshold_v = number(tanh[4]);
      into.comparators.push_back(one);
      return;
    }
    Gate gate{group, value[1], {}, {}, expression == "0"};
    if (expression != "0" && expression != "1") {
      static const std::regex kHigh(R"(v\((\S+)\))"), kLow(R"(\(1-v\((\S+)\)\))");
      for (const std::string_view factor : split(expression, '*')) {
        const std::string text(factor);
        std::smatch level;
        if (std::regex_match(text, level, kLow)) {
          gate.low.push_back(level[1]);
        } else if (std::regex_match(text, level, kHigh)) {
          gate.high.push_back(level[1]);
        } else {
          fail(fmt::format("'{}' is no level of a node", text));
        }
      }
    }
    into.gates.push_back(std::move(gate));
  }

  void model(const Words& words) {
    static const std::regex kDiode(
        R"(\.model bodesmith_diode D\(IS=(\S+) N=(\S+) RS=(\S+) CJO=(\S+) TT=(\S+)\))");
    std::smatch found;
    if (std::regex_match(lines_[at_], found, kDiode)) {
      models_.diode = {number(found[1]), number(found[2]), number(found[3]), number(found[4]),
                       number(found[5])};
    } else if (words.size() < 2 || words[1] != "bodesmith_flicker") {
      fail("is a model of another program's, expected bodesmith_diode");
    }
    ++at_;
  }

  /// What its comments and lines say, checked by printing it again.
  void model_subcircuit(const std::string& name, const Words& comments) {
    Words body;
    const std::size_t begin = at_;
    for (; at_ < lines_.size() && !lines_[at_].starts_with(".ends"); ++at_) body.push_back(lines_[at_]);
    if (at_ == lines_.size()) fail(".subckt is not ended, expected .ends");
    const std::string text = join(comments, " ");
    std::string again;
    if (name == "bodesmith_opamp" || name == "bodesmith_fast_opamp") {
      OpAmpModel& to = name == "bodesmith_opamp" ? models_.opamp : models_.fast_opamp;
      to = opamp_from(text, body);
      again = opamp_subcircuit(to, name);
    } else if (name == "bodesmith_switch") {
      models_.analog_switch = switch_from(text, body);
      again = switch_subcircuit(models_.analog_switch);
    } else {
      std::smatch found;
      static const std::regex kMultiplier(
          R"((.*): W = X Y/U \+ Z, U = (\S+) V, (\S+) Hz, output limited to (\S+) V)");
      if (name != "bodesmith_multiplier" || !std::regex_match(text, found, kMultiplier))
        fail("is a model that nothing is known of, expected one as this program writes it");
      models_.multiplier.name = found[1];
      models_.multiplier.scale_v = number(found[2]);
      models_.multiplier.bandwidth = Hertz{number(found[3])};
      models_.multiplier.greatest_output_v = number(found[4]);
      again = multiplier_subcircuit(models_.multiplier, name);
    }
    Words printed;
    for (const std::string_view line : split(again, '\n')) {
      const std::string_view rest = trim(line);
      if (!rest.empty() && !rest.starts_with('*') && !rest.starts_with(".model")) printed.emplace_back(rest);
    }
    if (!printed.empty()) printed.pop_back();  // .ends
    std::erase_if(body, [](const std::string& line) { return line.empty(); });
    if (printed != body) {
      at_ = begin;
      fail(fmt::format("{} is not as this program writes it with the figures in its comments", name));
    }
    ++at_;
  }

  double figure(const std::string& text, const char* pattern) const {
    std::smatch found;
    if (!std::regex_search(text, found, std::regex(pattern))) return 0.0;
    return number(found[1]);
  }
  static std::string line_with(const Words& body, const std::string& begin) {
    const auto at = std::find_if(body.begin(), body.end(),
                                 [&](const std::string& line) { return line.starts_with(begin); });
    return at == body.end() ? std::string() : *at;
  }

  OpAmpModel opamp_from(const std::string& text, const Words& body) const {
    std::smatch found;
    static const std::regex kName(
        "Op-amp (.*): gain-bandwidth (\\S+) Hz, DC gain (\\S+), slew rate (\\S+) V/s, "
        "output (\\S+) V either side of ground behind (\\S+) ohm.*");
    if (text.starts_with("Ideal op-amp")) return OpAmpModel::ideal();
    if (!std::regex_match(text, found, kName)) fail("an op-amp's figures are missing above it");
    OpAmpModel out;
    out.name = found[1];
    out.gain_bandwidth = Hertz{number(found[2])};
    out.dc_gain = number(found[3]);
    out.slew_v_per_s = number(found[4]);
    out.swing_v = number(found[5]);
    out.output_resistance_ohm = number(found[6]);
    out.voltage_noise_v_per_rthz = figure(text, "Voltage noise (\\S+) V");
    out.voltage_noise_corner_hz = figure(text, "Below (\\S+) Hz it rises");
    const double siemens = figure(line_with(body, "Gp "), "VALUE=\\{ (\\S+)\\*v");
    out.current_noise_a_per_rthz = short_number(siemens * std::sqrt(4.0 * kBoltzmann * kKelvin * 1e3));
    return out;
  }

  SwitchModel switch_from(const std::string& text, const Words& body) const {
    SwitchModel out;
    const Words rt = words_of(line_with(body, "Ct ")), cg = words_of(line_with(body, "Cg ")),
                ca = words_of(line_with(body, "Ca ")), co = words_of(line_with(body, "Co "));
    const std::string gs = line_with(body, "Gs ");
    if (rt.size() != 4 || cg.size() != 4 || ca.size() != 4 || co.size() != 4) fail("is no switch of ours");
    const double tau = 1000.0 * number(rt[3]), level = figure(gs, "v\\(t\\)-([-+.\\deE]+)\\)");
    out.charge_c = figure(text, "injected charge (\\S+) C");
    out.off_siemens = figure(gs, "\\*\\(([-+.\\deE]+?)\\+");
    out.on_ohm = short_number(1.0 / figure(gs, "\\+([-+.\\deE]+?)\\*max"));
    out.on_delay_s = short_number(-tau * std::log(1.0 - level));
    out.gap_s = short_number(out.on_delay_s - short_number(-tau * std::log(level)));
    out.source_f = number(ca[3]);
    out.drain_f = short_number(number(co[3]) + number(cg[3]));
    return out;
  }

  std::string file_;
  Words lines_;
  std::size_t at_ = 0;
  SpiceLibrary out_;
  Netlist models_;
  int rank_ = 0;  ///< of the last element in its group
  std::size_t groups_seen_ = 0;
};

}  // namespace

SpiceLibrary read_spice(const std::string& text, const std::string& file) {
  return Reader(text, file).read();
}

}  // namespace bodesmith::schematic
