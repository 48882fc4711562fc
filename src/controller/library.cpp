#include "controller/library.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/json.hpp"
#include "base/text_template.hpp"
#include "base/version.hpp"
#include "circuit/text.hpp"
#include "multiplier_layout/timing.hpp"
#include "spice/models.hpp"
#include "spice/opamp_macromodel.hpp"

namespace bodesmith::controller {
namespace {

using circuit::plain_number;

class Writer {
 public:
  Writer(const AnalogController& controller, const LibraryOptions& options)
      : controller_(controller),
        options_(options),
        off_(options.off != nullptr ? *options.off : Deviations::none(controller)) {}

  Json sections() {
    // In the order of the description, which is that of the signals' making.
    std::vector<std::string> names;
    const auto see = [&](const std::string& name) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    for (const Part& one : controller_.parts) see(one.section);
    for (const Multiplier& one : controller_.multipliers) see(one.section);
    for (const Contact& one : controller_.contacts) see(one.section);
    Json out = Json::array();
    for (const std::string& name : names) {
      if (left_out(name)) continue;
      Json lines = Json::array();
      for (const std::string& line : section(name)) lines.push_back({{"line", line}});
      out.push_back({{"what", name}, {"lines", lines}});
    }
    return out;
  }

  Json multipliers() const {
    Json out = Json::array();
    const spice::MultiplierText plain{"bodesmith_multiplier", controller_.multiplier, {}};
    out.push_back({{"text", spice::multiplier_subcircuit(plain)}});
    for (std::size_t i = 0; i < controller_.multipliers.size(); ++i) {
      if (!is_off(i)) continue;
      out.push_back(
          {{"text", spice::multiplier_subcircuit({type_of(i), controller_.multiplier, off_.multiplier[i]})}});
    }
    return out;
  }

 private:
  bool left_out(const std::string& section) const {
    return options_.open && (section == "slope's sign" || section == "slope");
  }

  /// With the loop cut the powers and weights read x.
  std::string node(const std::string& name) const {
    if (!options_.open) return name;
    if (name == "sn") return "slope";
    return name;
  }

  std::string argument(const std::string& name, const std::string& section) const {
    const bool generator = section.starts_with("powers") || section.starts_with("ascending") ||
                           section.starts_with("descending");
    if (options_.open && generator && name == controller_.passes.back().x) return "x";
    return node(name);
  }

  bool is_off(std::size_t i) const {
    if (off_.multiplier.empty()) return false;
    const multiplier_layout::MultiplierDeviation& m = off_.multiplier[i];
    return m.x != 0.0 || m.y != 0.0 || m.w != 0.0 || m.scale != 0.0 || m.bend != 0.0;
  }
  std::string type_of(std::size_t i) const {
    return "bodesmith_multiplier" + (is_off(i) ? "_" + controller_.multipliers[i].name : "");
  }

  std::vector<std::string> section(const std::string& name) const {
    std::vector<std::string> out;
    for (std::size_t i = 0; i < controller_.parts.size(); ++i) {
      const Part& part = controller_.parts[i];
      if (part.section != name) continue;
      const std::string value = part.kind == Part::Kind::diode
                                    ? "bodesmith_diode"
                                    : plain_number(off_.value(controller_, static_cast<int>(i)));
      out.push_back(
          fmt::format("{} {} {} {}", part.name, argument(part.from, name), argument(part.to, name), value));
    }
    for (std::size_t i = 0; i < controller_.multipliers.size(); ++i) {
      const Multiplier& m = controller_.multipliers[i];
      if (m.section != name) continue;
      out.push_back(fmt::format("X{} {} {} {} {} {}", m.name, argument(m.x, name), argument(m.y, name),
                                argument(m.z, name), m.out, type_of(i)));
    }
    for (std::size_t i = 0; i < controller_.opamps.size(); ++i) {
      if (controller_.opamps[i].section == name) opamp(i, out);
    }
    for (const Contact& contact : controller_.contacts) {
      if (contact.section != name) continue;
      out.push_back(fmt::format("X{} {} {} {} bodesmith_switch", contact.name, contact.from, contact.to,
                                contact.rising ? "up" : "down"));
    }
    return out;
  }

  void opamp(std::size_t i, std::vector<std::string>& out) const {
    const OpAmp& u = controller_.opamps[i];
    const double offset = off_.offset(static_cast<int>(i));
    std::string plus = node(u.plus);
    if (offset != 0.0) {
      out.push_back(fmt::format("Vos{0} os{0} {1} {2}", u.name, plus, plain_number(offset)));
      plus = "os" + u.name;
    }
    out.push_back(fmt::format("X{} {} {} {} {}", u.name, plus, node(u.minus), u.out,
                              u.fast ? "bodesmith_fast_opamp" : "bodesmith_opamp"));
  }

  const AnalogController& controller_;
  const LibraryOptions& options_;
  const Deviations off_;
};

}  // namespace

Deviations Deviations::none(const AnalogController& controller) {
  Deviations out;
  out.part.assign(controller.parts.size(), 0.0);
  out.opamp_offset_v.assign(controller.opamps.size(), 0.0);
  out.multiplier.assign(controller.multipliers.size(), {});
  out.reference.assign(controller.references.size(), 0.0);
  return out;
}

std::string controller_library(const AnalogController& controller, const std::string& title,
                               const LibraryOptions& options) {
  Writer writer(controller, options);
  Json data;
  data["title"] = title;
  data["version"] = kVersion;
  data["form"] = std::string(to_string(controller.form));
  data["top"] = options.open ? "controller_open" : "controller";
  data["pins"] = options.open ? "r x branch slope v" : "r v";
  data["open"] = options.open;
  data["sections"] = writer.sections();
  data["references"] = Json::array();
  for (std::size_t i = 0; i < controller.references.size(); ++i) {
    const VoltageReference& one = controller.references[i];
    const double off =
        options.off != nullptr && !options.off->reference.empty() ? options.off->reference[i] : 0.0;
    data["references"].push_back(
        {{"line", fmt::format("{} {} 0 {}", one.name, one.node, plain_number(one.volts * (1.0 + off)))}});
  }
  data["logic"] = options.open ? "40*(v(branch)-0.5)" : "v(so)";
  data["multipliers"] = writer.multipliers();
  multiplier_layout::SwitchModel contact = controller.analog_switch;
  if (options.off != nullptr) {
    contact.on_ohm *= 1.0 + options.off->switch_relative;
    contact.charge_c += options.off->switch_charge_c;
    contact.on_delay_s += options.off->switch_delay_s;
  }
  data["switch"] = spice::switch_subcircuit(contact);
  data["diode"] = spice::diode_model(multiplier_layout::DiodeModel{});
  const auto quiet = [](circuit::OpAmpModel model) {  // time-domain runs need no noise sources
    model.voltage_noise_v_per_rthz = model.current_noise_a_per_rthz = 0.0;
    return model;
  };
  data["opamp"] = spice::opamp_macromodel(quiet(controller.opamp));
  data["fast_opamp"] =
      options.open ? "" : spice::opamp_macromodel(quiet(controller.fast_opamp), "bodesmith_fast_opamp");
  return render_template("spice/controller.sub", data);
}

}  // namespace bodesmith::controller
