#include "schematic/writers/spice_library.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/constants.hpp"
#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "schematic/elements/element.hpp"
#include "schematic/plain_number.hpp"

namespace bodesmith::schematic {
namespace {

std::string without_end(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

}  // namespace

std::string opamp_subcircuit(const OpAmpModel& model, const std::string& subcircuit) {
  if (model.is_ideal)
    return without_end(render_template("spice/ideal_opamp.sub", {{"subcircuit", subcircuit}}));
  const double gbw = model.gain_bandwidth.rad_s().value;
  if (!model.has_limits()) {
    // About the capacitors that it stands among: a simulator's least charge is one for all.
    constexpr double kPole = 1e-11;
    return without_end(
        render_template("spice/one_pole_opamp.sub", {{"subcircuit", subcircuit},
                                                     {"gbw_hz", plain_number(model.gain_bandwidth.value)},
                                                     {"dc_gain", plain_number(model.dc_gain)},
                                                     {"siemens", plain_number(gbw * kPole)},
                                                     {"ohm", plain_number(model.dc_gain / (gbw * kPole))},
                                                     {"farad", plain_number(kPole)}}));
  }
  constexpr double kIntegrator = 1e-9;
  Json data = {{"subcircuit", subcircuit},
               {"name", model.name},
               {"gbw_hz", plain_number(model.gain_bandwidth.value)},
               {"dc_gain", plain_number(model.dc_gain)},
               {"slew_v_per_s", plain_number(model.slew_v_per_s)},
               {"swing_v", plain_number(model.swing_v)},
               {"output_resistance_ohm", plain_number(model.output_resistance_ohm)},
               {"slew_current_a", plain_number(model.slew_v_per_s * kIntegrator)},
               {"slope_per_v", plain_number(gbw / model.slew_v_per_s)},
               {"integrator_ohm", plain_number(model.dc_gain / (gbw * kIntegrator))},
               {"integrator_f", plain_number(kIntegrator)}};
  // 1 mV beyond the limit takes the whole slewing current.
  data["clamp_siemens"] = plain_number(model.slew_v_per_s * kIntegrator / 1e-3);
  // Noise as that of resistors: 4 k T R = e^2.
  constexpr double k4T = 4.0 * kBoltzmann * kKelvin;
  data["voltage_noise"] = model.voltage_noise_v_per_rthz > 0.0;
  data["voltage_noise_v_per_rthz"] = plain_number(model.voltage_noise_v_per_rthz);
  const double white = std::pow(model.voltage_noise_v_per_rthz, 2);
  // The part that falls with frequency is that of two diodes in opposition, which all three simulators have:
  // current noise KF I/f behind r = kT/(q I) each. Their shot noise, 2 q I, is taken off the resistor's.
  constexpr double kThermalV = kBoltzmann * kKelvin / kElectron;
  constexpr double kDiodeA = 0.1, kDiodeOhm = kThermalV / kDiodeA;
  const bool flicker = white > 0.0 && model.voltage_noise_corner_hz > 0.0;
  const double shot = flicker ? 2.0 * 2.0 * kElectron * kDiodeA * kDiodeOhm * kDiodeOhm : 0.0;
  data["flicker"] = flicker;
  data["corner_hz"] = plain_number(model.voltage_noise_corner_hz);
  data["diode_a"] = plain_number(kDiodeA);
  data["kf"] = plain_number(white * model.voltage_noise_corner_hz / (2.0 * kDiodeOhm * kDiodeOhm * kDiodeA));
  data["flicker_term"] = flicker ? "+v(d1)-v(d2)" : "";
  data["noise_ohm"] = plain_number(std::max(white - shot, 1e-3 * white) / k4T);
  data["current_noise"] = model.current_noise_a_per_rthz > 0.0;
  constexpr double kUnit = 1e3;
  data["unit_ohm"] = plain_number(kUnit);
  data["current_noise_siemens"] = plain_number(model.current_noise_a_per_rthz / std::sqrt(k4T * kUnit));
  return without_end(render_template("spice/opamp.sub", data));
}

std::string opamp_subcircuit_name(std::size_t type) {
  return type < 2 ? (type == 0 ? "bodesmith_opamp" : "bodesmith_fast_opamp")
                  : fmt::format("bodesmith_opamp_{}", type);
}

std::string multiplier_subcircuit(const MultiplierModel& model, const std::string& name,
                                  const MultiplierDeviation& off) {
  Json data = {{"name", name},
               {"multiplier", model.name},
               {"scale_v", plain_number(model.scale_v)},
               {"spoilt", off.any()},
               {"input_offset_v", plain_number(off.x)},
               {"second_offset_v", plain_number(off.y)},
               {"output_offset_v", plain_number(off.w)},
               {"inverse_scale", plain_number(1.0 / model.scale_v * (1.0 + off.bend) / (1.0 + off.scale))},
               {"bandwidth_hz", plain_number(model.bandwidth.value)},
               {"pole_f", plain_number(1.0 / model.bandwidth.rad_s().value)},
               {"limit_v", plain_number(model.greatest_output_v)}};
  return without_end(render_template("spice/multiplier.sub", data));
}

std::string switch_subcircuit(const SwitchModel& model) {
  if (model.is_plain()) {
    return without_end(
        render_template("spice/plain_switch.sub", {{"off_siemens", plain_number(model.off_siemens)},
                                                   {"on_siemens", plain_number(model.on_siemens())}}));
  }
  const SwitchTimer timer = SwitchTimer::of(model);
  Json data = {{"charge_c", plain_number(model.charge_c)},
               {"off_siemens", plain_number(model.off_siemens)},
               {"on_siemens", plain_number(model.on_siemens())},
               {"level", plain_number(timer.level)},
               {"timer_f", plain_number(timer.tau_s / 1000.0)},
               {"charge_f", plain_number(model.gate_f())},
               {"source_f", plain_number(model.source_f)},
               {"drain_f", plain_number(std::max(model.drain_f - model.gate_f(), 0.0))}};
  return without_end(render_template("spice/switch.sub", data));
}

std::string diode_model(const DiodeModel& model) {
  return fmt::format(".model bodesmith_diode D(IS={} N={} RS={} CJO={} TT={})",
                     plain_number(model.saturation_a), plain_number(model.emission),
                     plain_number(model.series_ohm), plain_number(model.junction_f),
                     plain_number(model.transit_s));
}

namespace {

using Lines = std::vector<std::string>;

/// The lines of one netlist, group by group.
class NetlistLines {
 public:
  NetlistLines(const Netlist& netlist, const Deviations* off, const SpiceOptions& options)
      : netlist_(netlist), off_(off), options_(options) {}

