#include "kicad/sheet_rows.hpp"

#include <algorithm>
#include <set>

namespace bodesmith::kicad {

bool Rows::add(const Group& group) {
  const int usable = paper_.width - 2 * kMargin;
  if (group.width() <= usable) return place(group, 0, group.cells.size());
  // Too wide for one row: as many cells as fit, and the rest below.
  for (size_t first = 0; first < group.cells.size();) {
    size_t last = first;
    int width = 0;
    while (last < group.cells.size()) {
      width += group.cells[last].drawing.right - group.cells[last].drawing.left + kGap;
      if (width > usable && last > first) break;
      ++last;
    }
    if (!place(group, first, last)) return false;
    first = last;
  }
  return true;
}

Drawing Rows::drawing() {
  Drawing out;
  int y = kMargin;
  std::vector<std::vector<bool>> named;
  const std::map<std::string, int> uses = count_uses();
  for (const Row& row : rows_) {
    const int axis = y + row.ascent;
    for (size_t i = 0; i < row.items.size(); ++i) {
      const Item& item = row.items[i];
      const Item* next = i + 1 < row.items.size() ? &row.items[i + 1] : nullptr;
      const Item* before = i > 0 ? &row.items[i - 1] : nullptr;
      out.append(item.cell.drawing, {item.x, axis});
      for (size_t a = 0; a < item.cell.anchors.size(); ++a)
        finish(item, a, axis, before && wired(*before, item), next && wired(item, *next), uses, out);
      if (next && wired(item, *next)) connect(item, *next, axis, out);
      if (!item.text.empty()) {
        out.texts.push_back({{item.x + item.cell.drawing.left, y + item.text_height - 2}, item.text});
      }
    }
    y += row.ascent + row.descent;
  }
  return out;
}

int Rows::height() const {
  int out = 0;
  for (const Row& row : rows_) out += row.ascent + row.descent;
  return out;
}

bool Rows::place(const Group& group, size_t first, size_t last) {
  const int usable = paper_.width - 2 * kMargin;
  int width = first == 0 ? group.text_width() : 0, cells = 0, ascent = 0, descent = 0;
  for (size_t i = first; i < last; ++i) {
    const Drawing& drawing = group.cells[i].drawing;
    cells += drawing.right - drawing.left + kGap;
    ascent = std::max(ascent, -drawing.top);
    descent = std::max(descent, drawing.bottom);
  }
  width = std::max(width, cells);
  ascent += (group.text.empty() ? 1 : group.text_height() + 1);
  descent += 2;
  const bool new_row = rows_.empty() || rows_.back().width + width > usable;
  const Row empty;
  const Row& into = new_row ? empty : rows_.back();
  const int grows =
      std::max(into.ascent, ascent) + std::max(into.descent, descent) - into.ascent - into.descent;
  if (height() + grows > paper_.height - kMargin - kTitleBlock) return false;
  if (new_row) rows_.emplace_back();
  Row& row = rows_.back();
  row.ascent = std::max(row.ascent, ascent);
  row.descent = std::max(row.descent, descent);
  int x = kMargin + row.width;
  for (size_t i = first; i < last; ++i) {
    const Drawing& drawing = group.cells[i].drawing;
    const bool titled = i == 0;
    row.items.push_back(
        {x - drawing.left, group.cells[i], titled ? group.text : "", titled ? group.text_height() : 0});
    x += drawing.right - drawing.left + kGap;
  }
  row.width += width;
  return true;
}

bool Rows::wired(const Item& left, const Item& right) {
  return left.cell.exit && right.cell.entry &&
         left.cell.anchors[*left.cell.exit].net == right.cell.anchors[*right.cell.entry].net;
}

std::map<std::string, int> Rows::count_uses() const {
  std::map<std::string, int> out;
  for (const Row& row : rows_) {
    for (const Item& item : row.items) {
      std::set<std::string> here;
      for (const Anchor& anchor : item.cell.anchors) here.insert(anchor.net);
      for (const Label& label : item.cell.drawing.labels) here.insert(label.net);
      for (const std::string& net : here) ++out[net];
    }
  }
  return out;
}

void Rows::finish(const Item& item, size_t index, int axis, bool wired_before, bool wired_after,
                  const std::map<std::string, int>& uses, Drawing& out) {
  const Anchor& anchor = item.cell.anchors[index];
  const Point at = anchor.at + Point{item.x, axis};
  switch (anchor.kind) {
    case Anchor::Kind::end:
      if (wired_before && item.cell.entry == index) return;
      out.wire(at + Point{-1, 0}, at, anchor.net);
      out.label({at + Point{-1, 0}, anchor.net, true});
      break;
    case Anchor::Kind::inner:
      // An output that is also an input (a follower) has its name there already.
      if ((uses.at(anchor.net) > 1 || ends_in(item, anchor.net)) && !is_output(item, anchor.net))
        out.label({at, anchor.net, true});
      break;
    case Anchor::Kind::output:
      if (!(wired_after && item.cell.exit == index)) out.wire(at, at + Point{1, 0}, anchor.net);
      out.label({at + Point{1, 0}, anchor.net, false});
      break;
  }
}

bool Rows::ends_in(const Item& item, const std::string& net) {
  return std::any_of(item.cell.anchors.begin(), item.cell.anchors.end(),
                     [&](const Anchor& one) { return one.kind == Anchor::Kind::end && one.net == net; });
}

bool Rows::is_output(const Item& item, const std::string& net) {
  return item.cell.exit && item.cell.anchors[*item.cell.exit].net == net;
}

void Rows::connect(const Item& left, const Item& right, int axis, Drawing& out) {
  const Anchor &from = left.cell.anchors[*left.cell.exit], &to = right.cell.anchors[*right.cell.entry];
  const Point a = from.at + Point{left.x, axis}, b = to.at + Point{right.x, axis};
  const Point corner{b.x - 2, a.y};
  out.wire(a, corner, from.net);
  out.wire(corner, {corner.x, b.y}, from.net);
  out.wire({corner.x, b.y}, b, from.net);
}

}  // namespace bodesmith::kicad
