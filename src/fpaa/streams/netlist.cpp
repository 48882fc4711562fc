#include "fpaa/streams/netlist.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/documents/json.hpp"
#include "base/text.hpp"

namespace bodesmith::fpaa::an231 {
namespace {

const char* clock_word(SwitchWord::Clock clock) {
  static constexpr const char* kNames[] = {"static", "ClockA", "ClockB", "not understood"};
  return kNames[static_cast<std::size_t>(clock)];
}

Json word_json(const SwitchWord& word) {
  Json out;
  out["clock"] = clock_word(word.clock);
  out["phase_1"] = word.at[0].text();
  out["phase_2"] = word.at[1].text();
  return out;
}

Json clock_json(const std::optional<int>& clock) {
  return clock ? Json(fmt::format("Clock{}", *clock)) : Json();
}

Json cab_json(const CabCell& cab) {
  Json out;
  out["cab"] = cab.cab;
  out["clock_a"] = clock_json(cab.clock_a);
  out["clock_b"] = clock_json(cab.clock_b);
  out["opamps"] = Json::array();
  for (std::size_t o = 0; o < cab.opamps.size(); ++o) {
    const OpAmpCell& amp = cab.opamps[o];
    Json one{{"opamp", o + 1}, {"on", amp.on}};
    if (amp.reset_phase != 0) {
      one["zero_in_phase"] = amp.reset_phase;
      one["by"] = clock_word(amp.reset_clock);
    }
    out["opamps"].push_back(std::move(one));
  }
  out["capacitors"] = Json::array();
  for (const CapacitorCell& c : cab.capacitors) {
    out["capacitors"].push_back({{"name", fmt::format("C{}", c.number)},
                                 {"units", c.units},
                                 {"near", word_json(c.near)},
                                 {"far", word_json(c.far)}});
  }
  return out;
}

Json remarks_json(const std::vector<MemoryRemark>& remarks) {
  Json out = Json::array();
  for (const MemoryRemark& r : remarks) {
    out.push_back({{"bank", r.address.bank},
                   {"byte", r.address.byte},
                   {"value", fmt::format("{:02X}", r.value)},
                   {"what", r.what}});
  }
  return out;
}

std::string board_node_text(const BoardCircuit& board, const BoardNode& node) {
  return fmt::format("chip{}.{}", board.chips[node.chip].address1, node.node.text());
}

Json stage_json(const BoardCircuit& board, const StageTransfer& stage) {
  Json out;
  out["output"] = board_node_text(board, stage.opamp);
  if (stage.clock_divisor > 0) out["clock_hz"] = board.master.value / stage.clock_divisor;
  out["phase"] = stage.phase;
  out["half_period_output"] = stage.half_period;
  out["inputs"] = Json::array();
  for (const BoardNode& input : stage.inputs) out["inputs"].push_back(board_node_text(board, input));
  if (stage.obstacle.empty()) {
    out["z_numerators"] = stage.numerators;
    out["z_denominator"] = stage.denominator;
  } else {
    out["no_transfer"] = stage.obstacle;
  }
  return out;
}

Json io_json(const IoCell& cell) {
  Json out{{"cell", fmt::format("IO{}", cell.number)}, {"mode", std::string(to_string(cell.mode))}};
  if (cell.is_output()) out["driven_by"] = cell.source.text();
  if (cell.sample_phase != 0) {
    out["samples_in_phase"] = cell.sample_phase;
    out["clock"] = fmt::format("Clock{}", cell.sample_clock);
  }
  return out;
}

Json netlist_chip_json(const ChipCircuit& chip, Hertz master) {
  Json out;
  out["chip"] = chip.address1;
  out["master_clock_hz"] = master.value;
  out["clocks_hz"] = Json::object();
  out["clocks_hz"]["sys1_hz"] = master.value / chip.system1_divisor;
  out["clocks_hz"]["sys2_hz"] = master.value / chip.system2_divisor;
  for (int k = 0; k < kClocks; ++k) {
    if (!chip.powered[static_cast<std::size_t>(k)]) continue;
    out["clocks_hz"][fmt::format("clock{}_hz", k)] = chip.clock(k, master).value;
  }
  out["cabs"] = Json::array();
  for (const CabCell& cab : chip.cabs) out["cabs"].push_back(cab_json(cab));
  out["io_cells"] = Json::array();
  for (const IoCell& cell : chip.cells) {
    if (cell.mode != IoCell::Mode::off) out["io_cells"].push_back(io_json(cell));
  }
  if (!chip.lookup_table.empty()) out["lookup_table"] = chip.lookup_table;
  out["problems"] = chip.problems;
  out["notes"] = chip.notes;
  out["constants"] = remarks_json(chip.constants);
  out["unexplained"] = remarks_json(chip.unexplained);
  return out;
}

std::string polynomial_text(const std::vector<double>& p) {
  std::vector<std::string> parts;
  for (const double c : p) parts.push_back(rounded_text(c, 6));
  return "[" + join(parts, ", ") + "]";
}

}  // namespace

std::vector<LoadedBoard> load_boards(const std::vector<FoundStream>& streams) {
  std::vector<LoadedBoard> out;
  for (const FoundStream& s : streams) {
    const int address = s.stream.address1;
    const auto chip_in = [&](LoadedBoard& board) {
      return std::ranges::find(board.chips, address, &ChipImage::address1);
    };
    const bool is_there = !out.empty() && chip_in(out.back()) != out.back().chips.end();
    if (out.empty() || (s.stream.primary && is_there)) out.emplace_back();
    LoadedBoard& board = out.back();
    auto chip = chip_in(board);
    if (chip == board.chips.end()) {
      chip = board.chips.insert(board.chips.end(), ChipImage{address, {}, {}});
      if (!s.stream.primary) {
        board.notes.push_back(
            fmt::format("{}: an update without its primary: laid over a memory of zeros", s.name));
      }
    }
    chip->memory.lay_over(s.stream, s.name);
    chip->streams.push_back(s.name);
  }
  return out;
}

BoardCircuit read_board(const LoadedBoard& loaded, Hertz master) {
  BoardCircuit out;
  out.master = master;
  for (const ChipImage& chip : loaded.chips) out.chips.push_back(read_circuit(chip.memory, chip.address1));
  return out;
}

Json streams_json(const std::vector<FoundStream>& streams) {
  Json out = Json::array();
  for (const FoundStream& s : streams) {
    Json one;
    one["stream"] = s.name;
    one["form"] = std::string(to_string(s.form));
    one["address1"] = s.stream.address1;
    one["primary"] = s.stream.primary;
    one["control"] = fmt::format("{:02X}", s.stream.control);
    one["blocks"] = s.stream.blocks.size();
    one["bytes"] = s.bytes.size();
    one["re_encodes"] = encode(s.stream) == s.bytes;
    one["block_rule"] = is_written_by(s.stream, StreamForm::sparse)  ? Json("sparse, as C arrays")
                        : is_written_by(s.stream, StreamForm::whole) ? Json("whole memory, as AHF files")
                                                                     : Json();
    out.push_back(std::move(one));
  }
  return out;
}

Json board_json(const BoardCircuit& board) {
  Json out;
  out["chips"] = Json::array();
  for (const ChipCircuit& chip : board.chips) out["chips"].push_back(netlist_chip_json(chip, board.master));
  out["stages"] = Json::array();
  for (const StageTransfer& stage : stage_transfers(board)) out["stages"].push_back(stage_json(board, stage));
  return out;
}

std::string board_text(const BoardCircuit& board) {
  std::string out;
  for (const StageTransfer& s : stage_transfers(board)) {
    out += board_node_text(board, s.opamp);
    if (s.clock_divisor > 0)
      out += fmt::format(" at {} Hz", rounded_text(board.master.value / s.clock_divisor, 7));
    out += s.half_period ? fmt::format(", valid in phase {} only: ", s.phase) : ": ";
    if (!s.obstacle.empty()) {
      out += "no transfer, " + s.obstacle + "\n";
      continue;
    }
    std::vector<std::string> terms;
    for (std::size_t i = 0; i < s.inputs.size(); ++i) {
      terms.push_back(polynomial_text(s.numerators[i]) + " " + board_node_text(board, s.inputs[i]));
    }
    out += fmt::format("({}) / {}\n", join(terms, " + "), polynomial_text(s.denominator));
  }
  for (const ChipCircuit& chip : board.chips) {
    for (const IoCell& cell : chip.cells) {
      if (cell.mode == IoCell::Mode::off) continue;
      out += fmt::format("chip{}.IO{}: {}", chip.address1, cell.number, to_string(cell.mode));
      if (cell.is_output()) out += fmt::format(" from {}", cell.source.text());
      out += "\n";
    }
    for (const std::string& p : chip.problems) out += fmt::format("chip {} PROBLEM: {}\n", chip.address1, p);
    for (const std::string& n : chip.notes) out += fmt::format("chip {} note: {}\n", chip.address1, n);
    for (const MemoryRemark& r : chip.unexplained) {
      out += fmt::format("chip {} not understood: {:02X}:{:02X} = {:02X} ({})\n", chip.address1,
                         r.address.bank, r.address.byte, r.value, r.what);
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa::an231
