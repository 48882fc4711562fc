#pragma once

#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "fpaa/streams/board_networks.hpp"
#include "fpaa/streams/stream_file.hpp"

namespace bodesmith::fpaa::an231 {

/// A chip's memory after the streams that were laid over it.
struct ChipImage {
  int address1 = 1;
  MemoryImage memory;
  std::vector<std::string> streams;  ///< what was laid over it, in order
};

/// Primaries begin a chip's memory anew, updates go over what their Address1 has (over zeros when there was no
/// primary, which `notes` then tells). A second primary for an address of the same set starts a set of its own
/// (`set` counts them), as files with several boards have it.
struct LoadedBoard {
  std::vector<ChipImage> chips;
  std::vector<std::string> notes;
};
std::vector<LoadedBoard> load_boards(const std::vector<FoundStream>& streams);

/// The circuits of a board's chips, nothing wired between them.
BoardCircuit read_board(const LoadedBoard& loaded, Hertz master);

/// `[{"stream", "form", "address1", "primary", "bytes", "re_encodes"}]`; re_encodes: decoded and encoded again
/// it is the same, byte for byte; "block_rule": which of the vendor's rules chose its blocks, or null.
Json streams_json(const std::vector<FoundStream>& streams);

/// The chips with clocks, CABs, I/O cells, stages with their z transfer, problems and what is not understood.
Json board_json(const BoardCircuit& board);

/// "chip 1 CAB 2 op-amp 1: …" a line each, for a person.
std::string board_text(const BoardCircuit& board);

}  // namespace bodesmith::fpaa::an231
