// SPICE to netlists: a line is an element, its first letter and its last word say which.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <regex>
#include <utility>

#include "base/constants.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "schematic/elements/element.hpp"
#include "schematic/opamp_library.hpp"
#include "schematic/plain_number.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::schematic {
namespace {

using Words = std::vector<std::string>;

/// Data sheets' figures are short: what a product with twelve digits has left of them.
double short_number(double value) {
  double out = value;
  parse_number(fmt::format("{:.10g}", value), out);
  return out;
}

class Reader {
 public:
  Reader(const std::string& text, const std::string& file) : file_(file) {
    int number = 0;
    for (const std::string_view raw : split(text, '\n')) {
      ++number;
      const std::string line(trim(raw.starts_with('*') ? raw : raw.substr(0, raw.find(';'))));
      if (line.starts_with('+') && !lines_.empty()) {
        lines_.back() += " " + line.substr(1);
      } else {
        lines_.push_back(line);
        numbers_.push_back(number);
      }
    }
    // The first line of a deck is its title, whatever it says.
    if (is_deck()) lines_[0] = "* " + lines_[0];
    for (at_ = 0; at_ < lines_.size(); ++at_) {
      if (lower_case(lines_[at_]).starts_with(".param")) parameters(lines_[at_]);
    }
    at_ = 0;
  }

  SpiceLibrary read() {
    head();
    while (at_ < lines_.size()) block();
    if (!deck_.netlist.groups.empty()) {
      deck_.pins = {input_.empty() ? "in" : input_, output_.empty() ? node("out") : output_};
      out_.subcircuits.push_back(std::move(deck_));
    }
    if (out_.subcircuits.empty()) throw InputError(file_ + ": has no subcircuit, expected .subckt NAME PINS");
    for (Subcircuit& one : out_.subcircuits) {
      for (Instance& instance : one.netlist.instances) instance.of = defined(instance.of);
    }
    for (Subcircuit& one : out_.subcircuits) {
      one.netlist.opamp = models_.opamp;
      one.netlist.other_opamps = models_.other_opamps;
      one.netlist.multiplier = models_.multiplier;
      one.netlist.analog_switch = models_.analog_switch;
      one.netlist.diode = models_.diode;
    }
    if (out_.top.empty()) out_.top = out_.subcircuits.back().name;
    if (out_.title.empty()) out_.title = file_;
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file_, numbers_[std::min(at_, numbers_.size() - 1)], what);
  }
  bool is_deck() const {
    return !file_.ends_with(".sub") && !file_.ends_with(".lib") && !file_.ends_with(".sc") &&
           !lines_[0].starts_with('*') && !lines_[0].starts_with('.');
  }
  /// A subcircuit's name as it is defined; SPICE knows no capitals.
  std::string defined(const std::string& name) const {
    for (const Subcircuit& one : out_.subcircuits) {
      if (lower_case(one.name) == lower_case(name)) return one.name;
    }
    Words types;
    for (const OpAmpModel& type : known_.types()) types.push_back(type.name);
    throw InputError(
        file_, used_.at(name),
        fmt::format("'{}' is neither a subcircuit of this file nor a type of op-amp, expected one of {}",
                    name, join(types, ", ")));
  }
  /// A node as it was first written.
  std::string node(const std::string& word) {
    const std::string small = lower_case(word);
    return small == "gnd" ? "0" : nodes_.try_emplace(small, word).first->second;
  }
  const OpAmpModel* type_named(const std::string& name) const {
    for (const OpAmpModel& type : known_.types()) {
      if (lower_case(type.name) == lower_case(name)) return &type;
    }
    return nullptr;
  }
  /// 4.7k, or a parameter between braces.
  double number(const std::string& word, int deep = 0) const {
    double out = 0.0;
    if (word.starts_with('{') && word.ends_with('}')) {
      const auto at = parameters_.find(lower_case(trim(std::string_view(word).substr(1, word.size() - 2))));
      if (at == parameters_.end() || deep > 16) fail(fmt::format("'{}' is no parameter with a number", word));
      return number(at->second, deep + 1);
    }
    if (!spice_value(word, out)) fail(fmt::format("'{}' is no number", word));
    return out;
  }

