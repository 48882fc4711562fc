#include "tolerance/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/drawn_board.hpp"
#include "lti/judging_grid.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/built_circuit.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/stages/stage_form.hpp"

namespace bodesmith::yield {
namespace {

using Complex = std::complex<double>;

Complex variable(const Stage& stage, Hertz f) {
  if (stage.clock_hz == 0.0) return {0.0, f.rad_s().value};
  return 1.0 - std::polar(1.0, -f.rad_s().value / stage.clock_hz);
}

/// Coefficients in v = 1 - 1/z of a polynomial in 1/z of degree at most 2.
std::array<double, 3> in_v(const std::vector<double>& z) {
  const double c0 = !z.empty() ? z[0] : 0.0, c1 = z.size() > 1 ? z[1] : 0.0, c2 = z.size() > 2 ? z[2] : 0.0;
  return {c0 + c1 + c2, -c1 - 2.0 * c2, c2};
}

circuit::Biquad from_z(const Node& cam) {
  const std::vector<double> numerator = cam.at("z_numerator").numbers(),
                            denominator = cam.at("z_denominator").numbers();
  if (numerator.empty() || numerator.size() > 3)
    cam.at("z_numerator").fail("expected one to three coefficients");
  if (denominator.empty() || denominator.size() > 3)
    cam.at("z_denominator").fail("expected one to three coefficients");
  const auto n = in_v(numerator), d = in_v(denominator);
  return {n[0], n[1], n[2], d[0], d[1], d[2]};
}

/// Same transfer up to a common factor.
bool same(const circuit::Biquad& a, const circuit::Biquad& b) {
  for (const double w : {0.01, 0.3, 1.0, 2.0}) {
    const Complex v = 1.0 - std::polar(1.0, -w);
    const Complex x = a.response(v), y = b.response(v);
    if (!(std::abs(x - y) <= 1e-6 * (std::abs(x) + std::abs(y)))) return false;
  }
  return true;
}

/// At one clock, each pin and CAM wired to one other.
bool is_one_path(const fpaa::Plan& plan) {
  std::set<std::string> sources;
  for (const fpaa::Wire& wire : plan.wires) {
    if (wire.input != 1 || !sources.insert(wire.from).second) return false;
  }
  const auto cams = plan.cams();
  return std::all_of(cams.begin(), cams.end(), [&](const fpaa::PlacedCam* cam) {
    return cam->input_count() == 1 && cam->delay_cycles == 0.0 &&
           cam->clock_a.value == cams[0]->clock_a.value;
  });
}

class PlanReader {
 public:
  explicit PlanReader(std::string name) { out_.name = std::move(name); }

  Design read(const Node& plan, bool wanted) {
    plan.expect_schema("fpaa_plan");
    double low = INFINITY, high = 0.0;
    for (const Node& chip : plan.at("chips").items()) {
      for (const Node& cam : chip.at("cams").items()) {
        read_cam(cam, fmt::format("chip{}.{}", chip.at("chip").integer(1, 1000), cam.at("name").string()));
      }
    }
    if (out_.parts.empty()) plan.at("chips").fail("holds no CAM, expected at least one");
    const fpaa::Plan board = fpaa::Plan::from_node(plan);
    if (!is_product_ || wanted || !is_one_path(board)) {
      check_board(board, plan);
      out_.stages.clear();
      out_.board = std::make_shared<const fpaa::Plan>(board);
    }
    const std::vector<double> band = plan.at("error").at("band_hz").numbers();
    if (band.size() == 2 && band[0] > 0.0 && band[1] > band[0]) {
      low = band[0];
      high = band[1];
    } else {
      plan.at("error").at("band_hz").fail("expected [from, to]");
    }
    out_.band = {Hertz{low}, Hertz{high}};
    out_.reference_name = "nominal";
    out_.band_name = "the plan's own band";
    return std::move(out_);
  }

 private:
  void read_cam(const Node& cam, const std::string& name) {
    Stage stage;
    stage.name = name;
    stage.clock_hz = cam.at("clock_a_hz").positive();
    stage.first_part = out_.parts.size();
    std::vector<std::string> names;
    for (const auto& [key, value] : cam.at("capacitors").members()) {
      names.push_back(key);
      out_.parts.push_back({name + "." + key, Part::Kind::switched_capacitor, value.non_negative()});
    }
    stage.part_count = names.size();
    const circuit::Biquad nominal = from_z(cam);
    const auto at = [&](const char* key) {
      return static_cast<size_t>(std::find(names.begin(), names.end(), key) - names.begin());
    };
    const size_t none = names.size();
    if (at("Ca") < none && at("Cb") < none && at("Cc") < none && at("Cd") < none && none == 4) {
      const size_t a = at("Ca"), b = at("Cb"), c = at("Cc"), d = at("Cd");
      stage.transfer = [=](std::span<const double> v) {
        return circuit::Biquad{-v[a], -v[b], 0.0, v[c], v[d], 0.0};
      };
      out_.poles += 1;
    } else if (at("Cin") < none && at("Cout") < none && at("Cint") < none && none == 3) {
      const size_t i = at("Cin"), o = at("Cout"), t = at("Cint");
      stage.transfer = [=](std::span<const double> v) {
        return circuit::Biquad{-v[i], 0.0, 0.0, v[o], v[t], 0.0};
      };
      out_.poles += 1;
    } else if (at("Cin") < none && at("Cout") < none && none == 2 && cam.at("cam").string() == "GainInv") {
      const size_t i = at("Cin"), o = at("Cout");
      stage.transfer = [=](std::span<const double> v) {
        return circuit::Biquad{-v[i], 0.0, 0.0, v[o], 0.0, 0.0};
      };
    } else {
      out_.poles += nominal.a2 != 0.0 ? 2 : (nominal.a1 != 0.0 ? 1 : 0);
      is_product_ = false;
      return;
    }
    std::vector<double> values;
    for (std::size_t i = 0; i < stage.part_count; ++i) {
      values.push_back(out_.parts[stage.first_part + i].nominal);
    }
    if (!same(stage.transfer(values), nominal)) {
      cam.at("capacitors")
          .fail(
              "do not make z_numerator and z_denominator, expected -(Ca + Cb v)/(Cc + Cd v) or -Cin/(Cout + "
              "Cint v)");
    }
    out_.stages.push_back(std::move(stage));
  }

