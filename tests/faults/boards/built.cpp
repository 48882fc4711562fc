#include "built.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <set>

#include "schematic/ngspice/ngspice.hpp"

namespace bodesmith::faults {
namespace {

double log_uniform(Random& random, double from, double to) {
  return from * std::pow(to / from, random.uniform());
}

std::size_t any_of_count(Random& random, std::size_t count) {
  return static_cast<std::size_t>(random.below(count));
}

std::string place_name(const std::string& node) {
  return node == "out" ? "the output" : "node " + node;
}

std::vector<std::string> inner_nodes(const synthesis::Circuit& circuit) {
  std::set<std::string> names;
  for (const schematic::Part& part : circuit.parts) names.insert({part.from, part.to});
  names.erase("0");
  names.erase("in");
  names.erase("out");
  return {names.begin(), names.end()};
}

void spoil_value(BuiltBoard& board, Random& random) {
  schematic::Part& part = board.circuit.parts[any_of_count(random, board.circuit.parts.size())];
  const double change = log_uniform(random, 0.08, 1.6);
  const double factor = random.uniform() < 0.5 ? std::exp(change) : std::exp(-change);
  part.realised *= factor;
  board.wrong.push_back({part.name});
  board.words += fmt::format("{} x {:.3f}; ", part.name, factor);
}

void spoil_decade(BuiltBoard& board, Random& random) {
  schematic::Part& part = board.circuit.parts[any_of_count(random, board.circuit.parts.size())];
  const double factor = random.uniform() < 0.5 ? 10.0 : 0.1;
  part.realised *= factor;
  board.wrong.push_back({part.name});
  board.words += fmt::format("{} x {}; ", part.name, factor);
}

void spoil_open(BuiltBoard& board, Random& random) {
  const std::size_t at = any_of_count(random, board.circuit.parts.size());
  board.open[at] = 1;
  board.wrong.push_back({board.circuit.parts[at].name});
  board.words += board.circuit.parts[at].name + " open; ";
}

void spoil_short(BuiltBoard& board, Random& random) {
  const std::size_t at = any_of_count(random, board.circuit.parts.size());
  board.shorted[at] = 1;
  board.wrong.push_back({board.circuit.parts[at].name});
  board.words += board.circuit.parts[at].name + " short; ";
}

void spoil_swap(BuiltBoard& board, Random& random) {
  auto& parts = board.circuit.parts;
  for (int attempt = 0; attempt < 200; ++attempt) {
    const std::size_t i = any_of_count(random, parts.size());
    const std::size_t j = any_of_count(random, parts.size());
    if (i == j || parts[i].kind != parts[j].kind || parts[i].group != parts[j].group ||
        std::abs(std::log(parts[i].realised / parts[j].realised)) < 0.08)
      continue;
    std::swap(parts[i].realised, parts[j].realised);
    board.wrong.push_back({parts[i].name, parts[j].name});
    board.words += fmt::format("{} and {} swapped; ", parts[i].name, parts[j].name);
    return;
  }
  spoil_value(board, random);  // a stage has no two parts of one sort
}

void spoil_opamp(BuiltBoard& board, Random& random) {
  const std::size_t at = any_of_count(random, board.circuit.opamps.size());
  const double factor = log_uniform(random, 0.001, 0.1);
  board.gain_bandwidth_hz[at] *= factor;
  board.wrong.push_back({board.circuit.opamps[at].name});
  board.words += fmt::format("{} gain-bandwidth x {:.4f}; ", board.circuit.opamps[at].name, factor);
}

void spoil_load(BuiltBoard& board, Random& random) {
  const std::vector<std::string> inner = inner_nodes(board.circuit);
  const std::string node =
      random.uniform() < 0.5 || inner.empty() ? "out" : inner[any_of_count(random, inner.size())];
  const bool capacitance = random.uniform() < 0.5;
  const double value = capacitance
                           ? log_uniform(random, node == "out" ? 10e-9 : 300e-12, 300e-9)
                           : log_uniform(random, node == "out" ? 5.0 : 1e3, node == "out" ? 500.0 : 1e5);
  board.more.push_back(
      fmt::format("{}load{} {} 0 {:.6e}", capacitance ? "C" : "R", board.more.size(), node, value));
  board.wrong.push_back({place_name(node)});
  board.words +=
      fmt::format("{} loaded with {:.3g} {}; ", place_name(node), value, capacitance ? "F" : "ohm");
}

void spoil_ground(BuiltBoard& board, Random& random) {
  for (int attempt = 0; attempt < 200; ++attempt) {
    const std::size_t at = any_of_count(random, board.circuit.opamps.size());
    if (board.circuit.opamps[at].plus != "0") continue;
    board.floating_plus[at] = 1;
    board.stray_f = log_uniform(random, 1e-16, 2e-14);
    board.wrong.push_back({board.circuit.opamps[at].name});
    board.words += board.circuit.opamps[at].name + " + input not grounded; ";
    return;
  }
  spoil_opamp(board, random);  // no input is at ground
}

void write_opamp(const BuiltBoard& board, std::size_t i, std::string& deck) {
  const schematic::OpAmp& u = board.circuit.opamps[i];
  const schematic::OpAmpModel& model = board.circuit.opamp;
  const double gbw = board.gain_bandwidth_hz[i];
  const std::string x = "x" + std::to_string(i);
  const std::string plus = board.floating_plus[i] != 0 ? "float" + std::to_string(i) : u.plus;
  deck += fmt::format("G{0} 0 {0}a {1} {2} 1\nR{0}a {0}a 0 {3:.9e}\nC{0}a {0}a 0 {4:.9e}\n", x, plus, u.minus,
                      model.dc_gain, 1.0 / (2.0 * std::numbers::pi * gbw));
  deck += fmt::format("G{0}b 0 {0}b {0}a 0 1\nR{0}b {0}b 0 1\nC{0}b {0}b 0 {1:.9e}\n", x,
                      1.0 / (6.0 * std::numbers::pi * gbw));
  deck +=
      fmt::format("E{0} {0}c 0 {0}b 0 1\nR{0}c {0}c {1} {2:.9e}\n", x, u.out, model.output_resistance_ohm);
  deck += fmt::format("C{0}d {1} {2} 2e-12\nC{0}m {2} 0 2e-12\nR{0}i {1} {2} 1e10\n", x, plus, u.minus);
  if (board.floating_plus[i] != 0)
    deck += fmt::format("C{0}p {1} 0 {2:.6e}\nR{0}p {1} 0 {3:.6e}\n", x, plus, board.stray_f,
                        1e10 * 2e-12 / board.stray_f);  // what is left of it to ground
}

}  // namespace

BuiltBoard good_board(const synthesis::Circuit& circuit, double resistor_percent, double capacitor_percent,
                      Random& random) {
  BuiltBoard out;
  out.circuit = circuit;
  for (schematic::Part& part : out.circuit.parts) {
    const double percent =
        part.kind == schematic::Part::Kind::resistor ? resistor_percent : capacitor_percent;
    part.realised *= 1.0 + 0.01 * percent * (2.0 * random.uniform() - 1.0);
  }
  for (std::size_t i = 0; i < circuit.opamps.size(); ++i)
    out.gain_bandwidth_hz.push_back(circuit.opamp.gain_bandwidth.value * (0.75 + 0.5 * random.uniform()));
  out.open.assign(circuit.parts.size(), 0);
  out.shorted.assign(circuit.parts.size(), 0);
  out.floating_plus.assign(circuit.opamps.size(), 0);
  return out;
}

void spoil(BuiltBoard& board, Random& random) {
  using Spoiler = void (*)(BuiltBoard&, Random&);
  constexpr Spoiler kAll[] = {spoil_value, spoil_value, spoil_decade, spoil_open,  spoil_short,
                              spoil_swap,  spoil_opamp, spoil_load,   spoil_ground};
  kAll[any_of_count(random, std::size(kAll))](board, random);
}

std::vector<std::complex<double>> response_of(const BuiltBoard& board, const std::vector<Hertz>& grid,
                                              const std::string& node) {
  std::string deck = "a built board\nVin in 0 DC 0 AC 1\n";
  for (std::size_t i = 0; i < board.circuit.parts.size(); ++i) {
    const schematic::Part& part = board.circuit.parts[i];
    const bool resistor = part.kind == schematic::Part::Kind::resistor;
    if (board.shorted[i] != 0) {
      deck += fmt::format("Rp{} {} {} 1e-2\n", i, part.from, part.to);
    } else if (board.open[i] != 0) {
      deck += fmt::format("Rp{} {} {} 1e12\n", i, part.from, part.to);
    } else {
      deck += fmt::format("{}p{} {} {} {:.9e}\n", resistor ? "R" : "C", i, part.from, part.to, part.realised);
    }
  }
  for (std::size_t i = 0; i < board.circuit.opamps.size(); ++i) write_opamp(board, i, deck);
  for (const std::string& line : board.more) deck += line + "\n";
  return ngspice::run_ac_of_circuit(deck, node, grid, "built board");
}

Channel measured(const std::vector<std::complex<double>>& response, const std::vector<Hertz>& grid,
                 double noise_db, double noise_deg, bool with_phase, Random& random) {
  Channel out;
  out.file = "measured";
  out.grid = grid;
  out.measured_points = grid.size();
  for (const std::complex<double>& h : response) {
    // An instrument has a floor of its own, 100 dB below the input.
    const std::complex<double> seen = h + 1e-5 * std::complex<double>(random.normal(), random.normal());
    out.log_gain.push_back(std::log(std::abs(seen)) + noise_db / kDecibelPerNeper * random.normal());
    if (with_phase) out.phase_rad.push_back(std::arg(seen) + to_radians(noise_deg) * random.normal());
  }
  return out;
}

}  // namespace bodesmith::faults
