#include "project/output/circuit_model.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <string>

#include "chain/opamp_poles.hpp"
#include "chain/registry.hpp"
#include "chain/sections_chain.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/section_making.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "schematic/analysis/equations.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::project {
namespace {

using chain::Block;
using chain::make_block;
using chain::PartChange;
using Complex = std::complex<double>;

/// Relative departure at which what a capacitor does is worked out; the form that it has goes far beyond.
constexpr double kCapacitorDeparture = 0.05;
/// A good capacitor, percent: the usual grade.
constexpr double kCapacitorPercent = 5.0;
/// Of the response: less is rounding.
constexpr double kNoChange = 1e-9;

/// What passes the circuit, of ideal op-amps, when this one is dead, over what passes it.
Complex left_without(synthesis::Circuit circuit, std::size_t opamp, Hertz f) {
  const auto response = [&] { return schematic::network_response(circuit, {f}).front(); };
  const Complex alive = response();
  circuit.other_opamps = {circuit.opamp};
  circuit.other_opamps[0].dc_gain = 1.0 / circuit.opamp.dc_gain;
  circuit.opamps[opamp].type = 1;
  return response() / alive;
}

/// Three numbers from two frequencies, u of the corner: real parts p0 - p2 u^2, imaginary ones p1 u.
std::vector<double> polynomial_of(const std::function<Complex(double)>& at, bool quadratic) {
  const Complex low = at(0.5);
  const Complex high = at(2.0);
  const double p2 = quadratic ? (low.real() - high.real()) / 3.75 : 0.0;
  return {low.real() + 0.25 * p2, 0.5 * high.imag(), p2};
}

/// Whether the third zero that F makes of a biquad's two is far beyond them, in the left half-plane (chain::slow_section).
bool has_far_zero(const Block& biquad, const std::vector<double>& feedthrough) {
  return feedthrough[2] == 0.0 || biquad.get("highpass_gain") / feedthrough[2] > kNoChange;
}

/// 1/beta of each op-amp of a stage, by the return ratio with all op-amps ideal, and what passes without it. Left out: where that
/// is something in a section of one pole, or makes a zero that no block has.
void add_opamps(const synthesis::Circuit& circuit, std::size_t stage, const Block& block,
                std::vector<PartChange>& out) {
  const schematic::Equations equations(circuit);
  const std::string_view key = chain::corner_of(block);
  const bool two = block.has("damping_ratio");
  const double p1 = two ? 2.0 * block.get("damping_ratio") : key.empty() ? 0.0 : 1.0;
  // Of a gain any frequency will do.
  const Hertz corner{key.empty() ? 1.0 : block.get(key)};
  for (std::size_t i = 0; i < circuit.opamps.size(); ++i) {
    if (circuit.opamps[i].group != stage) continue;
    const auto numerator = [&](double u) {
      const RadPerSecond at = Hertz{u * corner.value}.rad_s();
      return Complex(two ? 1.0 - u * u : 1.0, p1 * u) * circuit.opamp.open_loop(at) /
             schematic::return_ratios(equations, circuit, {i}, at).front();
    };
    PartChange one{.part = circuit.opamps[i].name};
    one.noise_gain = polynomial_of(numerator, two);
    if (std::abs(left_without(circuit, i, corner)) > kNoChange) {
      if (block.type_name() != "biquad") continue;
      one.feedthrough = polynomial_of(
          [&](double u) {
            const Hertz f{u * corner.value};
            return *block.response(f.rad_s()) * left_without(circuit, i, f) * numerator(u);
          },
          true);
      for (std::size_t k = 0; k < 3; ++k) {
        if (std::abs(one.feedthrough[k]) < kNoChange * std::abs(one.noise_gain[k])) one.feedthrough[k] = 0.0;
      }
      if (!has_far_zero(block, one.feedthrough)) continue;
    }
    out.push_back(std::move(one));
  }
}

/// A biquad's response with the op-amps of its stage real, over that with all of them ideal.
std::vector<Complex> opamps_share(synthesis::Circuit circuit, const synthesis::OpAmpModel& opamp,
                                  std::size_t stage, const std::vector<Hertz>& grid) {
  std::vector<Complex> out = schematic::network_response(circuit, grid);
  circuit.other_opamps = {opamp};
  for (synthesis::OpAmp& one : circuit.opamps) one.type = one.group == stage ? 1 : 0;
  const std::vector<Complex> real = schematic::network_response(circuit, grid);
  for (std::size_t i = 0; i < grid.size(); ++i) out[i] = real[i] / out[i];
  return out;
}

/// How far beyond its corner on both sides a section is compared; real poles further apart are not within.
constexpr double kCompared = 8.0;

/// The biquad B/A that with the pole behind it is nearest to what the stage does, relatively, round its corner: least squares of
/// B - A G, G that response over the pole's, weighted by what they are with ideal op-amps (Levy 1959).
void fit_biquad(Block& section, const std::vector<Hertz>& grid, const std::vector<Complex>& share,
                double pole_hz) {
  const double corner = section.get("natural_frequency_hz");
  Eigen::MatrixXd m(2 * static_cast<Eigen::Index>(grid.size()), 5);
  Eigen::VectorXd right(m.rows());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Complex s(0.0, grid[i].value / corner);
    const Complex h = *section.response(grid[i].rad_s());
    const Complex g = h * share[i] * Complex(1.0, grid[i].value / pole_hz);
    const double weight = 1.0 / (std::abs(h) * std::abs(1.0 + s * (2.0 * section.get("damping_ratio") + s)));
    const Complex row[6] = {1.0, s, s * s, -g * s, -g * s * s, g};
    for (Eigen::Index k = 0; k < 6; ++k) {
      for (Eigen::Index part = 0; part < 2; ++part) {
        double& to = k < 5 ? m(2 * static_cast<Eigen::Index>(i) + part, k)
                           : right(2 * static_cast<Eigen::Index>(i) + part);
        to = weight * (part == 0 ? row[k].real() : row[k].imag());
      }
    }
  }
  const Eigen::VectorXd x = solve_ldlt(gram(m), transpose_times(m, right));
  const double up = 1.0 / std::sqrt(x(4));
  section.set("lowpass_gain", x(0))
      .set("bandpass_gain", x(1) * up)
      .set("highpass_gain", x(2) * up * up)
      .set("natural_frequency_hz", corner * up)
      .set("damping_ratio", 0.5 * x(3) * up);
}

