#include "schematic/writers/kicad/cell.hpp"

#include <algorithm>
#include <utility>

namespace bodesmith::kicad {
namespace {

using schematic::Branch;
using schematic::OpAmp;
using schematic::Part;

constexpr int kPitch = 8;      // between rows of parts
constexpr int kPartWidth = 8;  // a part and a step of wire on both sides
constexpr int kBus = -8;       // where the wires of the inputs stand, from the op-amp's centre
constexpr int kOut = 10;

struct Size {
  int width = 0, rows = 0;  // rows above the first
};

Size size_of(const Branch& branch) {
  Size out;
  if (branch.kind == Branch::Kind::part) return {kPartWidth, 0};
  for (const Branch& child : branch.children) {
    const Size one = size_of(child);
    if (branch.kind == Branch::Kind::series) {
      out.width += one.width;
      out.rows = std::max(out.rows, one.rows);
    } else {
      out.width = std::max(out.width, one.width);
      out.rows += one.rows + 1;
    }
  }
  if (branch.kind == Branch::Kind::parallel) {
    out.rows -= 1;
    out.width += 2;
  }
  return out;
}

class CellMaker {
 public:
  CellMaker(const std::vector<Part>& parts, const PartTexts& texts) : parts_(parts), texts_(texts) {}

  /// `before`: the node that the piece to the left puts out.
  void opamp(const OpAmp& opamp, Symbol symbol, std::vector<Branch>& rest,
             const std::set<std::string>& terminals, const std::string& before);
  void loose(std::vector<Branch>& rest);
  Cell cell;

 private:
  Drawing& drawing() { return cell.drawing; }

  /// The branch along y from x1 to x2, its further rows above. Within a series connection parallel ones stand
  /// a step inside, so that two of them next to each other do not share a line.
  void branch(const Branch& one, int x1, int x2, int y, bool within = false) {
    switch (one.kind) {
      case Branch::Kind::part: {
        const int middle = (x1 + x2) / 2;
        drawing().wire({x1, y}, {middle - 3, y}, one.left);
        drawing().part(parts_[one.part], texts_(parts_[one.part]), {middle, y}, true, one.left, one.right);
        drawing().wire({middle + 3, y}, {x2, y}, one.right);
        break;
      }
      case Branch::Kind::series: {
        int x = x1;
        for (size_t i = 0; i < one.children.size(); ++i) {
          const int end = i + 1 == one.children.size() ? x2 : x + size_of(one.children[i]).width;
          branch(one.children[i], x, end, y, true);
          x = end;
        }
        break;
      }
      case Branch::Kind::parallel: {
        const int step = within ? 1 : 0;
        drawing().wire({x1, y}, {x1 + step, y}, one.left);
        drawing().wire({x2 - step, y}, {x2, y}, one.right);
        int row = y;
        for (size_t i = 0; i < one.children.size(); ++i) {
          if (i > 0) {
            const int above = row - kPitch * (size_of(one.children[i - 1]).rows + 1);
            drawing().wire({x1 + step, row}, {x1 + step, above}, one.left);
            drawing().wire({x2 - step, row}, {x2 - step, above}, one.right);
            row = above;
          }
          branch(one.children[i], x1 + step, x2 - step, row);
        }
        break;
      }
    }
  }

  void anchor(Point at, const std::string& net, Anchor::Kind kind) {
    cell.anchors.push_back({at, net, kind, std::nullopt});
  }

  /// Ends a branch that comes from the right at (x, y): ground, or a name.
  void end_left(Point at, const std::string& net) {
    if (net == "0") {
      drawing().wire(at, at + Point{-2, 0}, net);
      drawing().supply("GND", at + Point{-2, 0}, net);
      return;
    }
    anchor(at, net, Anchor::Kind::end);
  }

  /// Takes the branches that fit out of `rest`.
  template <class Fits>
  static std::vector<Branch> take(std::vector<Branch>& rest, Fits fits) {
    std::vector<Branch> out;
    for (size_t i = 0; i < rest.size();) {
      if (fits(rest[i])) {
        out.push_back(std::move(rest[i]));
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      } else {
        ++i;
      }
    }
    return out;
  }

  /// `branches` end at the bus (x, y) of `node` and go to the left, the first along y, the others above.
  /// Returns the y above the last.
  int to_the_left(const std::vector<Branch>& branches, const std::string& node, int x, int y) {
    int width = 0;
    for (const Branch& one : branches) width = std::max(width, size_of(one).width);
    int row = y;
    for (const Branch& one : branches) {
      drawing().wire({x, y}, {x, row}, node);
      branch(one.from(one.other_end(node)), x - width, x, row);
      end_left({x - width, row}, one.other_end(node));
      row -= kPitch * (size_of(one).rows + 1);
    }
    return row;
  }

