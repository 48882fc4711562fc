#include "project/output/as_model.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "base/error.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "chain/sections_chain.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/plan/plan_graph.hpp"
#include "project/output/circuit_model.hpp"
#include "synthesis/circuit_file.hpp"

namespace bodesmith::project {
namespace {

using chain::Block;
using chain::chain_of;
using chain::make_block;
using chain::stage_block;

/// Of c0 + c1/z + c2/z^2, without those at z = 0 and infinity.
std::vector<Complex> z_roots(std::vector<double> c) {
  while (!c.empty() && c.front() == 0.0) c.erase(c.begin());
  const double a = c.empty() ? 0.0 : c[0], b = c.size() > 1 ? c[1] : 0.0, d = c.size() > 2 ? c[2] : 0.0;
  if (d != 0.0) {
    const Complex root = std::sqrt(Complex(b * b - 4.0 * a * d));
    // The greater of both first: the other one without cancellation.
    const Complex q = -0.5 * (b + (b >= 0.0 ? root : -root));
    return {q / a, d / q};
  }
  return b == 0.0 ? std::vector<Complex>{} : std::vector<Complex>{-b / a};
}

std::vector<Complex> analog_roots(const std::vector<double>& c, double clock_hz) {
  std::vector<Complex> out;
  for (const Complex& z : z_roots(c)) {
    if (std::abs(z.imag()) < 1e-12 * std::abs(z) && z.real() <= 0.0) continue;
    out.push_back(clock_hz * std::log(z));
  }
  return out;
}

/// The CAM's section, equal to it at 0 Hz, or, where it is 0 there, at its poles' frequency.
Section section_of(const fpaa::PlacedCam& cam) {
  const double clock = cam.clock_a.value;
  Section out;
  out.zeros = analog_roots(cam.z.numerators[0], clock);
  out.poles = analog_roots(cam.z.denominator, clock);
  RadPerSecond w{0.0};
  if (std::abs(cam.z.dc_gain()) < 1e-9 && !out.poles.empty()) w = {std::abs(out.poles.front())};
  const Complex ratio = cam.z.response(w, cam.clock_a) / out.response(Complex(0.0, w.value));
  out.gain = std::copysign(std::abs(ratio), ratio.real());
  return out;
}

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

/// Its CAMs: the analog sections whose roots, z = exp(s/clock), are those that the capacitors make; a zero that no s has (z <= 0)
/// lies at infinity. Holds are not in it.
std::vector<Block> from_plan(const Node& node, ModelRequest&) {
  const fpaa::Plan plan = fpaa::Plan::from_node(node);
  const fpaa::PlanGraph graph = value_or_throw(fpaa::plan_graph(plan));
  if (!graph.output.node) node.fail("has no output that is wired");
  // From the output back to the pin.
  std::vector<Block> out;
  for (std::optional<std::size_t> at = graph.output.node; at;) {
    const fpaa::PlanGraph::PlanNode& cam = graph.nodes[*at];
    if (cam.inputs.size() != 1)
      node.fail(fmt::format("is no chain: {} takes {} inputs, expected one", cam.name, cam.inputs.size()));
    const std::vector<Block> blocks = stage_blocks(section_of(*cam.cam), cam.cam->name);
    out.insert(out.begin(), blocks.begin(), blocks.end());
    at = cam.inputs.front().from.node;
  }
  return out;
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
