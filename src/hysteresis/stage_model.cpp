#include "hysteresis/stage_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "hysteresis/registry.hpp"

namespace bodesmith::hysteresis {

std::vector<double> delayed(const std::vector<double>& u, double step_s, double delay_s) {
  if (delay_s == 0.0 || u.empty()) return u;
  std::vector<double> out(u.size());
  const double shift = delay_s / step_s;
  const double last = static_cast<double>(u.size() - 1);
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double at = std::clamp(static_cast<double>(i) - shift, 0.0, last);
    const auto k = std::min(static_cast<std::size_t>(at), u.size() - 1);
    const double fraction = at - static_cast<double>(k);
    out[i] = fraction == 0.0 ? u[k] : u[k] + fraction * (u[k + 1] - u[k]);
  }
  return out;
}

std::vector<double> StageModel::simulate(const std::vector<double>& u, double step_s) const {
  if (u.empty()) return {};
  std::vector<double> y(u.size());
  if (model.type.empty()) {
    for (std::size_t i = 0; i < u.size(); ++i)
      y[i] = output_offset + output_gain * (input_offset + input_gain * u[i]);
    return delayed(y, step_s, delay_s);
  }
  const std::unique_ptr<Operator> hysteresis = make_operator(model);
  y[0] = output_offset + output_gain * hysteresis->reset(input_offset + input_gain * u[0]);
  for (std::size_t i = 1; i < u.size(); ++i) {
    y[i] = output_offset + output_gain * hysteresis->step(input_offset + input_gain * u[i], step_s);
  }
  // A delay commutes with everything time-invariant; behind the operator it leaves the turning points where
  // the samples are.
  return delayed(y, step_s, delay_s);
}

std::string StageModel::to_toml(const std::vector<std::string>& remarks) const {
  std::string out;
  for (const std::string& remark : remarks) out += "# " + remark + "\n";
  out += "schema = \"bodesmith.model/1\"\n";
  if (input_gain != 1.0 || input_offset != 0.0) {
    out += fmt::format("\n[[block]]\ntype = \"gain\"\ngain = {}\noffset = {}\n", number_text(input_gain),
                       number_text(input_offset));
  }
  if (!model.type.empty()) out += "\n[[block]]\n" + bodesmith::hysteresis::to_toml(model);
  if (output_gain != 1.0 || output_offset != 0.0) {
    out +=
        fmt::format("\n[[block]]\ntype = \"gain\"\ngain = {}\noffset = {}\nfree = [\"gain\", \"offset\"]\n",
                    number_text(output_gain), number_text(output_offset));
  }
  if (delay_s != 0.0) {
    out += fmt::format("\n[[block]]\ntype = \"delay\"\ndelay_s = {}\nfree = [\"delay_s\"]\n",
                       number_text(delay_s));
  }
  return out;
}

StageModel stage_model_from_node(const Node& document) {
  document.expect_schema("model");
  StageModel out;
  const Node blocks = document.at("block");
  if (blocks.size() == 0) blocks.fail("is empty, expected at least one block");
  for (const Node& block : blocks.items()) {
    const std::string type = block.at("type").string();
    if (type == "gain") {
      block.allow_only({"type", "gain", "offset", "free"});
      const double gain = block.at("gain").number();
      const double offset = block.number_or("offset", 0.0);
      if (out.model.type.empty()) {
        out.input_gain *= gain;
        out.input_offset = out.input_offset * gain + offset;
      } else {
        out.output_gain *= gain;
        out.output_offset = out.output_offset * gain + offset;
      }
    } else if (type == "delay") {
      block.allow_only({"type", "delay_s", "free"});
      out.delay_s += block.at("delay_s").non_negative();
    } else {
      if (find_model_type(type) == nullptr) {
        block.at("type").fail(fmt::format(
            "is \"{}\", which has no exact inverse here, expected gain, delay or a hysteresis model", type));
      }
      if (!out.model.type.empty())
        block.at("type").fail("is a second hysteresis model, expected at most one");
      out.model = model_from_node(block);
    }
  }
  return out;
}

Compensation compensate(const StageModel& stage, const std::vector<double>& reference, double step_s,
                        bool preview) {
  Compensation out;
  const std::size_t n = reference.size();
  out.drive.resize(n);
  if (n == 0) return out;
  const std::vector<double> ahead = preview ? delayed(reference, step_s, -stage.delay_s) : reference;
  if (stage.model.type.empty()) {
    for (std::size_t i = 0; i < n; ++i) {
      out.drive[i] =
          ((ahead[i] - stage.output_offset) / stage.output_gain - stage.input_offset) / stage.input_gain;
    }
  } else {
    const std::unique_ptr<Inverse> inverse = make_inverse(stage.model);
    double range = 0.0;
    const auto [lowest, highest] = std::minmax_element(ahead.begin(), ahead.end());
    range = std::max(*highest - *lowest, 1e-300);
    for (std::size_t i = 0; i < n; ++i) {
      const double wanted = (ahead[i] - stage.output_offset) / stage.output_gain;
      const double u = i == 0 ? inverse->reset(wanted) : inverse->step(wanted, step_s);
      if (std::abs((inverse->achieved() - wanted) * stage.output_gain) > 1e-6 * range) ++out.out_of_reach;
      out.drive[i] = (u - stage.input_offset) / stage.input_gain;
    }
  }
  out.predicted = stage.simulate(out.drive, step_s);
  return out;
}

}  // namespace bodesmith::hysteresis
