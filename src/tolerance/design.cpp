#include "tolerance/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/drawn_board.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::tolerance {
namespace {

/// A CAM whose capacitors do not make what the file says of it.
void check_cams(const fpaa::Plan& board, const Node& plan) {
  std::size_t chip_index = 0;
  const std::vector<Node> chips = plan.at("chips").items();
  for (const fpaa::ChipPlan& chip : board.chips) {
    const std::vector<Node> cams = chips.at(chip_index++).at("cams").items();
    for (std::size_t c = 0; c < chip.cams.size(); ++c) {
      const fpaa::PlacedCam& cam = chip.cams[c];
      const fpaa::ZTransfer made = cam.cam->transfer(cam, fpaa::CapacitorUnits(cam.capacitors));
      for (std::size_t i = 1; i <= cam.input_count(); ++i) {
        for (const double share : {0.01, 0.1, 0.4}) {
          const RadPerSecond w = Hertz{share * cam.clock_a.value}.rad_s();
          const Complex x = made.response(w, cam.clock_a, i), y = cam.z.response(w, cam.clock_a, i);
          if (std::abs(x - y) <= 1e-6 * (std::abs(x) + std::abs(y))) continue;
          cams[c].at("capacitors").fail("do not make the CAM's z_numerators and z_denominator");
        }
      }
    }
  }
}

Design design_from_parts(const schematic::Netlist& netlist) {
  Design out;
  out.netlist = std::make_shared<const schematic::Netlist>(netlist);
  for (const schematic::Part& part : netlist.parts) {
    out.parts.push_back(
        {part.name,
         part.kind == schematic::Part::Kind::resistor ? Part::Kind::resistor : Part::Kind::capacitor,
         part.realised});
  }
  return out;
}

/// Parts and stages of a circuit.
Design design_from_stages(const synthesis::Circuit& circuit, std::function<Complex(Hertz)> wanted,
                          OpAmps opamps) {
  Design out = design_from_parts(circuit);
  for (const synthesis::Stage& stage : circuit.stages) {
    Stage one;
    one.name = fmt::format("stage{}", out.stages.size() + 1);
    one.first_part = stage.first_part;
    one.part_count = stage.part_count;
    if (!stage.form) {
      out.stages.clear();
      break;
    }
    one.transfer = [form = stage.form](std::span<const double> v) { return form->transfer(v); };
    out.stages.push_back(std::move(one));
  }
  out.wanted = std::move(wanted);
  if (opamps == OpAmps::as_built && !circuit.opamp.is_ideal) {
    out.notes.push_back(
        fmt::format("with the op-amps' own error ({}), at the nominal parts", circuit.opamp.name));
    out.opamps = [circuit](Hertz f) {
      return schematic::network_response(circuit, {f}).front() / circuit.response(f.rad_s());
    };
  }
  out.reference_name = "sections";
  return out;
}

}  // namespace

std::vector<Hertz> leave_out_nulls(const std::vector<Design>& designs, std::vector<Hertz>& grid) {
  std::vector<Hertz> left_out, kept;
  std::vector<double> largest;
  for (const Design& design : designs) {
    largest.push_back(0.0);
    for (const Hertz f : grid) largest.back() = std::max(largest.back(), std::abs(design.wanted(f)));
  }
  for (const Hertz f : grid) {
    bool null = false;
    for (std::size_t i = 0; i < designs.size(); ++i)
      null = null || !(std::abs(designs[i].wanted(f)) > kJudgedFloor * largest[i]);
    (null ? left_out : kept).push_back(f);
  }
  grid = std::move(kept);
  return left_out;
}

Complex Design::response(Hertz f, std::span<const double> values) const {
  if (board) return fpaa::DrawnBoard(*board, {f}).response(values)[0];
  if (stages.empty())
    return schematic::ResponseOfParts(*netlist, {f}, {.ideal_opamps = ideal_opamps}).at(values)[0];
  Complex h = 1.0;
  for (const Stage& stage : stages)
    h *= stage.transfer(values.subspan(stage.first_part, stage.part_count)).response(f.rad_s());
  return h;
}

std::vector<double> Design::nominal_values() const {
  std::vector<double> out;
  for (const Part& part : parts) out.push_back(part.nominal);
  return out;
}

Complex Design::nominal(Hertz f) const {
  return response(f, nominal_values());
}

bool Design::is_quick() const {
  const std::vector<double> values = nominal_values();
  return !stages.empty() && std::ranges::none_of(stages, [&](const Stage& stage) {
    return stage.transfer(std::span(values).subspan(stage.first_part, stage.part_count)).a0 == 0.0;
  });
}

