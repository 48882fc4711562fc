#include "schematic/opamp_library.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"

namespace bodesmith::schematic {

void OpAmpLibrary::add(const Node& document) {
  document.expect_schema("opamps");
  for (const Node& node : document.at("opamp").items()) {
    node.allow_only({"name", "gain_bandwidth_hz", "dc_gain", "slew_v_per_s", "output_resistance_ohm",
                     "swing_v", "bias_current_a", "offset_v", "voltage_noise_v_per_rthz",
                     "voltage_noise_corner_hz", "current_noise_a_per_rthz", "greatest_output_current_a",
                     "per_package"});
    OpAmpModel model;
    model.name = node.at("name").string();
    for (const OpAmpModel& other : types_) {
      if (other.name == model.name) node.at("name").fail("is there already, expected every name once");
    }
    model.gain_bandwidth = Hertz{node.at("gain_bandwidth_hz").positive()};
    model.slew_v_per_s = node.at("slew_v_per_s").positive();
    const auto optional = [&](const char* key, double& value) {
      if (node.has(key)) value = node.at(key).non_negative();
    };
    optional("output_resistance_ohm", model.output_resistance_ohm);
    optional("bias_current_a", model.bias_current_a);
    optional("offset_v", model.offset_v);
    optional("voltage_noise_v_per_rthz", model.voltage_noise_v_per_rthz);
    optional("voltage_noise_corner_hz", model.voltage_noise_corner_hz);
    optional("current_noise_a_per_rthz", model.current_noise_a_per_rthz);
    if (node.has("dc_gain")) model.dc_gain = node.at("dc_gain").positive();
    if (node.has("swing_v")) model.swing_v = node.at("swing_v").positive();
    if (node.has("greatest_output_current_a")) {
      model.greatest_output_current_a = node.at("greatest_output_current_a").positive();
    }
    if (node.has("per_package")) model.per_package = static_cast<int>(node.at("per_package").integer(1, 2));
    types_.push_back(std::move(model));
  }
}

OpAmpLibrary OpAmpLibrary::built_in() {
  OpAmpLibrary out;
  for (const EmbeddedTemplate& one : embedded_templates()) {
    if (one.name == "spice/opamps.toml") out.add(parse_toml(one.text, "opamps.toml"));
  }
  out.types_.emplace_back();
  out.types_.push_back(OpAmpModel::ideal());
  return out;
}

OpAmpLibrary OpAmpLibrary::read(const std::filesystem::path& path, Provenance& from) {
  OpAmpLibrary out;
  out.add(read_document(path, from));
  for (const OpAmpModel& model : built_in().types_) {
    bool known = false;
    for (const OpAmpModel& own : out.types_) known = known || own.name == model.name;
    if (!known) out.types_.push_back(model);
  }
  return out;
}

const OpAmpModel& OpAmpLibrary::named(const std::string& name) const {
  std::vector<std::string> names;
  for (const OpAmpModel& model : types_) {
    if (model.name == name) return model;
    names.push_back(model.name);
  }
  throw InputError(fmt::format("'{}' is not a known op-amp{}, expected one of {}", name,
                               did_you_mean(name, names), join(names, ", ")));
}

}  // namespace bodesmith::schematic