/// Noise gains in powers of s over another corner.
void rescale_noise_gains(Block& section, double times) {
  auto parts = std::make_shared<std::vector<PartChange>>(*section.parts);
  for (PartChange& part : *parts) {
    for (std::vector<double>* polynomial : {&part.noise_gain, &part.feedthrough}) {
      for (std::size_t k = 0; k < polynomial->size(); ++k) (*polynomial)[k] *= std::pow(times, k);
    }
  }
  section.parts = std::move(parts);
}

/// The stage's blocks with its op-amps as fast as they are: its own poles move, and there is one more.
void make_real(const synthesis::Circuit& ideal, const synthesis::OpAmpModel& opamp, std::size_t stage,
               std::vector<Block>& blocks) {
  Block& section = blocks.back();
  Block more = make_block("lowpass");
  more.part = section.part + "_opamps";
  auto parts = std::make_shared<std::vector<PartChange>>(*section.parts);
  std::vector<double> sum(3, 0.0);
  for (PartChange& part : *parts) {
    if (part.noise_gain.empty()) continue;
    part.gain_bandwidth_hz = opamp.gain_bandwidth.value;
    // Next to a pole of one that something passes without stands a zero: the biquad has what both do near the corner.
    if (!part.feedthrough.empty()) continue;
    for (std::size_t k = 0; k < 3; ++k) sum[k] += part.noise_gain[k];
  }
  section.parts = std::move(parts);
  if (sum == std::vector<double>(3, 0.0)) return;
  const chain::OpampPoles poles = chain::opamp_poles(section, sum, 1.0 / opamp.gain_bandwidth.value);
  const std::string corner(chain::corner_of(section));
  const double ideal_corner = corner.empty() ? 0.0 : section.get(corner);
  if (corner.empty()) {
    more.set("corner_hz", poles.last->value);
  } else if (poles.last) {
    const double w = section.get(corner);
    more.set("corner_hz", poles.last->value);
    if (2.0 * section.get("damping_ratio") <= kCompared + 1.0 / kCompared) {
      const std::vector<Hertz> grid = log_grid({Hertz{w / kCompared}, Hertz{kCompared * w}}, 33);
      fit_biquad(section, grid, opamps_share(ideal, opamp, stage, grid), poles.last->value);
    } else {
      const double up = poles.natural_frequency_hz / w;
      section.set("bandpass_gain", section.get("bandpass_gain") * up)
          .set("highpass_gain", section.get("highpass_gain") * up * up)
          .set(corner, poles.natural_frequency_hz)
          .set("damping_ratio", poles.damping_ratio);
    }
  } else {
    // Far apart: an op-amp that is no faster than its section is not this one's.
    if (poles.damping_ratio <= 1.0) return;
    const double apart = poles.damping_ratio + std::sqrt(poles.damping_ratio * poles.damping_ratio - 1.0);
    const double slow = poles.natural_frequency_hz / apart;
    // A high-pass keeps its slope below the corner, the others their gain at 0 Hz.
    if (section.type_name() == "highpass")
      section.set("gain", section.get("gain") * slow / section.get(corner));
    section.set(corner, slow);
    more.set("corner_hz", poles.natural_frequency_hz * apart);
  }
  if (!corner.empty()) rescale_noise_gains(section, section.get(corner) / ideal_corner);
  blocks.push_back(std::move(more));
}