  /// A part from `node` at `at` straight down to ground.
  void down_to_ground(const Branch& one, const std::string& node, Point at) {
    const Point centre = at + Point{0, 6};  // clear of the texts of what lies next to it
    drawing().wire(at, centre + Point{0, -3}, node);
    drawing().part(parts_[one.part], texts_(parts_[one.part]), centre, false, node, "0");
    drawing().supply("GND", centre + Point{0, 3}, "0");
  }

  const std::vector<Part>& parts_;
  const PartTexts& texts_;
};

void CellMaker::opamp(const OpAmp& opamp, Symbol symbol, std::vector<Branch>& rest,
                      const std::set<std::string>& terminals, const std::string& before) {
  // What comes from the left stands lowest, where a wire can reach it.
  std::stable_partition(rest.begin(), rest.end(), [&](const Branch& one) { return one.ends_at(before); });
  const bool follower = opamp.minus == opamp.out;
  const bool minus_is_fed = !follower && std::ranges::any_of(rest, [&](const Branch& one) {
    return one.ends_at(opamp.minus) && one.other_end(opamp.minus) != opamp.out &&
           one.other_end(opamp.minus) != "0";
  });
  const bool minus_above = opamp.plus == "0" || minus_is_fed;
  const std::string &upper = minus_above ? opamp.minus : opamp.plus,
                    &lower = minus_above ? opamp.plus : opamp.minus, &out = opamp.out;
  symbol.mirrored = !minus_above;
  // Right of the middle, where the value of a part in the feedback stands.
  symbol.reference_mm[0] = 5.08;
  symbol.value_mm[0] = 2.54;
  symbol.reference_mm[1] = -5.08;
  symbol.value_mm[1] = 5.08;
  symbol.text_to_right = true;
  drawing().symbol(
      std::move(symbol),
      {{{-6, minus_above ? -2 : 2}, opamp.minus}, {{-6, minus_above ? 2 : -2}, opamp.plus}, {{6, 0}, out}});
  drawing().reach({4, -5});
  drawing().reach({4, 5});

  const auto fed_back = [&](const std::string& node) {
    return take(rest, [&](const Branch& one) { return node != out && one.joins(node, out); });
  };
  const std::vector<Branch> upper_back = fed_back(upper), lower_back = fed_back(lower);
  // An inner node that joins the upper input, the output or ground, and what comes before.
  std::string inner;
  for (const Branch& one : rest) {
    if (one.ends_at(upper) && !terminals.contains(one.other_end(upper))) inner = one.other_end(upper);
  }
  std::vector<Branch> inner_link, inner_back, inner_ground, inner_left;
  if (!inner.empty()) {
    inner_link = take(rest, [&](const Branch& one) { return one.joins(upper, inner); });
    inner_back = fed_back(inner);
    inner_ground = take(
        rest, [&](const Branch& one) { return one.joins(inner, "0") && one.kind == Branch::Kind::part; });
    inner_left = take(rest, [&](const Branch& one) { return one.ends_at(inner); });
  }
  const auto lone_ground = [&](const Branch& one) {
    return one.joins(lower, "0") && one.kind == Branch::Kind::part;
  };
  const std::vector<Branch> upper_left = take(rest, [&](const Branch& one) { return one.ends_at(upper); });
  const std::vector<Branch> lower_ground = lower == "0" ? std::vector<Branch>{} : take(rest, lone_ground);
  const std::vector<Branch> lower_left =
      lower == "0" ? std::vector<Branch>{}
                   : take(rest, [&](const Branch& one) { return one.ends_at(lower); });

  int x_out = kOut;
  for (const auto* list : {&upper_back, &lower_back}) {
    for (const Branch& one : *list) x_out = std::max(x_out, kBus + size_of(one).width);
  }

  // The upper input.
  const Point upper_bus{kBus, -2};
  drawing().wire({-6, -2}, upper_bus, upper);
  int above = -8;
  for (const Branch& one : upper_back) {
    drawing().wire(upper_bus, {kBus, above}, upper);
    branch(one.from(upper), kBus, x_out, above);
    drawing().wire({x_out, above}, {x_out, 0}, out);
    above -= kPitch * (size_of(one).rows + 1);
  }
  anchor(upper_bus, upper, Anchor::Kind::inner);
  const size_t upper_anchor = cell.anchors.size() - 1;
  size_t first_left = cell.anchors.size();
  if (inner.empty()) {
    to_the_left(upper_left, upper, kBus, -2);
  } else {
    int width = 0;
    for (const Branch& one : inner_link) width = std::max(width, size_of(one).width);
    // Room for what else ends at the input, next to the inner node's line.
    const int room = upper_left.empty() ? 0 : 5, x = kBus - width - room;
    branch(inner_link.front().from(inner), x, kBus, -2);
    int row = -2 - kPitch * (size_of(inner_link.front()).rows + 1);
    for (const Branch& one : upper_left) {
      drawing().wire(upper_bus, {kBus, row}, upper);
      branch(one.from(one.other_end(upper)), x + room, kBus, row);
      end_left({x + room, row}, one.other_end(upper));
      row -= kPitch * (size_of(one).rows + 1);
    }
    anchor({x, -2}, inner, Anchor::Kind::inner);
    first_left = cell.anchors.size();
    row = std::min(row, to_the_left(inner_left, inner, x, -2));
    above = std::min(above, row);
    for (const Branch& one : inner_back) {
      drawing().wire({x, -2}, {x, above}, inner);
      branch(one.from(inner), x, x_out, above);
      drawing().wire({x_out, above}, {x_out, 0}, out);
      above -= kPitch * (size_of(one).rows + 1);
    }
    for (const Branch& one : inner_ground) down_to_ground(one, inner, {x, -2});
  }
  for (size_t i = first_left; i < cell.anchors.size() && !cell.entry; ++i) {
    if (cell.anchors[i].kind == Anchor::Kind::end && cell.anchors[i].at.y == -2) cell.entry = i;
  }

  // Left of the upper input stand its parts: its name goes above them.
  int bus_top = upper_bus.y;
  for (const Wire& wire : drawing().wires) {
    if (wire.a.x == kBus && wire.b.x == kBus && wire.net == upper)
      bus_top = std::min({bus_top, wire.a.y, wire.b.y});
  }
  const Point name_at{kBus, bus_top - 3};
  cell.anchors[upper_anchor].name_at = name_at;
  drawing().reach(name_at + Point{0, -1});

  // The lower input.
  const Point lower_bus{kBus, 2};
  drawing().wire({-6, 2}, lower_bus, lower);
  if (lower == "0") {
    drawing().supply("GND", lower_bus, "0");
  } else {
    anchor(lower_bus, lower, Anchor::Kind::inner);
    int below = 2;
    for (const Branch& one : lower_back) {
      const int row = std::max(8, below + 6) + kPitch * size_of(one).rows;
      drawing().wire({kBus, below}, {kBus, row}, lower);
      branch(one.from(lower), kBus, x_out, row);
      drawing().wire({x_out, row}, {x_out, 0}, out);
      below = row;
    }
    if (lower == out) {
      drawing().wire({kBus, below}, {kBus, 7}, out);
      drawing().wire({kBus, 7}, {x_out, 7}, out);
      drawing().wire({x_out, 7}, {x_out, 0}, out);
      below = 7;
    }
    for (const Branch& one : lower_left) {
      const int row = below + (below == 2 ? 6 : kPitch) + kPitch * size_of(one).rows;
      drawing().wire({kBus, below}, {kBus, row}, lower);
      const int width = size_of(one).width;
      branch(one.from(one.other_end(lower)), kBus - width, kBus, row);
      end_left({kBus - width, row}, one.other_end(lower));
      below = row;
    }
    for (const Branch& one : lower_ground) down_to_ground(one, lower, {kBus, below});
  }

  drawing().wire({6, 0}, {x_out, 0}, out);
  anchor({x_out, 0}, out, Anchor::Kind::output);
  cell.exit = cell.anchors.size() - 1;
}

void CellMaker::loose(std::vector<Branch>& rest) {
  int row = 0;
  for (const Branch& one : rest) {
    row += kPitch * size_of(one).rows;
    const int width = size_of(one).width;
    branch(one, 0, width, row);
    end_left({0, row}, one.left);
    if (one.right == "0") {
      drawing().wire({width, row}, {width + 2, row}, "0");
      drawing().supply("GND", {width + 2, row}, "0");
    } else {
      anchor({width, row}, one.right, Anchor::Kind::output);
    }
    row += kPitch;
  }
  rest.clear();
}

}  // namespace

std::vector<Cell> stage_cells(const std::vector<Part>& parts, const std::vector<OpAmp>& opamps,
                              const std::string& in, const std::string& out, const PartTexts& texts,
                              const std::function<Symbol(const OpAmp&)>& opamp_symbol,
                              const std::set<std::string>& named) {
  std::set<std::string> terminals = {"0", in, out};
  terminals.insert(named.begin(), named.end());
  for (const OpAmp& opamp : opamps) terminals.insert({opamp.plus, opamp.minus, opamp.out});
  std::vector<Branch> rest = schematic::series_parallel_branches(parts, terminals);
  std::vector<Cell> cells;
  std::string before = in;
  for (const OpAmp& opamp : opamps) {
    CellMaker maker(parts, texts);
    maker.opamp(opamp, opamp_symbol(opamp), rest, terminals, before);
    before = opamp.out;
    cells.push_back(std::move(maker.cell));
  }
  if (!rest.empty()) {
    CellMaker maker(parts, texts);
    maker.loose(rest);
    cells.push_back(std::move(maker.cell));
  }
  return cells;
}

}  // namespace bodesmith::kicad
