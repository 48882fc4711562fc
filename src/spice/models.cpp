#include "spice/models.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "circuit/text.hpp"

namespace bodesmith::spice {
namespace {

using circuit::plain_number;

/// Of the source that pushes the injected charge through Cg, V.
constexpr double kGateSwing = 10.0;

std::string without_end(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

}  // namespace

std::string multiplier_subcircuit(const MultiplierText& multiplier) {
  const multiplier_layout::MultiplierModel& model = multiplier.model;
  Json data;
  data["name"] = multiplier.subcircuit;
  data["multiplier"] = model.name;
  data["scale_v"] = plain_number(model.scale_v);
  double inverse = 1.0 / model.scale_v;
  data["spoilt"] = multiplier.off.has_value();
  if (multiplier.off) {
    const multiplier_layout::MultiplierDeviation& off = *multiplier.off;
    inverse *= (1.0 + off.bend) / (1.0 + off.scale);
    data["input_offset_v"] = plain_number(off.x);
    data["second_offset_v"] = plain_number(off.y);
    data["output_offset_v"] = plain_number(off.w);
  }
  data["inverse_scale"] = plain_number(inverse);
  data["bandwidth_hz"] = plain_number(model.bandwidth.value);
  data["pole_f"] = plain_number(1.0 / model.bandwidth.rad_s().value);
  data["limit_v"] = plain_number(model.greatest_output_v);
  return without_end(render_template("spice/multiplier.sub", data));
}

std::string switch_subcircuit(const multiplier_layout::SwitchModel& model) {
  const multiplier_layout::SwitchTimer timer = multiplier_layout::SwitchTimer::of(model);
  Json data;
  data["charge_c"] = plain_number(model.charge_c);
  data["off_siemens"] = plain_number(model.off_siemens);
  data["on_siemens"] = plain_number(1.0 / std::max(model.on_ohm, 1e-3));
  data["level"] = plain_number(timer.level);
  data["timer_f"] = plain_number(timer.tau_s / 1000.0);
  data["charge_f"] = plain_number(model.charge_c / kGateSwing);
  data["source_f"] = plain_number(model.source_f);
  data["drain_f"] = plain_number(std::max(model.drain_f - model.charge_c / kGateSwing, 0.0));
  return without_end(render_template("spice/switch.sub", data));
}

std::string diode_model(const multiplier_layout::DiodeModel& model) {
  return fmt::format(".model bodesmith_diode D(IS={} N={} RS={} CJO={} TT={})",
                     plain_number(model.saturation_a), plain_number(model.emission),
                     plain_number(model.series_ohm), plain_number(model.junction_f),
                     plain_number(model.transit_s));
}

}  // namespace bodesmith::spice