  Lines all() const {
    Lines out;
    for (std::size_t group = 0; group < std::max<std::size_t>(netlist_.groups.size(), 1); ++group) {
      const Lines here = of_group(group);
      if (here.empty()) continue;
      if (group < netlist_.groups.size() && !netlist_.groups[group].title.empty())
        out.push_back("* " + netlist_.groups[group].title);
      out.insert(out.end(), here.begin(), here.end());
    }
    return out;
  }

 private:
  Lines of_group(std::size_t group) const {
    Lines out;
    const auto each = [&](const auto& list, auto line) {
      for (std::size_t i = 0; i < list.size(); ++i) {
        if (list[i].group == group) line(list[i], i);
      }
    };
    each(netlist_.sources, [&](const Source& one, std::size_t i) {
      const double volts = one.volts * (1.0 + (off_ != nullptr ? off_->source[i] : 0.0));
      out.push_back(fmt::format("{} {} 0 {}", one.name, one.node, plain_number(volts)));
    });
    each(netlist_.parts, [&](const Part& one, std::size_t i) {
      out.push_back(fmt::format("{} {} {} {}", one.name, one.from, one.to, value_of(one, i)));
    });
    each(netlist_.multipliers, [&](const Multiplier& one, std::size_t i) {
      out.push_back(fmt::format("X{} {} {} {} {} {}", one.name, one.x, one.y, one.z, one.out,
                                multiplier_name(one, off_ != nullptr && off_->multiplier[i].any())));
    });
    each(netlist_.opamps, [&](const OpAmp& one, std::size_t i) { opamp(one, i, out); });
    each(netlist_.comparators, [&](const Comparator& one, std::size_t) {
      out.push_back(fmt::format("E{0} {0} 0 VALUE={{ 0.5+0.5*tanh({1}) }}", one.out, argument(one)));
    });
    each(netlist_.gates, [&](const Gate& one, std::size_t) {
      Lines factors;
      for (const std::string& level : one.high) factors.push_back("v(" + level + ")");
      for (const std::string& level : one.low) factors.push_back("(1-v(" + level + "))");
      out.push_back(fmt::format("E{0} {0} 0 VALUE={{ {1} }}", one.out, join(factors, "*")));
    });
    each(netlist_.contacts, [&](const Contact& one, std::size_t) {
      out.push_back(fmt::format("X{} {} {} {} bodesmith_switch", one.name, one.from, one.to, one.control));
    });
    each(netlist_.clock_phases, [&](const ClockPhase& one, std::size_t) { clock_phase(one, out); });
    each(netlist_.expressions, [&](const Expression& one, std::size_t) {
      out.push_back(fmt::format("{} {} 0 V={}", one.name, one.node, one.volts));
    });
    each(netlist_.instances, [&](const Instance& one, std::size_t) {
      out.push_back(fmt::format("X{} {} {}", one.name, join(one.nodes, " "), one.of));
    });
    return out;
  }