  /// `.param a=4.7k b = {a}`, in any order.
  void parameters(const std::string& line) {
    static const std::regex kPair(R"(([A-Za-z_]\w*)\s*=\s*([^\s{}]+|\{[^}]*\}))");
    for (std::sregex_iterator at(line.begin(), line.end(), kPair), end; at != end; ++at)
      parameters_[lower_case((*at)[1].str())] = (*at)[2];
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
    const std::string first = lower_case(words[0]);
    if (first == ".model") return model();
    if (first == ".control") return pass_to(".endc");
    if (first == ".end") return static_cast<void>(at_ = lines_.size());
    if (first != ".subckt") {
      // Analyses, outputs, options; what an included file is to define is known by its name or refused where it is used.
      if (first.starts_with('.') && first != ".clock" && first != ".output") return static_cast<void>(++at_);
      if (deck_.netlist.groups.empty()) deck_.name = "deck", begin(deck_);
      element(deck_.netlist);
      ++at_;
      return;
    }
    if (words.size() < 2) fail("has no name, expected .subckt NAME PINS");
    if (words[1].starts_with("bodesmith_")) return model_subcircuit(words[1], comments);
    if (type_named(words[1]) != nullptr) return pass_to(".ends");
    Subcircuit one;
    one.name = words[1];
    one.comments = comments;
    const auto nodes_of_deck = std::exchange(nodes_, {});
    for (std::size_t i = 2; i < words.size(); ++i) one.pins.push_back(node(words[i]));
    begin(one);
    for (++at_; at_ < lines_.size() && !is_end(); ++at_) element(one.netlist);
    if (at_ == lines_.size()) fail(".subckt is not ended, expected .ends");
    ++at_;
    nodes_ = nodes_of_deck;
    out_.subcircuits.push_back(std::move(one));
  }

  void begin(Subcircuit& one) {
    one.netlist.groups = {{"", Purpose::stage}};
    groups_seen_ = 0;
  }
  bool is_end() const { return lower_case(lines_[at_]).starts_with(".ends"); }
  void pass_to(const std::string& end) {
    while (at_ < lines_.size() && !lower_case(lines_[at_]).starts_with(end)) ++at_;
    if (at_ == lines_.size()) fail("is not ended, expected " + end);
    ++at_;
  }

  void element(Netlist& into) {
    const std::string& line = lines_[at_];
    if (line.empty() || line == "*" || lower_case(line).starts_with(".param")) return;
    if (line.starts_with('*')) {
      into.groups.push_back({line.substr(line.starts_with("* ") ? 2 : 1), Purpose::stage});
      return;
    }
    Words w = words_of(line);
    if (line.starts_with('.')) return switched(w, into);
    const std::size_t group = place(w, into);
    const auto expect = [&](std::size_t count) {
      if (w.size() != count) fail(fmt::format("has {} words, expected {}", w.size(), count));
      for (std::size_t i = 1; i < 3; ++i) w[i] = node(w[i]);
    };
    const char kind = kind_of(w);
    switch (kind) {
      case 'R':
      case 'C': {
        expect(4);
        const double value = number(w[3]);
        if (!(value > 0.0)) fail(fmt::format("'{}' is no value of a part, expected one above 0", w[3]));
        into.parts.push_back({kind == 'R' ? Part::Kind::resistor : Part::Kind::capacitor, w[0], "", group,
                              w[1], w[2], "exact", value, value});
        return;
      }
      case 'D':
        expect(4);
        if (w[3] != "bodesmith_diode") fail("is a diode of another model, expected bodesmith_diode");
        into.parts.push_back({Part::Kind::diode, w[0], "", group, w[1], w[2], "", 0.0, 0.0});
        return;
      case 'V':
        return source(line, group, into);
      case 'B':
        if (w.size() < 4 || !lower_case(w[3]).starts_with("v=") || node(w[2]) != "0")
          fail("expected B NAME NODE 0 V=…");
        into.expressions.push_back(
            {w[0], node(w[1]), std::string(trim(line.substr(line.find('=') + 1))), group});
        return;
      case 'S':
        return phased_contact(w, group, into);
      case 'O':
        return nullor(w, group, into);
      case 'E':
        return level(line, w, group, into);
      case 'X':
        return instance(w, group, into);
      default:
        fail(fmt::format("'{}' is no element of these netlists, expected R, C, D, V, B, E, S, O or X", w[0]));
    }
  }

