#include "schematic/writers/kicad/sheet_rows.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "base/text.hpp"

namespace bodesmith::kicad {
namespace {

// Room that is shared out goes up to here between two cells and between two rows; the rest stays around the whole.
constexpr int kWidestGap = 24, kHighestGap = 20;

int width_of(const Cell& cell) {
  return cell.drawing.right - cell.drawing.left;
}

}  // namespace

int Group::width() const {
  int sum = 0;
  for (const Cell& cell : cells) sum += width_of(cell) + kGap;
  return std::max(sum, text_width());
}

int Group::text_width() const {
  std::size_t longest = 0;
  for (const std::string_view line : split(text, '\n')) longest = std::max(longest, line.size());
  return static_cast<int>(longest) + kGap;
}

int Group::text_height() const {
  return 2 * static_cast<int>(std::ranges::count(text, '\n')) + 3;
}

Rows::Rows(const Paper& paper, int width, int top)
    : paper_(paper), width_(width > 0 ? width : paper.width - 2 * kMargin), top_(top) {}

bool Rows::add(const Group& group) {
  if (group.width() <= width_) return place(group, 0, group.cells.size());
  // Too wide for one row: as many cells as fit, and the rest below.
  for (std::size_t first = 0; first < group.cells.size();) {
    std::size_t last = first;
    int width = 0;
    while (last < group.cells.size()) {
      width += width_of(group.cells[last]) + kGap;
      if (width > width_ && last > first) break;
      ++last;
    }
    if (!place(group, first, last)) return false;
    first = last;
  }
  return true;
}

bool Rows::place(const Group& group, std::size_t first, std::size_t last) {
  Row piece;
  for (std::size_t i = first; i < last; ++i) {
    const bool titled = i == 0 && !group.text.empty();
    piece.items.push_back(
        {piece.width, &group.cells[i], titled ? group.text : "", titled ? group.text_height() : 0});
    piece.width += width_of(group.cells[i]) + kGap;
  }
  if (first == 0) piece.width = std::max(piece.width, group.text_width());
  if (piece.width > usable_width() + kGap) return false;
  const bool own_row = rows_.empty() || rows_.back().width + piece.width > width_ + kGap;
  if (own_row) rows_.emplace_back();
  Row& row = rows_.back();
  const Row before{row.width, row.height, {}};
  const std::size_t count = row.items.size();
  for (Item& item : piece.items) {
    item.x += row.width;
    row.items.push_back(std::move(item));
  }
  row.width += piece.width;
  row.height = heights_of(row).height;
  if (height() <= usable_height()) return true;
  row.items.resize(count);
  row.width = before.width;
  row.height = before.height;
  if (own_row) rows_.pop_back();
  return false;
}

std::vector<Rows::Run> Rows::runs_of(const Row& row) {
  std::vector<Run> out;
  int text_height = 0;
  for (std::size_t i = 0; i < row.items.size(); ++i) {
    const Item& item = row.items[i];
    if (i == 0 || !wired(row.items[i - 1], item)) {
      out.push_back({i, i, 0, 0});
      text_height = 0;
    }
    Run& run = out.back();
    run.last = i;
    const int free = std::max(1, item.text.empty() ? 1 : item.text_height + 1);
    // Texts of a run stand in one line above the highest of its cells.
    const int bare = std::max(run.ascent - std::max(1, text_height), -item.cell->drawing.top);
    text_height = std::max(text_height, free);
    run.ascent = bare + text_height;
    run.descent = std::max(run.descent, item.cell->drawing.bottom + 2);
  }
  return out;
}

Rows::Heights Rows::heights_of(const Row& row) {
  const std::vector<Run> runs = runs_of(row);
  Heights out;
  for (const Run& run : runs) out.height = std::max(out.height, run.ascent + run.descent);
  // One line for the op-amps of as many runs as can have it; a run that cannot stands as near as it can.
  const auto in_line = [&](int axis) {
    return std::ranges::count_if(
        runs, [&](const Run& run) { return axis >= run.ascent && axis + run.descent <= out.height; });
  };
  int axis = 0;
  for (const Run& run : runs) {
    if (in_line(run.ascent) > in_line(axis)) axis = run.ascent;
  }
  for (const Run& run : runs) {
    const int own = std::clamp(axis, run.ascent, out.height - run.descent);
    for (std::size_t i = run.first; i <= run.last; ++i) {
      out.axis.push_back(own);
      out.top.push_back(own - run.ascent);
    }
  }
  return out;
}

int Rows::height() const {
  int out = 0;
  for (const Row& row : rows_) out += row.height;
  return out;
}

double Rows::imbalance() const {
  int width = 0;
  for (const Row& row : rows_) width = std::max(width, row.width - kGap);
  return std::abs(static_cast<double>(width) / usable_width() -
                  static_cast<double>(height()) / usable_height());
}

Drawing Rows::drawing() const {
  Drawing out;
  const std::map<std::string, int> uses = count_uses();
  const int count = static_cast<int>(rows_.size());
  const int left_over = usable_height() - height();
  const int between = count > 1 ? std::min(left_over / count, kHighestGap) : 0;
  int y = top_ + (left_over - between * (count - 1)) / 2;
  for (const Row& row : rows_) {
    const Heights heights = heights_of(row);
    const int cells = static_cast<int>(row.items.size());
    const int room = usable_width() - (row.width - kGap);
    const int apart = cells > 1 ? std::min(room / (cells - 1), kWidestGap) : 0;
    const int x = kMargin + (room - apart * (cells - 1)) / 2;
    std::vector<Point> origins;
    for (std::size_t i = 0; i < row.items.size(); ++i)
      origins.push_back({x + row.items[i].x + apart * static_cast<int>(i) - row.items[i].cell->drawing.left,
                         y + heights.axis[i]});
    for (std::size_t i = 0; i < row.items.size(); ++i) {
      const Item& item = row.items[i];
      const bool wired_after = i + 1 < row.items.size() && wired(item, row.items[i + 1]);
      const bool wired_before = i > 0 && wired(row.items[i - 1], item);
      out.append(item.cell->drawing, origins[i]);
      for (std::size_t a = 0; a < item.cell->anchors.size(); ++a)
        finish(item, a, origins[i], wired_before, wired_after, uses, out);
      if (wired_after) connect(item, origins[i], row.items[i + 1], origins[i + 1], out);
      if (!item.text.empty())
        out.texts.push_back(
            {{origins[i].x + item.cell->drawing.left, y + heights.top[i] + item.text_height - 2}, item.text});
    }
    y += heights.height + between;
  }
  return out;
}

bool Rows::wired(const Item& left, const Item& right) {
  return left.cell->exit && right.cell->entry &&
         left.cell->anchors[*left.cell->exit].net == right.cell->anchors[*right.cell->entry].net;
}

std::map<std::string, int> Rows::count_uses() const {
  std::map<std::string, int> out;
  for (const Row& row : rows_) {
    for (const Item& item : row.items) {
      std::set<std::string> here;
      for (const Anchor& anchor : item.cell->anchors) here.insert(anchor.net);
      for (const Label& label : item.cell->drawing.labels) here.insert(label.net);
      for (const std::string& net : here) ++out[net];
    }
  }
  return out;
}

void Rows::finish(const Item& item, std::size_t index, Point origin, bool wired_before, bool wired_after,
                  const std::map<std::string, int>& uses, Drawing& out) {
  const Anchor& anchor = item.cell->anchors[index];
  const Point at = anchor.at + origin;
  switch (anchor.kind) {
    case Anchor::Kind::end:
      if (wired_before && item.cell->entry == index) return;
      out.wire(at + Point{-1, 0}, at, anchor.net);
      out.label({at + Point{-1, 0}, anchor.net, true});
      break;
    case Anchor::Kind::inner:
      // An output that is also an input (a follower) has its name there already.
      if ((uses.at(anchor.net) == 1 && !ends_in(item, anchor.net)) || is_output(item, anchor.net)) return;
      if (anchor.name_at) {
        out.wire(at, *anchor.name_at + origin, anchor.net);
        out.label({*anchor.name_at + origin, anchor.net, false});
      } else {
        out.label({at, anchor.net, true});
      }
      break;
    case Anchor::Kind::output:
      if (!(wired_after && item.cell->exit == index)) out.wire(at, at + Point{1, 0}, anchor.net);
      out.label({at + Point{1, 0}, anchor.net, false});
      break;
  }
}

bool Rows::ends_in(const Item& item, const std::string& net) {
  return std::ranges::any_of(
      item.cell->anchors, [&](const Anchor& one) { return one.kind == Anchor::Kind::end && one.net == net; });
}

bool Rows::is_output(const Item& item, const std::string& net) {
  return item.cell->exit && item.cell->anchors[*item.cell->exit].net == net;
}

void Rows::connect(const Item& left, Point left_origin, const Item& right, Point right_origin, Drawing& out) {
  const Anchor &from = left.cell->anchors[*left.cell->exit], &to = right.cell->anchors[*right.cell->entry];
  const Point a = from.at + left_origin, b = to.at + right_origin;
  const Point corner{b.x - 2, a.y};
  out.wire(a, corner, from.net);
  out.wire(corner, {corner.x, b.y}, from.net);
  out.wire({corner.x, b.y}, b, from.net);
}

Rows fitted_rows(const Paper& paper, const std::vector<const Group*>& groups, int top) {
  const int widest = paper.width - 2 * kMargin;
  int narrowest = 0;
  for (const Group* group : groups) narrowest = std::max(narrowest, group->width());
  Rows best(paper, widest, top);
  for (int width = widest; width >= std::min(narrowest, widest); width -= 4) {
    Rows rows(paper, width, top);
    if (!std::ranges::all_of(groups, [&](const Group* group) { return rows.add(*group); })) continue;
    if (best.empty() || rows.imbalance() < best.imbalance()) best = std::move(rows);
  }
  return best;
}

Cell stacked(const std::vector<Cell>& cells) {
  Cell out;
  int y = 0, below = 0;
  for (const Cell& cell : cells) {
    y += below - cell.drawing.top;
    out.drawing.append(cell.drawing, {0, y});
    below = cell.drawing.bottom + 1;
  }
  return out;
}

}  // namespace bodesmith::kicad
