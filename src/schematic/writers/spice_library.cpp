#include "schematic/writers/spice_library.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "schematic/plain_number.hpp"
#include "schematic/writers/spice_models.hpp"

namespace bodesmith::schematic {
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
      const std::string product = factors.empty() ? (one.never ? "0" : "1") : join(factors, "*");
      out.push_back(fmt::format("E{0} {0} 0 VALUE={{ {1} }}", one.out, product));
    });
    each(netlist_.contacts, [&](const Contact& one, std::size_t) {
      out.push_back(fmt::format("X{} {} {} {} bodesmith_switch", one.name, one.from, one.to, one.control));
    });
    each(netlist_.instances, [&](const Instance& one, std::size_t) {
      out.push_back(fmt::format("X{} {} {}", one.name, join(one.nodes, " "), one.of));
    });
    return out;
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
    out.push_back(fmt::format("X{} {} {} {} {}", one.name, plus, one.minus, one.out,
                              one.fast ? "bodesmith_fast_opamp" : "bodesmith_opamp"));
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
        return std::any_of(n.parts.begin(), n.parts.end(),
                           [](const Part& part) { return part.kind == Part::Kind::diode; });
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
  for (const bool fast : {false, true}) {
    const Netlist* one = first_with([&](const Netlist& n) {
      return std::any_of(n.opamps.begin(), n.opamps.end(), [&](const OpAmp& u) { return u.fast == fast; });
    });
    if (one == nullptr) continue;
    OpAmpModel model = fast ? one->fast_opamp : one->opamp;
    if (!options.noise) model.voltage_noise_v_per_rthz = model.current_noise_a_per_rthz = 0.0;
    out.push_back(opamp_subcircuit(model, fast ? "bodesmith_fast_opamp" : "bodesmith_opamp"));
  }
  return out;
}

}  // namespace

const Subcircuit& SpiceLibrary::subcircuit(const std::string& name) const {
  const auto at = std::find_if(subcircuits.begin(), subcircuits.end(),
                               [&](const Subcircuit& one) { return one.name == name; });
  if (at == subcircuits.end()) throw InputError(title + ": has no subcircuit " + name);
  return *at;
}

Netlist SpiceLibrary::flat(const std::string& name) const {
  Netlist out = subcircuit(name).netlist;
  for (const Instance& instance : std::exchange(out.instances, {})) {
    const Subcircuit& of = subcircuit(instance.of);
    Netlist inner = flat(instance.of);
    if (of.pins.size() != instance.nodes.size() || !inner.multipliers.empty() || !inner.contacts.empty() ||
        !inner.sources.empty() || !inner.comparators.empty() || !inner.gates.empty())
      throw InputError(fmt::format(
          "{}: {} holds more than resistors, capacitors and op-amps between its pins", title, instance.of));
    const auto place = [&](auto& one, std::initializer_list<std::string*> nodes) {
      one.group += out.groups.size();
      for (std::string* node : nodes) {
        const auto pin = std::find(of.pins.begin(), of.pins.end(), *node);
        if (pin != of.pins.end()) {
          *node = instance.nodes[static_cast<std::size_t>(pin - of.pins.begin())];
        } else if (*node != "0") {
          *node = fmt::format("s{}_{}", instance.name, *node);
        }
      }
    };
    for (Part& one : inner.parts) place(one, {&one.from, &one.to});
    for (OpAmp& one : inner.opamps) place(one, {&one.plus, &one.minus, &one.out});
    out.parts.insert(out.parts.end(), inner.parts.begin(), inner.parts.end());
    out.opamps.insert(out.opamps.end(), inner.opamps.begin(), inner.opamps.end());
    out.groups.insert(out.groups.end(), inner.groups.begin(), inner.groups.end());
  }
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