  /// Its edges lie in the gaps: a phase is full from its beginning to its end.
  static void clock_phase(const ClockPhase& one, Lines& out) {
    const double period = 1.0 / one.frequency.value, edge = kEdgeOfGap * one.gap * period;
    out.push_back(fmt::format("{} {} 0 PULSE(0 1 {} {} {} {} {})", one.name, one.node,
                              plain_number(one.phase == 1 ? 0.0 : 0.5 * period), plain_number(edge),
                              plain_number(edge), plain_number((0.5 - one.gap) * period),
                              plain_number(period)));
  }

  static std::string argument(const Comparator& one) {
    const std::string difference = one.threshold_v == 0.0
                                       ? "v(" + one.in + ")"
                                       : fmt::format("(v({})-{})", one.in, plain_number(one.threshold_v));
    return one.gain == 1.0 ? difference : plain_number(one.gain) + "*" + difference;
  }

  std::string value_of(const Part& one, std::size_t i) const {
    if (one.kind == Part::Kind::diode) return "bodesmith_diode";
    if (options_.value) return options_.value(one);
    return plain_number(one.realised * (1.0 + (off_ != nullptr ? off_->part[i] : 0.0)));
  }

  /// An offset is a source before the input.
  void opamp(const OpAmp& one, std::size_t i, Lines& out) const {
    const double offset = off_ != nullptr ? off_->opamp_offset_v[i] : 0.0;
    std::string plus = one.plus;
    if (offset != 0.0) {
      out.push_back(fmt::format("Vos{0} os{0} {1} {2}", one.name, plus, plain_number(offset)));
      plus = "os" + one.name;
    }
    out.push_back(
        fmt::format("X{} {} {} {} {}", one.name, plus, one.minus, one.out, opamp_subcircuit_name(one.type)));
  }

 public:
  static std::string multiplier_name(const Multiplier& one, bool off) {
    return "bodesmith_multiplier" + (off ? "_" + one.name : "");
  }

