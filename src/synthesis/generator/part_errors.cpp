#include "synthesis/generator/part_errors.hpp"

#include "base/documents/json.hpp"
#include "base/text.hpp"

namespace bodesmith::generator {
namespace {

using schematic::MultiplierDeviation;

/// Normal numbers are cut here, in standard deviations; the cut leaves 98.66 % of the deviation.
constexpr double kCut = 3.0;

class Collector {
 public:
  Collector(const DisturbanceCircuit& c, const PartErrors& e) : c_(c), e_(e) {}

  std::vector<Cause> run() {
    for (std::size_t i = 0; i < c_.multipliers.size(); ++i) multiplier(i);
    for (std::size_t i = 0; i < c_.opamps.size(); ++i) {
      normal(c_.opamps[i].name + ", offset", "op-amp offsets",
             e_.opamp_offset_share * c_.model_of(c_.opamps[i]).offset_v,
             [i](Copy& copy, double value) { copy.off.opamp_offset_v[i] += value; });
    }
    for (std::size_t i = 0; i < c_.parts.size(); ++i) part(i);
    for (std::size_t i = 0; i < c_.sources.size(); ++i) {
      uniform(c_.sources[i].name + ", tolerance", "references", e_.reference_percent,
              [i](Copy& copy, double value) { copy.off.source[i] += value; });
    }
    normal("op-amps, gain-bandwidth and slew rate", "op-amp speed", e_.opamp_speed_percent / 100.0,
           [](Copy& copy, double value) { copy.speed += value; });
    if (c_.switched()) {
      normal("switch, on-resistance", "switch", e_.switch_ohm_percent / 100.0,
             [](Copy& copy, double value) { copy.off.switch_relative += value; });
      normal("switch, charge", "switch", e_.switch_charge_c,
             [](Copy& copy, double value) { copy.off.switch_charge_c += value; });
      const double delay = c_.analog_switch.on_delay_s;
      normal("slope detector and switch, timing", "switch", e_.switch_timing_percent / 100.0,
             [delay](Copy& copy, double value) {
               copy.timing += value;
               copy.off.switch_delay_s += value * delay;
             });
    }
    return std::move(out_);
  }

 private:
  void normal(std::string name, std::string group, double deviation,
              std::function<void(Copy&, double)> apply) {
    if (deviation <= 0.0) return;
    out_.push_back(
        {std::move(name), std::move(group), {Departure::Law::normal, deviation, kCut}, std::move(apply)});
  }
  void uniform(std::string name, std::string group, double percent,
               std::function<void(Copy&, double)> apply) {
    if (percent <= 0.0) return;
    out_.push_back(
        {std::move(name), std::move(group), {Departure::Law::uniform, percent / 100.0}, std::move(apply)});
  }
  void multiplier(std::size_t i) {
    const std::string& name = c_.multipliers[i].name;
    const auto member = [&](const char* what, const char* group, double deviation,
                            double MultiplierDeviation::*value) {
      normal(name + what, group, deviation,
             [i, value](Copy& copy, double off) { copy.off.multiplier[i].*value += off; });
    };
    member(", offset of X", "multiplier offsets", e_.multiplier_input_v, &MultiplierDeviation::x);
    member(", offset of Y", "multiplier offsets", e_.multiplier_input_v, &MultiplierDeviation::y);
    member(", offset of W", "multiplier offsets", e_.multiplier_output_v, &MultiplierDeviation::w);
    member(", scale U", "multiplier scales", e_.multiplier_scale_percent / 100.0,
           &MultiplierDeviation::scale);
    member(", nonlinearity", "multiplier nonlinearity", e_.multiplier_nonlinearity_percent / 100.0,
           &MultiplierDeviation::bend);
  }
  void part(std::size_t i) {
    using Kind = schematic::Part::Kind;
    const schematic::Part& one = c_.parts[i];
    if (one.kind == Kind::diode) return;
    const bool resistor = one.kind == Kind::resistor;
    uniform(one.name + ", tolerance", resistor ? "resistors" : "capacitors",
            resistor ? e_.resistor_percent : e_.capacitor_percent,
            [i](Copy& copy, double value) { copy.off.part[i] += value; });
  }

  const DisturbanceCircuit& c_;
  const PartErrors& e_;
  std::vector<Cause> out_;
};

}  // namespace

const std::vector<PartErrors::Named>& PartErrors::names() {
  using E = PartErrors;
  static const std::vector<Named> all = {
      {"resistor_percent", &E::resistor_percent},
      {"capacitor_percent", &E::capacitor_percent},
      {"reference_percent", &E::reference_percent},
      {"multiplier_input_v", &E::multiplier_input_v},
      {"multiplier_output_v", &E::multiplier_output_v},
      {"multiplier_scale_percent", &E::multiplier_scale_percent},
      {"multiplier_nonlinearity_percent", &E::multiplier_nonlinearity_percent},
      {"opamp_offset_share", &E::opamp_offset_share},
      {"opamp_speed_percent", &E::opamp_speed_percent},
      {"switch_ohm_percent", &E::switch_ohm_percent},
      {"switch_charge_c", &E::switch_charge_c},
      {"switch_timing_percent", &E::switch_timing_percent}};
  return all;
}

PartErrors PartErrors::from_node(const Node& node) {
  PartErrors out;
  for (const auto& [key, value] : node.members()) {
    if (const auto wrong = out.set(key, 0.0)) value.fail(*wrong);
    out.set(key, value.non_negative());
  }
  return out;
}

std::optional<std::string> PartErrors::set(const std::string& name, double to) {
  std::vector<std::string> known;
  for (const Named& one : names()) {
    known.emplace_back(one.name);
    if (name != one.name) continue;
    this->*one.value = to;
    return std::nullopt;
  }
  return "is not known" + did_you_mean(name, known) + ", expected one of " + join(known, ", ");
}

std::vector<Cause> causes_of(const DisturbanceCircuit& controller, const PartErrors& errors) {
  return Collector(controller, errors).run();
}

std::vector<double> draw_values(const std::vector<Cause>& causes, std::uint64_t seed, std::uint64_t sample) {
  std::vector<double> out(causes.size());
  for_each_drawn(seed, sample, causes.size(),
                 [&](std::size_t i, double u) { out[i] = causes[i].departure.drawn(u); });
  return out;
}

Copy copy_of(const DisturbanceCircuit& controller, const std::vector<Cause>& causes,
             const std::vector<double>& values) {
  Copy out;
  out.off = schematic::Deviations::none(controller);
  for (std::size_t i = 0; i < causes.size(); ++i) causes[i].apply(out, values[i]);
  return out;
}

schematic::Deviations multipliers_off(const DisturbanceCircuit& layout) {
  Copy out = copy_of(layout, {}, {});
  for (const Cause& cause : causes_of(layout, {})) {
    if (cause.group.starts_with("multiplier")) cause.apply(out, cause.departure.deviation());
  }
  return out.off;
}

Json to_json(const PartErrors& errors) {
  Json out;
  for (const PartErrors::Named& one : PartErrors::names()) out[one.name] = errors.*one.value;
  out["distribution"] =
      "resistors, capacitors and references uniform within the tolerance; all others normal, the figure being one "
      "standard deviation, cut at three";
  return out;
}

}  // namespace bodesmith::generator