  static char kind_of(const Words& w) {
    const char letter = w[0][0];
    return letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
  }

  /// `.clock NAME FREQUENCY`, `.output NODE`.
  void switched(const Words& w, Netlist& into) {
    if (lower_case(w[0]) == ".output") {
      if (w.size() != 2 || !output_.empty()) fail("expected one line .output NODE");
      output_ = node(w[1]);
    } else if (lower_case(w[0]) == ".clock") {
      const double hz = w.size() == 3 ? number(w[2]) : 0.0;
      if (!(hz > 0.0)) fail("expected .clock NAME FREQUENCY, above 0");
      for (const int phase : {1, 2}) {
        const std::string at = node(fmt::format("{}.{}", w[1], phase));
        if (phase_at(at, into) != nullptr) fail(fmt::format("clock {} is there already", w[1]));
        into.clock_phases.push_back({"V" + at, at, {hz}, phase, 0.0, into.groups.size() - 1});
      }
    }
  }
  static const ClockPhase* phase_at(const std::string& name, const Netlist& in) {
    const auto at = std::ranges::find(in.clock_phases, name, &ClockPhase::node);
    return at == in.clock_phases.end() ? nullptr : &*at;
  }
  /// `S1 a b main.1`: closed in a phase of a clock.
  void phased_contact(const Words& w, std::size_t group, Netlist& into) {
    const ClockPhase* by = w.size() == 4 ? phase_at(node(w[3]), into) : nullptr;
    if (by == nullptr)
      fail(fmt::format("'{}' is no phase of a clock, expected S NAME NODE NODE main.1 after .clock main 100k",
                       w.back()));
    into.contacts.push_back({w[0], group, node(w[1]), node(w[2]), by->node});
  }
  /// `O1 plus minus out noise=5n gbw=10meg`: ideal but for the noise at its input and the bandwidth that limits it.
  void nullor(const Words& w, std::size_t group, Netlist& into) {
    const std::string line = lower_case(lines_[at_]);
    const double noise = figure(line, " noise=(\\S+)"), gbw = figure(line, " gbw=(\\S+)");
    if (w.size() != (noise > 0.0 || gbw > 0.0 ? 6u : 4u) || (noise > 0.0) != (gbw > 0.0))
      fail("expected O NAME PLUS MINUS OUT, or with noise=5n gbw=10meg behind it");
    OpAmpModel model = OpAmpModel::ideal();
    if (noise > 0.0) {
      model.name = w[4] + " " + w[5];
      model.is_ideal = false;
      model.gain_bandwidth = {gbw};
      model.voltage_noise_v_per_rthz = noise;
      model.voltage_noise_corner_hz = 0.0;
    }
    const std::string plus = node(w[1]), minus = node(w[2]);
    into.opamps.push_back({w[0], "", group, plus, minus, node(w[3]), type_of(model)});
  }

  /// `V1 vcc 0 15`, `V1 vcc 0 DC 15`, a phase of a clock; without a value or with an AC value it is the input.
  void source(const std::string& line, std::size_t group, Netlist& into) {
    const Words w = words_of(line);
    if (w.size() < 3) fail("has no nodes, expected V NAME NODE 0 VALUE");
    if (node(w[2]) != "0") fail("a source stands between two nodes, expected one to ground");
    if (w.size() == 3) {
      if (!input_.empty()) fail("has no value, and there is an input already");
      input_ = node(w[1]);
      return;
    }
    static const std::regex kPulse(R"(.* PULSE\(0 1 (\S+) (\S+) \S+ \S+ (\S+)\))");
    if (std::smatch found; std::regex_match(line, found, kPulse)) {
      const double period = number(found[3]), edge = number(found[2]);
      into.clock_phases.push_back({w[0],
                                   node(w[1]),
                                   {1.0 / period},
                                   number(found[1]) == 0.0 ? 1 : 2,
                                   short_number(edge / (kEdgeOfGap * period)),
                                   group});
      return;
    }
    for (std::size_t i = 3; i < w.size(); ++i) {
      if (!lower_case(w[i]).starts_with("ac")) continue;
      input_ = node(w[1]);
      return;
    }
    const bool named = lower_case(w[3]) == "dc";
    if (w.size() != (named ? 5u : 4u)) fail("is more than a constant voltage or an AC value");
    into.sources.push_back({w[0], "", node(w[1]), number(w.back()), group});
  }

