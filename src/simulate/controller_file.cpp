#include "simulate/controller_file.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/documents/document.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "chain/sections_chain.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {

LoopSetup read_controller(const std::filesystem::path& path, Provenance& from) {
  return controller_from_node(read_document(path, from), path.parent_path(), from);
}

LoopSetup controller_from_node(const Node& node, const std::filesystem::path& folder, Provenance& from) {
  node.expect_schema("controller");
  node.allow_only({"schema", "name", "about", "type", "kp", "ki_per_s", "kd_s", "derivative_corner_hz",
                   "sample_s", "lower", "upper", "feedforward", "filter", "program", "inputs", "tuning",
                   "timing_s"});
  LoopSetup out;
  PidController& c = out.controller;
  const bool derivative = node.at("type").one_of({"pi", "pid"}) == "pid";
  c.proportional = node.number_or("kp", 0.0);
  c.integral_per_s = node.at("ki_per_s").number();
  if (derivative) {
    c.derivative_s = node.at("kd_s").number();
    if (node.has("derivative_corner_hz"))
      c.derivative_corner = Hertz{node.at("derivative_corner_hz").positive()};
  } else {
    for (const char* key : {"kd_s", "derivative_corner_hz"}) {
      if (node.has(key)) node.at(key).fail("belongs to a pid, expected type = \"pid\"");
    }
  }
  if (node.has("sample_s")) c.period_s = node.at("sample_s").positive();
  c.lower = node.number_or("lower", c.lower);
  c.upper = node.number_or("upper", c.upper);
  if (!(c.lower < c.upper)) node.at("upper").fail("is not above lower");
  if (node.has("filter")) {
    if (node.has("feedforward"))
      node.at("filter").fail("stands together with a feedforward, expected one of them");
    const Node filter = node.at("filter");
    out.filter = filter.kind() == Node::Kind::string ? Sections::read(folder / filter.string(), from)
                                                     : Sections::from_node(filter);
  }
  if (node.has("feedforward")) {
    const Node file = node.at("feedforward");
    const std::filesystem::path target = folder / file.string();
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(target, ignored))
      file.fail(fmt::format("names {}, which is not there", target.string()));
    if (target.extension() == ".csv") {
      out.drive = TimeRecord::read_csv(target, from);
    } else if (read_document(target, from).string_or("schema", "") == "bodesmith.inverse/1") {
      out.inverse = target;
    } else {
      out.feedforward = chain::read_model(target, from);
    }
  }
  return out;
}

namespace {

/// The filter as the plant's first blocks; what the loop then calls its drive goes through it once more.
LoopResult simulate_filtered_loop(const chain::Chain& plant, const LoopSetup& setup,
                                  const TimeRecord& reference, const Options& options) {
  const chain::Chain filter = chain::chain_of(*setup.filter);
  chain::Chain whole = plant;
  whole.blocks.insert(whole.blocks.begin(), filter.blocks.begin(), filter.blocks.end());
  LoopResult out = simulate_loop(whole, std::nullopt, setup.controller, reference, options);
  TimeRecord control = reference;
  control.y.clear();
  control.u = out.drive;
  Options once;
  once.start = start_of(plant, options.start);
  out.drive = simulate(filter, control, once).y;
  return out;
}

}  // namespace

LoopResult simulate_loop(const chain::Chain& plant, const LoopSetup& setup, const TimeRecord& reference,
                         const Options& options) {
  if (setup.filter) return simulate_filtered_loop(plant, setup, reference, options);
  if (!setup.drive) return simulate_loop(plant, setup.feedforward, setup.controller, reference, options);
  const TimeRecord& drive = *setup.drive;
  const bool same_times = drive.size() == reference.size() &&
                          std::abs(drive.step_s - reference.step_s) <= 1e-6 * reference.step_s &&
                          std::abs(drive.start_s - reference.start_s) <= 0.01 * reference.step_s;
  if (!same_times) {
    throw InputError(fmt::format(
        "{}: {} samples from {} s, {} s apart, expected those of the reference ({} from {} s, {} s apart)",
        drive.file, drive.size(), rounded_text(drive.start_s), rounded_text(drive.step_s), reference.size(),
        rounded_text(reference.start_s), rounded_text(reference.step_s)));
  }
  return simulate_loop(plant, drive.u, setup.controller, reference, options);
}

}  // namespace bodesmith::simulate