/// One stage of a circuit whose op-amps are ideal, as they are with `opamp`; which of the blocks is its section. Of integrators, ladders
/// and stages of two blocks op-amps stay ideal; of the last two no part is told.
struct StageModel {
  std::vector<Block> blocks;
  std::size_t section = 0;
};

StageModel stage_model_of(const synthesis::Circuit& ideal, const synthesis::OpAmpModel& opamp,
                          std::size_t i) {
  const synthesis::Stage& stage = ideal.stages[i];
  Sections factors;
  for (const synthesis::Biquad& factor : stage.realised) factors.sections.push_back(factor.section());
  const PooledRoots roots = pooled_roots(factors);
  StageModel out{stage_blocks({roots.gain, roots.zeros, roots.poles}, fmt::format("Stage{}", i + 1))};
  out.section = out.blocks.size() - 1;
  const bool one_block = out.blocks.size() == 1 || (out.blocks.size() == 2 && out.blocks[0].affine());
  if (!stage.form || !one_block) return out;
  const Block& block = out.blocks.back();
  auto parts = std::make_shared<std::vector<PartChange>>();
  const bool integrates = chain::corner_of(block).empty() && !block.affine();
  if (!integrates) add_opamps(ideal, i, block, *parts);
  out.blocks.back().parts = std::move(parts);
  if (!integrates && !opamp.is_ideal) make_real(ideal, opamp, i, out.blocks);
  return out;
}

/// What the capacitors of a stage do to its section.
void add_capacitors(const synthesis::Circuit& ideal, const synthesis::OpAmpModel& opamp, std::size_t i,
                    Block& section) {
  const synthesis::Stage& stage = ideal.stages[i];
  auto parts = std::make_shared<std::vector<PartChange>>();
  for (std::size_t k = stage.first_part; k < stage.first_part + stage.part_count; ++k) {
    if (ideal.parts[k].kind != synthesis::Part::Kind::capacitor) continue;
    const auto with = [&](double departure) {
      synthesis::Circuit off = ideal;
      off.parts[k].realised *= 1.0 + departure;
      off.stages[i].realised = {stage.form->transfer(off.realised_values(off.stages[i]))};
      const StageModel model = stage_model_of(off, opamp, i);
      return model.blocks[model.section];
    };
    PartChange one{ideal.parts[k].name, "percent", kCapacitorPercent};
    one.add_differences(section, 100.0 * kCapacitorDeparture, with(kCapacitorDeparture),
                        with(-kCapacitorDeparture));
    if (!one.entries.empty()) parts->push_back(std::move(one));
  }
  parts->insert(parts->end(), section.parts->begin(), section.parts->end());
  section.parts = std::move(parts);
}

}  // namespace

std::vector<Block> stage_blocks(const Section& section, const std::string& name) {
  std::vector<Block> out;
  if (section.poles.empty()) {
    out = {make_block("gain").set("gain", section.gain)};
  } else if (section.poles.size() > 2) {
    return chain::chain_of(make_sections(section.gain, section.zeros, section.poles), name + "_").blocks;
  } else if (section.poles.size() == 2 && std::abs(section.poles[0]) > 0.0 &&
             std::abs(section.poles[1]) > 0.0) {
    out = {chain::biquad_of(section)};  // its parts move all of it
  } else {
    Sections one;
    one.sections = {section};
    out = chain::chain_of(one, name).blocks;
    if (out.size() == 2 && out[0].affine() && out[1].has("gain")) {
      out[1].set("gain", out[0].get("gain") * out[1].get("gain"));
      out.erase(out.begin());
    }
    for (Block& block : out) {
      if (block.part.starts_with(name + "1")) block.part.erase(name.size(), 1);
    }
    return out;
  }
  out.front().part = name;
  return out;
}

std::vector<Block> circuit_blocks(synthesis::Circuit circuit) {
  const synthesis::OpAmpModel opamp = circuit.opamp;
  circuit.opamp = synthesis::OpAmpModel::ideal();
  std::vector<Block> out;
  for (std::size_t i = 0; i < circuit.stages.size(); ++i) {
    StageModel stage = stage_model_of(circuit, opamp, i);
    if (stage.blocks[stage.section].parts) add_capacitors(circuit, opamp, i, stage.blocks[stage.section]);
    out.insert(out.end(), stage.blocks.begin(), stage.blocks.end());
  }
  return out;
}

}  // namespace bodesmith::project