Design design_of_circuit(const synthesis::Circuit& circuit, const Sections& wanted, std::string name,
                         OpAmps opamps) {
  Design out = design_from_stages(
      circuit, [wanted](Hertz f) { return wanted.response(f.rad_s()); }, opamps);
  out.name = std::move(name);
  out.band = synthesis::judged_band(wanted);
  out.band_name = wanted.error ? "the sections' own band" : "the corners";
  out.poles = wanted.pole_count();
  return out;
}

Design design_of_file(const Node& node, std::string name, OpAmps opamps) {
  const synthesis::CircuitFile file = synthesis::CircuitFile::from_node(node);
  Design out = design_from_stages(
      file.circuit, [file](Hertz f) { return file.wanted(f.rad_s()); }, opamps);
  out.name = std::move(name);
  out.band = file.band;
  out.band_name = "the circuit's own band";
  for (const synthesis::Stage& stage : file.circuit.stages) {
    for (const synthesis::Biquad& factor : stage.wanted)
      out.poles += factor.a2 != 0.0 ? 2 : factor.a1 != 0.0 ? 1 : 0;
  }
  return out;
}

Design design_of_netlist(const schematic::Netlist& netlist, std::string name) {
  Design out = design_from_parts(netlist);
  out.name = std::move(name);
  out.ideal_opamps = false;
  if (!netlist.opamps.empty())
    out.notes.push_back(fmt::format("with its op-amps ({}), which are not drawn", netlist.opamp.name));
  Part least[2], most[2];  // of resistors and of capacitors
  for (const Part& part : out.parts) {
    const std::size_t kind = part.kind == Part::Kind::resistor ? 0 : 1;
    if (least[kind].name.empty() || part.nominal < least[kind].nominal) least[kind] = part;
    if (part.nominal > most[kind].nominal) most[kind] = part;
  }
  if (least[0].name.empty() || least[1].name.empty())
    throw InputError(fmt::format("{}: has no resistors or no capacitors, expected both", out.name));
  out.band = {RadPerSecond{0.1 / (most[0].nominal * most[1].nominal)}.hz(),
              RadPerSecond{10.0 / (least[0].nominal * least[1].nominal)}.hz()};
  out.band_name = "its resistors times its capacitors";
  out.reference_name = "nominal";
  out.wanted = [netlist = out.netlist](Hertz f) { return schematic::network_response(*netlist, {f})[0]; };
  const Hertz middle{std::sqrt(out.band.from.value * out.band.to.value)};
  const double gain = std::abs(out.wanted(middle));
  if (!std::isfinite(gain) || gain == 0.0)
    throw InputError(fmt::format("{}: has no response at {}, expected one from in to out", out.name,
                                 engineering_text(middle.value, "Hz", 4)));
  return out;
}

Design design_of_plan(const Node& plan, std::string name, const std::optional<Sections>& wanted) {
  plan.expect_schema("fpaa_plan");
  Design out;
  out.name = std::move(name);
  const auto board = std::make_shared<const fpaa::Plan>(fpaa::Plan::from_node(plan));
  if (board->cams().empty()) plan.at("chips").fail("holds no CAM, expected at least one");
  check_cams(*board, plan);
  const std::vector<double> band = plan.at("error").at("band_hz").numbers();
  if (band.size() != 2 || !(band[0] > 0.0) || !(band[1] > band[0]))
    plan.at("error").at("band_hz").fail("expected [from, to]");
  out.band = {Hertz{band[0]}, Hertz{band[1]}};
  out.band_name = "the plan's own band";
  out.board = board;
  const fpaa::DrawnBoard drawn(*board, {});
  for (std::size_t i = 0; i < drawn.capacitor_count(); ++i)
    out.parts.push_back({drawn.names()[i], Part::Kind::switched_capacitor, drawn.nominal_units()[i]});
  for (const fpaa::PlacedCam* cam : board->cams())
    out.poles += static_cast<int>(cam->z.denominator.size()) - 1;
  out.reference_name = wanted ? "sections" : "nominal";
  if (wanted) {
    out.wanted = [wanted = *wanted](Hertz f) { return wanted.response(f.rad_s()); };
  } else {
    out.wanted = [board, values = drawn.nominal_units()](Hertz f) {
      return fpaa::DrawnBoard(*board, {f}).response(values)[0];
    };
  }
  return out;
}

}  // namespace bodesmith::tolerance