 private:
  const Netlist& netlist_;
  const Deviations* off_;
  const SpiceOptions& options_;
};

std::string block_text(const Subcircuit& one, const Deviations* off, const SpiceOptions& options) {
  std::string out;
  for (const std::string& comment : one.comments) out += "* " + comment + "\n";
  out += fmt::format(".subckt {} {}\n", one.name, join(one.pins, " "));
  for (const std::string& line : NetlistLines(one.netlist, off, options).all()) out += line + "\n";
  return out + ".ends " + one.name;
}

/// The models that any of the netlists needs.
Lines model_texts(const SpiceLibrary& library, const SpiceOptions& options) {
  const auto first_with = [&](auto uses) -> const Netlist* {
    for (const Subcircuit& one : library.subcircuits) {
      if (uses(one.netlist)) return &one.netlist;
    }
    return nullptr;
  };
  Lines out;
  if (const Netlist* one = first_with([](const Netlist& n) { return !n.contacts.empty(); })) {
    out.push_back(switch_subcircuit(options.off != nullptr ? options.off->contact(one->analog_switch)
                                                           : one->analog_switch));
  }
  if (const Netlist* one = first_with([](const Netlist& n) {
        return std::ranges::any_of(n.parts, [](const Part& part) { return part.kind == Part::Kind::diode; });
      }))
    out.push_back(diode_model(one->diode));
  if (const Netlist* one = first_with([](const Netlist& n) { return !n.multipliers.empty(); })) {
    out.push_back(multiplier_subcircuit(one->multiplier, "bodesmith_multiplier"));
    const Netlist& top = library.subcircuit(library.top).netlist;
    for (std::size_t i = 0; options.off != nullptr && i < top.multipliers.size(); ++i) {
      if (options.off->multiplier[i].any())
        out.push_back(multiplier_subcircuit(top.multiplier,
                                            NetlistLines::multiplier_name(top.multipliers[i], true),
                                            options.off->multiplier[i]));
    }
  }
  std::map<std::size_t, OpAmpModel> types;
  for (const Subcircuit& one : library.subcircuits) {
    for (const OpAmp& opamp : one.netlist.opamps) types.emplace(opamp.type, one.netlist.model_of(opamp));
  }
  for (auto& [type, model] : types) {
    if (!options.noise) model.voltage_noise_v_per_rthz = model.current_noise_a_per_rthz = 0.0;
    out.push_back(opamp_subcircuit(model, opamp_subcircuit_name(type)));
  }
  return out;
}

/// What an element is connected to.
struct Nodes {
  using List = std::vector<std::string*>;
  List operator()(Part& one) const { return {&one.from, &one.to}; }
  List operator()(OpAmp& one) const { return {&one.plus, &one.minus, &one.out}; }
  List operator()(Multiplier& one) const { return {&one.x, &one.y, &one.z, &one.out}; }
  List operator()(Contact& one) const { return {&one.from, &one.to, &one.control}; }
  List operator()(Source& one) const { return {&one.node}; }
  List operator()(Comparator& one) const { return {&one.in, &one.out}; }
  List operator()(Gate& one) const {
    List out{&one.out};
    for (auto* levels : {&one.high, &one.low}) {
      for (std::string& level : *levels) out.push_back(&level);
    }
    return out;
  }
  List operator()(ClockPhase& one) const { return {&one.node}; }
  List operator()(Expression& one) const { return {&one.node}; }
  List operator()(Instance& one) const {
    List out;
    for (std::string& node : one.nodes) out.push_back(&node);
    return out;
  }
};

}  // namespace

const Subcircuit& SpiceLibrary::subcircuit(const std::string& name) const {
  const auto at = std::ranges::find(subcircuits, name, &Subcircuit::name);
  if (at == subcircuits.end()) throw InputError(title + ": has no subcircuit " + name);
  return *at;
}

Netlist SpiceLibrary::flat(const std::string& name, std::size_t depth) const {
  Netlist out = subcircuit(name).netlist;
  if (depth > subcircuits.size())
    throw InputError(fmt::format("{}: {} holds itself, without end", title, name));
  for (const Instance& instance : std::exchange(out.instances, {})) {
    const Subcircuit& of = subcircuit(instance.of);
    Netlist inner = flat(instance.of, depth + 1);
    if (of.pins.size() != instance.nodes.size() || !inner.multipliers.empty() || !inner.sources.empty() ||
        !inner.comparators.empty() || !inner.gates.empty() || !inner.clock_phases.empty() ||
        !inner.expressions.empty())
      throw InputError(
          fmt::format("{}: {} holds more than resistors, capacitors, contacts and op-amps between its pins",
                      title, instance.of));
    const auto place = [&](auto& one) {
      one.group += out.groups.size();
      for (std::string* node : Nodes()(one)) {
        const auto pin = std::ranges::find(of.pins, *node);
        if (pin != of.pins.end()) {
          *node = instance.nodes[static_cast<std::size_t>(pin - of.pins.begin())];
        } else if (*node != "0") {
          *node = fmt::format("s{}_{}", instance.name, *node);
        }
      }
    };
    for_each_element(inner, place);
    out.parts.insert(out.parts.end(), inner.parts.begin(), inner.parts.end());
    out.opamps.insert(out.opamps.end(), inner.opamps.begin(), inner.opamps.end());
    out.contacts.insert(out.contacts.end(), inner.contacts.begin(), inner.contacts.end());
    out.groups.insert(out.groups.end(), inner.groups.begin(), inner.groups.end());
    if (out.parts.size() + out.opamps.size() + out.contacts.size() > kMostParts)
      throw InputError(fmt::format("{}: {} has more than {} parts", title, name, kMostParts));
  }
  return out;
}

Netlist SpiceLibrary::two_port(const std::string& name) const {
  const std::vector<std::string>& pins = subcircuit(name).pins;
  if (pins.size() != 2)
    throw InputError(
        fmt::format("{}: {} has {} pins, expected its input and its output", title, name, pins.size()));
  Netlist out = flat(name);
  if (!out.clock_phases.empty() || !out.expressions.empty())
    throw InputError(
        fmt::format("{}: {} has clocks or B sources, of which no response is known here", title, name));
  bool ends = false;
  for_each_element(out, [&](auto& one) {
    for (std::string* node : Nodes()(one)) {
      const bool taken = *node == "in" || *node == "out";
      ends = ends || *node == pins[1];
      *node = *node == pins[0] ? "in" : *node == pins[1] ? "out" : taken ? *node + "_" : *node;
    }
  });
  if (!ends) throw InputError(fmt::format("{}: {} has nothing at its output, node {}", title, name, pins[1]));
  return out;
}

std::string spice_text(const SpiceLibrary& library, const SpiceOptions& options) {
  Json data = {{"title", library.title}, {"written_by", library.written_by},
               {"top", library.top},     {"pins", join(library.subcircuit(library.top).pins, " ")},
               {"notes", Json::array()}, {"blocks", Json::array()}};
  for (const std::string& note : library.notes) data["notes"].push_back({{"line", note}});
  for (const Subcircuit& one : library.subcircuits)
    data["blocks"].push_back(
        {{"text", block_text(one, one.name == library.top ? options.off : nullptr, options)}});
  for (const std::string& model : model_texts(library, options)) data["blocks"].push_back({{"text", model}});
  return render_template("spice/library.sub", data);
}

}  // namespace bodesmith::schematic
