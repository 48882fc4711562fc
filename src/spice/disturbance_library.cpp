#include "spice/disturbance_library.hpp"

#include <fmt/format.h>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "base/version.hpp"
#include "circuit/text.hpp"
#include "spice/models.hpp"
#include "spice/opamp_macromodel.hpp"

namespace bodesmith::spice {
namespace {

using circuit::plain_number;

Json line_of(const multiplier_layout::Part& part) {
  return {{"line", fmt::format("{} {} {} {}", part.name, part.from, part.to, plain_number(part.realised))}};
}

Json sum_json(const multiplier_layout::Layout& layout, const multiplier_layout::Sum& sum) {
  Json resistors = Json::array();
  for (const multiplier_layout::Sum::Term& term : sum.terms)
    resistors.push_back(line_of(layout.part(term.part)));
  resistors.push_back(line_of(layout.part(sum.feedback)));
  if (sum.balance >= 0) resistors.push_back(line_of(layout.part(sum.balance)));
  return {{"what", fmt::format("{}: {}", sum.what, sum.out)},
          {"opamp", sum.opamp},
          {"plus", sum.plus},
          {"minus", sum.minus},
          {"out", sum.out},
          {"resistors", resistors}};
}

Json multiplier_json(const multiplier_layout::Multiplier& m) {
  return {{"name", m.name}, {"x", m.x}, {"y", m.y}, {"z", m.z}, {"w", m.out}};
}

/// 1 when the lines (levels lb, l1, l2, …) select this branch.
std::string logic_of(const multiplier_layout::Layout& layout, int branch) {
  const int lines = layout.select_lines();
  for (int select = 0; select < (1 << lines); ++select) {
    const bool up = layout.branch_at(select, true) == branch,
               down = layout.branch_at(select, false) == branch;
    if (!up && !down) continue;
    std::vector<std::string> factors;
    if (up != down) factors.push_back(up ? "v(lb)" : "(1-v(lb))");
    for (int bit = 0; bit < lines; ++bit)
      factors.push_back(((select >> bit) & 1) != 0 ? fmt::format("v(l{})", bit + 1)
                                                   : fmt::format("(1-v(l{}))", bit + 1));
    return factors.empty() ? "1" : join(factors, "*");
  }
  return "0";
}

std::string codes_of(const multiplier_layout::Layout& layout) {
  std::vector<std::string> out;
  for (int select = 0; select < (1 << layout.select_lines()); ++select) {
    for (const bool rising : {true, false}) {
      const int b = layout.branch_at(select, rising);
      if (b >= 0)
        out.push_back(fmt::format("{}{}: {}", select, rising ? " up" : " down",
                                  layout.branches[static_cast<size_t>(b)].name));
    }
  }
  return join(out, ", ");
}

void add_switch(const multiplier_layout::Layout& layout, bool amplitude, Json& data) {
  const multiplier_layout::SwitchModel& model = layout.analog_switch;
  data["switch"] = model.name;
  data["on_ohm"] = plain_number(model.on_ohm);
  data["on_delay_s"] = plain_number(model.on_delay_s);
  data["off_delay_s"] = plain_number(model.off_delay_s());
  data["switch_model"] = switch_subcircuit(model);
  data["lines"] = Json::array({{{"level", "lb"}, {"pin", "branch"}}});
  for (int line = 1; line <= layout.select_lines(); ++line)
    data["lines"].push_back({{"level", fmt::format("l{}", line)}, {"pin", fmt::format("select{}", line)}});
  data["channels"] = Json::array();
  for (size_t b = 0; b < layout.branches.size(); ++b) {
    data["channels"].push_back(
        {{"name", fmt::format("S{}", b + 1)},
         {"enable", fmt::format("e{}", b + 1)},
         {"logic", logic_of(layout, static_cast<int>(b))},
         {"from", amplitude ? layout.amplitude->multipliers[b].out : layout.branches[b].out}});
  }
  data["detector"] = Json::array();
  for (const int index : layout.detector) data["detector"].push_back(line_of(layout.part(index)));
  data["differentiator_opamp"] = fmt::format("XU{}", layout.sums.size() + 2);
  data["comparator_opamp"] = fmt::format("XU{}", layout.sums.size() + 3);
}

void add_amplitude(const multiplier_layout::Layout& layout, Json& data) {
  const multiplier_layout::AmplitudeControl& a = *layout.amplitude;
  data["rectifiers"] = Json::array();
  for (const multiplier_layout::AmplitudeControl::Rectifier& r : a.rectifiers) {
    data["rectifiers"].push_back(
        {{"at", rounded_text(r.realised, 6)},
         {"node", r.node},
         {"end", "k" + r.node},
         {"minus", layout.part(r.feedback).from},
         {"opamp", r.opamp},
         {"resistors", Json::array({line_of(layout.part(r.input)), line_of(layout.part(r.reference)),
                                    line_of(layout.part(r.feedback))})}});
  }
  data["controls"] = Json::array();
  for (const multiplier_layout::AmplitudeControl::Control& one : a.controls) {
    if (one.negative) data["controls"].push_back(sum_json(layout, *one.negative));
    data["controls"].push_back(sum_json(layout, one.sum));
  }
  data["gains"] = Json::array();
  for (const multiplier_layout::Multiplier& m : a.multipliers) data["gains"].push_back(multiplier_json(m));
}

}  // namespace

std::string disturbance_pins(const multiplier_layout::Layout& layout, bool amplitude) {
  std::string out = "x branch";
  for (int line = 1; line <= layout.select_lines(); ++line) out += fmt::format(" select{}", line);
  return out + (amplitude ? " amplitude out" : " out");
}

std::string disturbance_library(const multiplier_layout::Layout& layout, const std::string& title,
                                const DisturbanceLibrary& options) {
  Json data;
  data["title"] = title;
  data["version"] = kVersion;
  data["top"] = options.amplitude ? "disturbance_amplitude" : "disturbance";
  data["pins"] = disturbance_pins(layout, options.amplitude);
  data["gain_note"] = options.amplitude ? "With the amplitude gains." : "Without the gain tables.";
  data["first_branch"] = layout.branches[0].name;
  data["selected"] = layout.select_lines() > 0;
  data["codes"] = codes_of(layout);
  data["multipliers"] = Json::array();
  for (const multiplier_layout::Multiplier& m : layout.multipliers)
    data["multipliers"].push_back(multiplier_json(m));
  data["sums"] = Json::array();
  for (const multiplier_layout::Sum& sum : layout.sums) data["sums"].push_back(sum_json(layout, sum));
  data["amplitude"] = options.amplitude;
  if (options.amplitude) add_amplitude(layout, data);
  data["switched"] = layout.switched();
  if (layout.switched()) add_switch(layout, options.amplitude, data);
  const multiplier_layout::Part& input = layout.part(layout.output_input);
  const std::string from =
      options.amplitude && !layout.switched() ? layout.amplitude->multipliers[0].out : input.from;
  const int feedback = options.amplitude ? layout.amplitude->output_feedback : layout.output_feedback;
  data["output"] = Json::array(
      {{{"line", fmt::format("{} {} {} {}", input.name, from, input.to, plain_number(input.realised))}},
       line_of(layout.part(feedback))});
  data["output_opamp"] = fmt::format("XU{}", layout.sums.size() + 1);
  data["diodes"] = layout.switched() || options.amplitude;
  data["diode_model"] = diode_model(multiplier_layout::DiodeModel{});
  MultiplierText multiplier{"bodesmith_multiplier", layout.multiplier, {}};
  if (options.errors) multiplier.off = options.errors->multiplier_at_limit();
  data["multiplier_model"] = multiplier_subcircuit(multiplier);
  data["opamp"] = opamp_macromodel(layout.opamp);
  return render_template("spice/disturbance.sub", data);
}

}  // namespace bodesmith::spice
