#pragma once

#include <map>
#include <string>
#include <vector>

#include "schematic/writers/kicad/cell.hpp"

namespace bodesmith::kicad {

struct Paper {
  const char* name;
  int width, height;  // steps
};
inline constexpr Paper kPapers[] = {
    {"A4", 233, 165}, {"A3", 330, 233}, {"A2", 467, 330}, {"A1", 662, 467}, {"A0", 936, 662}};
constexpr int kMargin = 14;
constexpr int kTitleBlock = 30;  // kept free at the bottom
constexpr int kGap = 6;          // between cells

/// Cells that stay together, and what is written above them.
struct Group {
  std::vector<Cell> cells;
  std::string text;
  std::string in, out;

  int width() const;
  int text_width() const;
  int text_height() const;
};

/// Rows from left to right and downwards on one sheet. Groups that were added must outlive it.
class Rows {
 public:
  /// Rows up to `width` wide (all there is when 0), below `top`.
  explicit Rows(const Paper& paper, int width = 0, int top = kMargin);

  /// False when the group does not fit any more.
  bool add(const Group& group);

  /// Cells next to each other whose ends are one net are wired, others named. What room is left is shared out
  /// between the rows and within them.
  Drawing drawing() const;
  bool empty() const { return rows_.empty(); }

  /// How unlike the used parts of the sheet's width and height are; 0: its shape is the sheet's.
  double imbalance() const;

 private:
  struct Item {
    int x = 0;  ///< of the cell's left end, from the row's begin
    const Cell* cell = nullptr;
    std::string text;
    int text_height = 0;
  };
  struct Row {
    int width = 0, height = 0;
    std::vector<Item> items;
  };
  /// Cells that are wired to each other and so stand at one height.
  struct Run {
    std::size_t first = 0, last = 0;
    int ascent = 0, descent = 0;
  };
  struct Heights {
    int height = 0;
    std::vector<int> axis;  ///< of every item, from the row's top
    std::vector<int> top;   ///< of its run
  };

  bool place(const Group& group, std::size_t first, std::size_t last);
  int usable_width() const { return paper_.width - 2 * kMargin; }
  int usable_height() const { return paper_.height - kTitleBlock - top_; }
  int height() const;

  static std::vector<Run> runs_of(const Row& row);
  static Heights heights_of(const Row& row);
  static bool wired(const Item& left, const Item& right);

  /// In how many cells a net has an anchor.
  std::map<std::string, int> count_uses() const;

  static void finish(const Item& item, std::size_t index, Point origin, bool wired_before, bool wired_after,
                     const std::map<std::string, int>& uses, Drawing& out);

  /// Another piece of the net in the same cell.
  static bool ends_in(const Item& item, const std::string& net);

  static bool is_output(const Item& item, const std::string& net);

  static void connect(const Item& left, Point left_origin, const Item& right, Point right_origin,
                      Drawing& out);

  Paper paper_;
  int width_, top_;
  std::vector<Row> rows_;
};

/// The groups on one sheet of this paper, its rows as long as makes the whole most like the sheet in shape;
/// empty when they do not fit.
Rows fitted_rows(const Paper& paper, const std::vector<const Group*>& groups, int top = kMargin);

/// The cells above each other as one; for cells without ends that could be wired.
Cell stacked(const std::vector<Cell>& cells);

}  // namespace bodesmith::kicad
