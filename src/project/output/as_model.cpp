#include "project/output/as_model.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "base/error.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "chain/sections_chain.hpp"
#include "fpaa/plan/plan.hpp"
#include "project/output/circuit_model.hpp"
#include "project/output/plan_model.hpp"
#include "synthesis/circuit_file.hpp"

namespace bodesmith::project {
namespace {

using chain::Block;
using chain::chain_of;
using chain::make_block;
using chain::stage_block;

std::vector<Block> from_sections(const Node& node, ModelRequest&) {
  return chain_of(Sections::from_node(node), "Section").blocks;
}

std::vector<Block> from_cascade(const Node& node, ModelRequest&) {
  return chain_of(Cascade::from_node(node)).blocks;
}

Block lag_block(const std::string& kind, double seconds) {
  Block out = kind == "delay"
                  ? make_block("delay").set("delay_s", seconds)
                  : make_block("lowpass").set("corner_hz", 1.0 / (2.0 * std::numbers::pi * seconds));
  out.part = kind == "pole in front of the stage" ? "amplifier" : kind == "delay" ? "delay" : "sensor";
  return out;
}

Block scale_block(const char* name, double gain, double offset) {
  Block out = make_block("gain").set("gain", gain).set("offset", offset);
  out.part = name;
  return out;
}

/// The stage; with what identify found of its drive, output and lag where the file says so.
std::vector<Block> from_disturbance(const Node& node, ModelRequest& asked) {
  asked.used = true;
  const Disturbance given = Disturbance::from_node(node);
  const Disturbance disturbance = asked.load_stroke ? given.at_load(*asked.load_stroke) : given;
  const double base = disturbance.rate.frequency.empty() ? 0.0 : disturbance.rate.frequency.front().value;
  const Block stage = stage_block(disturbance, asked.operating.value_or(Hertz{base}));
  if (!node.has("identified")) return {stage};
  const Node found = node.at("identified");
  const double low = found.at("input").at("low").number();
  const double high = found.at("input").at("high").number();
  if (!(high > low)) found.at("input").at("high").fail("is not above low");
  // Under a load the same drive makes a shorter stroke.
  const double left = asked.load_stroke.value_or(1.0);
  std::vector<Block> out = {scale_block("drive", 1.0 / (high - low), -low / (high - low)), stage,
                            scale_block("output", left * found.at("output").at("stroke").number(),
                                        found.at("output").at("offset").number())};
  const std::string kind = found.at("lag").at("kind").string();
  const double seconds = found.at("lag").at("lag_s").number();
  if (seconds > 0.0) {
    // The drive's scale has no offset behind a lag: in front of the stage it stands behind the scale.
    const Block lag = lag_block(kind, seconds);
    out.insert(lag.part == "amplifier" ? out.begin() + 1 : out.end(), lag);
  }
  return out;
}

std::vector<Block> from_plan(const Node& node, ModelRequest& asked) {
  PlanModel out = plan_model(fpaa::Plan::from_node(node));
  asked.boards.push_back({out.stated, out.worst_percent});
  return std::move(out.blocks);
}

using Reader = std::vector<Block> (*)(const Node&, ModelRequest&);

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> all = {
      {"bodesmith.sections/1", from_sections},
      {"bodesmith.cascade/1", from_cascade},
      {"bodesmith.circuit/1",
       [](const Node& node, ModelRequest&) {
         return circuit_blocks(synthesis::CircuitFile::from_node(node).circuit);
       }},
      {"bodesmith.fpaa_plan/1", from_plan},
      {"bodesmith.disturbance/1", from_disturbance}};
  return all;
}

}  // namespace

chain::Chain as_model(const std::filesystem::path& path, ModelRequest& asked, Provenance& from) {
  if (std::filesystem::is_directory(path)) {
    if (!std::filesystem::exists(path / "model.toml"))
      throw InputError(path.string(), 0, "has no model.toml, expected a folder that bodesmith run wrote");
    return chain::read_model(path / "model.toml", from);
  }
  if (path.extension() == ".csv")
    throw InputError(
        path.string(), 0,
        "is a table, expected what was designed or built, or a run's folder; records become models by identify, "
        "responses by fit");
  const Node node = read_document(path, from);
  const std::string schema = node.at("schema").string();
  if (schema == "bodesmith.model/1") return chain::model_from_node(node);
  const auto reader = readers().find(schema);
  if (reader == readers().end())
    node.at("schema").fail(fmt::format(
        "is '{}', expected bodesmith.sections/1, cascade/1, circuit/1, fpaa_plan/1, disturbance/1 or model/1, or a run's "
        "folder",
        schema));
  chain::Chain out;
  out.blocks = reader->second(node, asked);
  return out;
}

}  // namespace bodesmith::project