  /// Within a group elements stand in a fixed order, as they are printed; one that comes too late begins another group.
  std::size_t place(const Words& w, Netlist& into) {
    const char kind = kind_of(w);
    static const std::map<char, int> kRanks{{'V', 0}, {'O', 3}, {'E', 4}, {'S', 6}, {'B', 8}};
    const auto known = kRanks.find(kind);
    int rank = known == kRanks.end() ? 1 : known->second;
    if (kind == 'V' && w.size() > 3 && w[3].starts_with("PULSE")) rank = 7;
    if (kind == 'E' && w.size() > 4 && w[4].find("tanh") == std::string::npos) rank = is_amplifier(w) ? 3 : 5;
    if (kind == 'X') {
      const std::string& of = w.back();
      rank = of == "bodesmith_multiplier"                    ? 2
             : of == "bodesmith_switch"                      ? 6
             : type_in_name(of) || type_named(of) != nullptr ? 3
                                                             : 9;
    }
    if (into.groups.size() != groups_seen_) rank_ = 0;
    if (rank < rank_) into.groups.push_back({"", Purpose::stage});
    groups_seen_ = into.groups.size();
    rank_ = rank;
    return groups_seen_ - 1;
  }

  void instance(const Words& w, std::size_t group, Netlist& into) {
    if (w.size() < 3) fail("expected X NAME NODES SUBCIRCUIT");
    const std::string name = w[0].substr(1), of = w.back();
    Words pins;
    for (std::size_t i = 1; i + 1 < w.size(); ++i) pins.push_back(node(w[i]));
    if (const OpAmpModel* type = type_named(of)) {
      // In the order of makers' models: + - out, or + - supplies out.
      if (pins.size() != 3 && pins.size() != 5)
        fail(fmt::format("has {} pins, expected + - out, or + - and both supplies and out", pins.size()));
      into.opamps.push_back({name, "", group, pins[0], pins[1], pins.back(), type_of(*type)});
    } else if (const auto own = type_in_name(of)) {
      if (w.size() != 5) fail("an op-amp has three pins");
      into.opamps.push_back({name, "", group, pins[0], pins[1], pins[2], *own});
    } else if (of == "bodesmith_multiplier") {
      if (w.size() != 6) fail("a multiplier has four pins");
      into.multipliers.push_back({name, "", group, pins[0], pins[1], pins[2], pins[3], 0.0});
    } else if (of == "bodesmith_switch") {
      if (w.size() != 5) fail("a contact has three pins");
      into.contacts.push_back(
          {name, group, pins[0], pins[1], pins[2], static_cast<int>(into.contacts.size())});
    } else {
      used_.try_emplace(of, numbers_[at_]);
      into.instances.push_back({name, group, pins, of});
    }
  }

  /// The place of a type of op-amp among the netlist's.
  std::size_t type_of(const OpAmpModel& type) {
    const auto known = std::ranges::find(types_, type.name);
    const auto out = static_cast<std::size_t>(known - types_.begin());
    if (known == types_.end()) types_.push_back(type.name), model_at(out) = type;
    return out;
  }
  OpAmpModel& model_at(std::size_t type) {
    if (type == 0) return models_.opamp;
    if (models_.other_opamps.size() < type) models_.other_opamps.resize(type);
    return models_.other_opamps[type - 1];
  }
  /// Of a model as spice_text() names it.
  static std::optional<std::size_t> type_in_name(const std::string& name) {
    static const std::regex kNumbered("bodesmith_opamp_([2-9]|[1-9][0-9])");
    std::smatch found;
    if (std::regex_match(name, found, kNumbered)) return std::stoul(found[1]);
    for (const std::size_t type : {0u, 1u}) {
      if (opamp_subcircuit_name(type) == name) return type;
    }
    return std::nullopt;
  }

