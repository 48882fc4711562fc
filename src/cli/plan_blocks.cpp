#include "cli/plan_blocks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>

#include "chain/registry.hpp"
#include "chain/sections_chain.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/plan/plan_graph.hpp"

namespace bodesmith::cli {
namespace {

using Complex = std::complex<double>;

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
  out.zeros = analog_roots(cam.z.numerator, clock);
  out.poles = analog_roots(cam.z.denominator, clock);
  RadPerSecond w{0.0};
  if (std::abs(cam.z.dc_gain()) < 1e-9 && !out.poles.empty()) w = {std::abs(out.poles.front())};
  const Complex ratio = cam.z.response(w, cam.clock_a) / out.response(Complex(0.0, w.value));
  out.gain = std::copysign(std::abs(ratio), ratio.real());
  return out;
}

}  // namespace

std::vector<chain::Block> plan_blocks(const Node& node) {
  const fpaa::Plan plan = fpaa::Plan::from_node(node);
  const fpaa::PlanGraph graph = value_or_throw(fpaa::plan_graph(plan));
  if (!graph.output || !graph.output->node) node.fail("has no output that is wired");
  // From the output back to the pin.
  std::vector<chain::Block> out;
  for (std::optional<std::size_t> at = graph.output->node; at;) {
    const fpaa::PlanGraph::PlanNode& cam = graph.nodes[*at];
    if (cam.inputs.size() != 1)
      node.fail(fmt::format("is no chain: {} takes {} inputs, expected one", cam.name, cam.inputs.size()));
    const Section section = section_of(*cam.cam);
    std::vector<chain::Block> blocks;
    if (section.poles.empty()) {
      blocks = {chain::make_block("gain").set("gain", section.gain)};
      blocks.front().part = cam.cam->name;
    } else {
      Sections one;
      one.sections = {section};
      blocks = chain::chain_of(one, cam.cam->name).blocks;
      for (chain::Block& block : blocks) {
        // Its one section is the CAM.
        if (block.part.starts_with(cam.cam->name + "1")) block.part.erase(cam.cam->name.size(), 1);
      }
    }
    out.insert(out.begin(), blocks.begin(), blocks.end());
    at = cam.inputs.front().from.node;
  }
  return out;
}

}  // namespace bodesmith::cli
