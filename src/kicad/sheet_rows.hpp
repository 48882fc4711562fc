#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/text.hpp"
#include "kicad/cell.hpp"

namespace bodesmith::kicad {

struct Paper {
  const char* name;
  int width, height;  // steps
};
inline constexpr Paper kPapers[] = {{"A4", 233, 165}, {"A3", 330, 233}};
constexpr int kMargin = 14;
constexpr int kTitleBlock = 30;  // kept free at the bottom
constexpr int kGap = 6;          // between cells

/// Cells that stay together, and what is written above them.
struct Group {
  std::vector<Cell> cells;
  std::string text;
  std::string in, out;

  int width() const {
    int sum = 0;
    for (const Cell& cell : cells) sum += cell.drawing.right - cell.drawing.left + kGap;
    return std::max(sum, text_width());
  }
  int text_width() const {
    size_t longest = 0;
    for (const std::string_view line : split(text, '\n')) longest = std::max(longest, line.size());
    return static_cast<int>(longest) + kGap;
  }
  int text_height() const { return 2 * static_cast<int>(std::count(text.begin(), text.end(), '\n')) + 3; }
};

/// Rows from left to right and downwards on one sheet.
class Rows {
 public:
  explicit Rows(const Paper& paper) : paper_(paper) {}

  /// False when the group does not fit any more.
  bool add(const Group& group);

  /// The rows at their heights. Cells beside each other whose ends are one net are wired, others named.
  Drawing drawing();
  bool empty() const { return rows_.empty(); }
  int height() const;

 private:
  struct Item {
    int x = 0;  ///< of the cell's origin
    Cell cell;
    std::string text;
    int text_height = 0;
  };
  struct Row {
    int ascent = 0, descent = 0, width = 0;
    std::vector<Item> items;
  };

  bool place(const Group& group, size_t first, size_t last);

  static bool wired(const Item& left, const Item& right);

  /// In how many cells a net has an anchor.
  std::map<std::string, int> count_uses() const;

  static void finish(const Item& item, size_t index, int axis, bool wired_before, bool wired_after,
                     const std::map<std::string, int>& uses, Drawing& out);

  /// Another piece of the net in the same cell.
  static bool ends_in(const Item& item, const std::string& net);

  static bool is_output(const Item& item, const std::string& net);

  static void connect(const Item& left, const Item& right, int axis, Drawing& out);

  Paper paper_;
  std::vector<Row> rows_;
};

}  // namespace bodesmith::kicad