  /// `E1 out 0 plus minus 1e6`: an op-amp that has this gain at every frequency.
  static bool is_amplifier(const Words& w) { return w.size() == 6 && lower_case(w[3]).find("value") != 0; }
  void amplifier(const Words& w, std::size_t group, Netlist& into) {
    if (node(w[2]) != "0")
      fail("an amplifier's output stands between two nodes, expected one against ground");
    const double gain = number(w[5]);
    OpAmpModel model;
    model.name = fmt::format("gain of {:.6g}", std::abs(gain));
    model.dc_gain = std::abs(gain);
    // Beyond every frequency and voltage of a circuit.
    model.gain_bandwidth = Hertz{1e18};
    model.slew_v_per_s = 1e24;
    model.swing_v = 1e6;
    model.output_resistance_ohm = model.bias_current_a = model.offset_v = 0.0;
    model.voltage_noise_v_per_rthz = model.current_noise_a_per_rthz = 0.0;
    if (!(model.dc_gain > 0.0)) fail("has no gain, expected a number other than 0");
    const std::string plus = node(w[3]), minus = node(w[4]);
    into.opamps.push_back(
        {w[0], "", group, gain > 0.0 ? plus : minus, gain > 0.0 ? minus : plus, node(w[1]), type_of(model)});
  }

  /// `Ename name 0 VALUE={ 0.5+0.5*tanh(…) }` or a product of levels.
  void level(const std::string& line, const Words& w, std::size_t group, Netlist& into) {
    if (is_amplifier(w)) return amplifier(w, group, into);
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
    Gate gate{group, value[1], {}, {}};
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
    into.gates.push_back(std::move(gate));
  }

  /// Ours is read, another program's passed over: a part that uses one is refused where it stands.
  void model() {
    static const std::regex kDiode(
        R"(\.model bodesmith_diode D\(IS=(\S+) N=(\S+) RS=(\S+) CJO=(\S+) TT=(\S+)\))");
    std::smatch found;
    if (std::regex_match(lines_[at_], found, kDiode)) {
      models_.diode = {number(found[1]), number(found[2]), number(found[3]), number(found[4]),
                       number(found[5])};
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
    if (const auto type = type_in_name(name)) {
      OpAmpModel& to = model_at(*type);
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
    const auto at =
        std::ranges::find_if(body, [&](const std::string& line) { return line.starts_with(begin); });
    return at == body.end() ? std::string() : *at;
  }

  OpAmpModel opamp_from(const std::string& text, const Words& body) const {
    std::smatch found;
    static const std::regex kName(
        "Op-amp (.*): gain-bandwidth (\\S+) Hz, DC gain (\\S+), slew rate (\\S+) V/s, "
        "output (\\S+) V either side of ground behind (\\S+) ohm.*");
    if (text.starts_with("Ideal op-amp")) return OpAmpModel::ideal();
    static const std::regex kOnePole(
        "Op-amp of one pole: gain-bandwidth (\\S+) Hz, DC gain (\\S+), no limits\\.");
    if (std::regex_match(text, found, kOnePole))
      return OpAmpModel::one_pole({number(found[1])}, number(found[2]));
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
    if (body.size() == 2) {
      const std::string plain = line_with(body, "Gs ");
      return SwitchModel::plain(short_number(1.0 / figure(plain, "\\+([-+.\\deE]+?)\\*v\\(e")),
                                figure(plain, "\\*\\(([-+.\\deE]+?)\\+"));
    }
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

  const OpAmpLibrary known_ = OpAmpLibrary::built_in();
  std::string file_;
  Words lines_;
  std::vector<int> numbers_;  ///< of the lines in the file
  std::map<std::string, std::string> parameters_;
  std::map<std::string, std::string> nodes_;  ///< in small letters, and as they were first written
  std::map<std::string, int> used_;           ///< subcircuits, and the line that uses them first
  Words types_;                               ///< of op-amps
  Subcircuit deck_;                           ///< what stands in no subcircuit
  std::string input_;                         ///< the node of its source with an AC value, or without one
  std::string output_;                        ///< the node that .output names
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
