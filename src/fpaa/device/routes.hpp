#pragma once

#include <array>
#include <string>
#include <vector>

#include "fpaa/device/cells.hpp"
#include "fpaa/device/circuit_node.hpp"
#include "fpaa/device/memory_image.hpp"

namespace bodesmith::fpaa::an231 {

/// The lines of one chip: what drives them, and what a selector therefore reads. Facts: an231, parts 1.3 to
/// 1.6.
class Routes {
 public:
  explicit Routes(const MemoryImage& memory);

  /// What a near selector of a CAB is joined to.
  CircuitNode node(int cab, int selector) const;
  /// An I/O cell: mode, and what drives it when it is an output.
  IoCell cell(int number) const { return cells_[static_cast<std::size_t>(number - 1)]; }
  /// Lines and cells with two drivers, one text each.
  const std::vector<std::string>& collisions() const { return collisions_; }

 private:
  struct Line {
    std::vector<CircuitNode> drivers;
    CircuitNode driver() const;
  };
  int nibble(int cell, Column column) const;
  Line& column_line(Column column, int line) {
    return column_lines_[column == Column::odd ? 0 : 1][static_cast<std::size_t>(line - 1)];
  }
  void read_modes();
  void input_cell(int number);
  void output_cell(int number);
  void sampling(IoCell& cell);
  void check_lines();
  /// Cells 5 to 7 have one mode for both directions: their nibbles tell.
  bool drives_out(int number);

  const MemoryImage& memory_;
  std::array<IoCell, kIoCells> cells_;
  std::array<std::array<Line, kLines>, 2> column_lines_;
  std::array<std::array<Line, kLines>, kCabs> direct_lines_;
  std::vector<std::string> collisions_;
};

}  // namespace bodesmith::fpaa::an231