  /// A CAM whose capacitors do not make what the file says of it.
  static void check_board(const fpaa::Plan& board, const Node& plan) {
    std::size_t chip_index = 0;
    const std::vector<Node> chips = plan.at("chips").items();
    for (const fpaa::ChipPlan& chip : board.chips) {
      const std::vector<Node> cams = chips.at(chip_index++).at("cams").items();
      for (std::size_t c = 0; c < chip.cams.size(); ++c) {
        const fpaa::PlacedCam& cam = chip.cams[c];
        const auto made = cam.cam->transfers(cam, fpaa::CapacitorUnits(cam.capacitors));
        for (std::size_t i = 0; i < made.size(); ++i) {
          for (const double share : {0.01, 0.1, 0.4}) {
            const RadPerSecond w = Hertz{share * cam.clock_a.value}.rad_s();
            const Complex x = made[i].response(w, cam.clock_a),
                          y = cam.z_from(i + 1).response(w, cam.clock_a);
            if (std::abs(x - y) <= 1e-6 * (std::abs(x) + std::abs(y))) continue;
            cams[c].at("capacitors").fail("do not make the CAM's z_numerators and z_denominator");
          }
        }
      }
    }
  }

  Design out_;
  bool is_product_ = true;
};

/// Parts and stages of a circuit.
Design design_from_parts(const circuit::Circuit& circuit, std::function<Complex(Hertz)> wanted,
                         OpAmps opamps) {
  Design out;
  out.netlist = std::make_shared<const schematic::Netlist>(circuit);
  for (const schematic::Part& part : circuit.parts) {
    out.parts.push_back(
        {part.name,
         part.kind == schematic::Part::Kind::resistor ? Part::Kind::resistor : Part::Kind::capacitor,
         part.realised});
  }
  for (const circuit::Stage& stage : circuit.stages) {
    Stage one;
    one.name = fmt::format("stage{}", out.stages.size() + 1);
    one.first_part = stage.first_part;
    one.part_count = stage.part_count;
    one.by_parts = circuit::ladder_response(stage);
    if (stage.form)
      one.transfer = [form = stage.form](std::span<const double> v) { return form->transfer(v); };
    if (!one.by_parts && !one.transfer)
      throw DesignError(fmt::format("{} has no equations for other values of its parts", stage.realisation));
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
  Complex h = 1.0;
  for (const Stage& stage : stages) {
    if (stage.by_parts) {
      h *= stage.by_parts(values.subspan(stage.first_part, stage.part_count), f.rad_s());
      continue;
    }
    h *= stage.transfer(values.subspan(stage.first_part, stage.part_count)).response(variable(stage, f));
  }
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
  return !board && std::none_of(stages.begin(), stages.end(), [&](const Stage& stage) {
    return stage.by_parts ||
           stage.transfer(std::span(values).subspan(stage.first_part, stage.part_count)).a0 == 0.0;
  });
}

Design design_of_circuit(const circuit::Circuit& circuit, const Sections& wanted, std::string name,
                         OpAmps opamps) {
  Design out = design_from_parts(
      circuit, [wanted](Hertz f) { return wanted.response(f.rad_s()); }, opamps);
  out.name = std::move(name);
  out.band = circuit::judged_band(wanted);
  out.band_name = wanted.error ? "the sections' own band" : "the corners";
  out.poles = wanted.pole_count();
  return out;
}

Design design_of_file(const Node& node, std::string name, OpAmps opamps) {
  const circuit::CircuitFile file = circuit::CircuitFile::from_node(node);
  Design out = design_from_parts(
      file.circuit, [file](Hertz f) { return file.wanted(f.rad_s()); }, opamps);
  out.name = std::move(name);
  out.band = file.band;
  out.band_name = "the circuit's own band";
  for (const circuit::Stage& stage : file.circuit.stages) {
    for (const circuit::Biquad& factor : stage.wanted)
      out.poles += factor.a2 != 0.0 ? 2 : factor.a1 != 0.0 ? 1 : 0;
  }
  return out;
}

Design design_of_plan(const Node& plan, std::string name, const std::optional<Sections>& wanted) {
  Design out = PlanReader(std::move(name)).read(plan, wanted.has_value());
  if (wanted) {
    out.wanted = [wanted = *wanted](Hertz f) { return wanted.response(f.rad_s()); };
    out.reference_name = "sections";
    return out;
  }
  // The nominal response is fixed here: a copy of what it needs, not of itself.
  auto fixed = std::make_shared<Design>(out);
  out.wanted = [fixed](Hertz f) { return fixed->nominal(f); };
  return out;
}

}  // namespace bodesmith::yield
