#include "fpaa/device/router.hpp"

#include <algorithm>

namespace bodesmith::fpaa::an231 {
namespace {

constexpr std::array<int, kIoCells> kInputCells = {1, 2, 3, 4, 5, 6, 7};
constexpr std::array<int, kIoCells> kOutputCells = {3, 4, 2, 1, 7, 6, 5};

/// What drives a column line: an input pin's cell, or an op-amp.
struct LineDriver {
  int cell = 0;
  int cab = 0;
  int opamp = 0;
  friend bool operator==(const LineDriver&, const LineDriver&) = default;
};

/// The lines that one choice of cells takes.
class LineUse {
 public:
  bool add(const PinNeed& pin, const std::map<std::string, int>& cells) {
    return pin.is_input ? input(pin, cells) : output(pin, cells);
  }
  RoutedPins take() { return std::move(out_); }

 private:
  static std::size_t side(Column column) { return column == Column::odd ? 0 : 1; }

  /// Column line 1 or 2 of this driver; 0: both are taken. Op-amp 2 prefers line 2 when both are free and
  /// op-amp 1 of its CAB drives line 1 already: the combination that public streams have.
  int column_line(Column column, const LineDriver& driver) {
    auto& lines = column_lines_[side(column)];
    for (std::size_t l = 0; l < lines.size(); ++l) {
      if (lines[l] && *lines[l] == driver) return static_cast<int>(l) + 1;
    }
    for (std::size_t l = 0; l < lines.size(); ++l) {
      if (lines[l]) continue;
      lines[l] = driver;
      if (driver.cab != 0) {
        out_.line_drivers[static_cast<std::size_t>(driver.cab - 1)] |=
            line_driver_bit(driver.opamp, static_cast<int>(l) + 1);
      }
      return static_cast<int>(l) + 1;
    }
    return 0;
  }

  /// The local input of a CAB that takes this column line.
  int local_input(int cab, int line) {
    auto& inputs = out_.local_inputs[static_cast<std::size_t>(cab - 1)];
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (inputs[i] == line || inputs[i] == 0) {
        inputs[i] = line;
        return static_cast<int>(i) + 1;
      }
    }
    return 0;
  }

  bool input(const PinNeed& pin, const std::map<std::string, int>& cells) {
    const int cell = cells.at(pin.name);
    for (const Column column : kColumns) {
      std::vector<int> cabs;
      for (const int cab : pin.cabs) {
        if (column_of(cab) == column) cabs.push_back(cab);
      }
      if (cabs.empty()) continue;
      const int next_to = cab_next_to(cell, column);
      if (std::ranges::all_of(cabs, [&](int cab) { return cab == next_to; })) {
        int& used = direct_lines_[static_cast<std::size_t>(next_to - 1)];
        if (used == kLines) return false;
        ++used;
        out_.nibbles.push_back({cell, column, kNibbleDirect + used - 1});
        out_.selectors[{pin.name, next_to}] = direct_line_selector(next_to, used);
        continue;
      }
      const int line = column_line(column, {cell, 0, 0});
      if (line == 0) return false;
      out_.nibbles.push_back({cell, column, kNibbleColumnLine + line - 1});
      for (const int cab : cabs) {
        const int local = local_input(cab, line);
        if (local == 0) return false;
        out_.selectors[{pin.name, cab}] = local_input_selector(local);
      }
    }
    return true;
  }

  bool output(const PinNeed& pin, const std::map<std::string, int>& cells) {
    const int cell = cells.at(pin.name);
    const Column column = column_of(pin.cab);
    if (cab_next_to(cell, column) == pin.cab) {
      out_.nibbles.push_back({cell, column, pin.opamp == 1 ? kNibbleOpAmp1 : kNibbleOpAmp2});
      return true;
    }
    const int line = column_line(column, {0, pin.cab, pin.opamp});
    if (line == 0) return false;
    out_.nibbles.push_back({cell, column, kNibbleColumnLine + line - 1});
    return true;
  }

  std::array<std::array<std::optional<LineDriver>, kLines>, 2> column_lines_;
  std::array<int, kCabs> direct_lines_{};
  RoutedPins out_;
};

/// Tries cells for the pins from `at` on; the first choice whose lines suffice.
class CellSearch {
 public:
  explicit CellSearch(const std::vector<PinNeed>& pins) : pins_(pins) {}

  std::optional<RoutedPins> from(std::size_t at) {
    if (at == pins_.size()) return lines();
    const PinNeed& pin = pins_[at];
    for (const int cell : pin.is_input ? kInputCells : kOutputCells) {
      if (taken_[static_cast<std::size_t>(cell)] || (pin.sampled && cell > 4)) continue;
      if (pin.wanted_cell && *pin.wanted_cell != cell) continue;
      taken_[static_cast<std::size_t>(cell)] = true;
      cells_[pin.name] = cell;
      if (auto out = from(at + 1)) return out;
      taken_[static_cast<std::size_t>(cell)] = false;
    }
    return std::nullopt;
  }

 private:
  std::optional<RoutedPins> lines() const {
    LineUse use;
    for (const PinNeed& pin : pins_) {
      if (!use.add(pin, cells_)) return std::nullopt;
    }
    RoutedPins out = use.take();
    out.cells = cells_;
    return out;
  }

  const std::vector<PinNeed>& pins_;
  std::map<std::string, int> cells_;
  std::array<bool, kIoCells + 1> taken_{};
};

}  // namespace

std::optional<RoutedPins> route_pins(const std::vector<PinNeed>& pins) {
  // Cells that the user chose are not given away to others.
  std::vector<PinNeed> sorted = pins;
  std::ranges::stable_sort(sorted, [](const PinNeed& a, const PinNeed& b) {
    return a.wanted_cell.has_value() && !b.wanted_cell.has_value();
  });
  return CellSearch(sorted).from(0);
}

}  // namespace bodesmith::fpaa::an231
