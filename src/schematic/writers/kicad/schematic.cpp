#include "schematic/writers/kicad/schematic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <compare>
#include <cstdlib>
#include <map>
#include <utility>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "schematic/writers/kicad/devices.hpp"
#include "schematic/writers/kicad/text.hpp"
#include "signal/csv.hpp"

namespace bodesmith::kicad {
namespace {

/// What is ordered together, and in what order lines stand.
struct Order {
  std::string letters;
  std::string value, tolerance, footprint;
  auto operator<=>(const Order&) const = default;
};

/// A line for all that is alike. References and names in the netlist stand in the same order, the units of one package
/// joined by '+', '-' where the netlist has no name.
std::string bill_of_materials(const std::vector<Sheet>& sheets) {
  struct Piece {
    Order order;
    std::map<int, std::string> units;
  };
  std::map<std::pair<std::string, int>, Piece> pieces;  // letters and number
  for (const Sheet& sheet : sheets) {
    for (const Symbol& symbol : sheet.drawing.symbols) {
      if (symbol.reference.empty()) continue;  // supplies and flags
      const std::size_t digits = symbol.reference.find_first_of("0123456789");
      const std::string letters = symbol.reference.substr(0, digits);
      Piece& piece = pieces[{letters, std::atoi(symbol.reference.c_str() + digits)}];
      const std::string tolerance = piece.order.tolerance;
      piece.order = {letters, symbol.value, tolerance, symbol.footprint};
      for (const Field& field : symbol.fields) {
        if (field.name == "Netlist") piece.units[symbol.unit] = field.value;
        if (field.name == "Tolerance") piece.order.tolerance = field.value;
      }
    }
  }
  std::map<Order, std::pair<std::vector<std::string>, std::vector<std::string>>> lines;
  for (const auto& [reference, piece] : pieces) {
    auto& [references, names] = lines[piece.order];
    references.push_back(reference.first + std::to_string(reference.second));
    std::vector<std::string> units;
    for (const auto& [unit, name] : piece.units) units.push_back(name);
    names.push_back(units.empty() ? "-" : join(units, "+"));
  }
  CsvTable table({"quantity", "references", "value", "tolerance", "footprint", "netlist"});
  for (const auto& [order, line] : lines)
    table.add_row({std::to_string(line.first.size()), join(line.first, " "), order.value, order.tolerance,
                   order.footprint, join(line.second, " ")});
  return table.text();
}

/// Sheets as a project: STEM.kicad_pro, the sheets (the first is the root), the symbols, and bom.csv
/// (`reference,value,footprint,netlist`), a line for everything that is mounted, in the order of the references; `netlist`
/// holds the names in the netlist of a part or of the units of a package, empty for what only the board has.
void add_project_files(const std::vector<Sheet>& sheets, const std::string& stem, const std::string& title,
                       const std::string& comment, OutputSet& out, const std::filesystem::path& folder = {}) {
  const std::vector<std::string> texts = sheet_texts(sheets, title, comment);
  for (std::size_t i = 0; i < sheets.size(); ++i) out.add(folder / sheets[i].file, texts[i]);
  Json project;
  project["meta"] = {{"filename", stem + ".kicad_pro"}, {"version", 1}};
  project["sheets"] = Json::array({Json::array({root_uuid(title), ""})});
  project["text_variables"] = Json::object();
  out.add(folder / (stem + ".kicad_pro"), to_text(project));
  out.add(folder / "bodesmith.kicad_sym", symbol_library_text());
  out.add(folder / "bom.csv", bill_of_materials(sheets));
  out.add(folder / "sym-lib-table", symbol_table_text());
}

/// Every group on one sheet, the smallest paper from A4 to A0 that holds them.
Sheet one_sheet(const schematic::Netlist& netlist, const SheetOptions& options) {
  const NetlistGroups groups = netlist_groups(netlist, options.ports);
  std::vector<const Group*> all;
  for (const Group& group : groups.sections) all.push_back(&group);
  if (options.board)
    for (const Group& group : groups.board) all.push_back(&group);
  for (const Paper& paper : kPapers) {
    const Rows rows = fitted_rows(paper, all);
    if (!rows.empty()) return {options.stem + ".kicad_sch", paper.name, rows.drawing(), {}};
  }
  throw DesignError("the schematic is larger than an A0 sheet");
}

class Schematic {
 public:
  Schematic(const schematic::Netlist& netlist, const std::vector<ChainStage>& chain,
            const SheetOptions& options)
      : stem_(options.stem) {
    NetlistGroups groups = netlist_groups(netlist, options.ports, chain);
    groups_ = std::move(groups.sections);
    board_ = std::move(groups.board);
  }

  /// One sheet when A3 is enough, otherwise a first sheet with a box for each of the others.
  std::vector<Sheet> sheets() const {
    std::vector<const Group*> all;
    for (const Group& group : groups_) all.push_back(&group);
    for (const Group& group : board_) all.push_back(&group);
    for (const Paper& paper : {kPapers[0], kPapers[1]}) {
      const Rows rows = fitted_rows(paper, all);
      if (!rows.empty()) return {{stem_ + ".kicad_sch", paper.name, rows.drawing(), {}}};
    }
    return with_boxes();
  }

 private:
  std::vector<Sheet> with_boxes() const {
    const Paper& paper = paper_for_stages();
    std::vector<Sheet> out(1);
    std::vector<SheetBox> boxes;
    const auto add = [&](Sheet sheet, const std::string& name, const std::string& in,
                         const std::string& end) {
      sheet.file = fmt::format("{}_{}.kicad_sch", stem_, out.size() + 1);
      SheetBox box;
      box.name = name;
      box.file = sheet.file;
      box.in = in;
      box.out = end;
      boxes.push_back(box);
      out.push_back(std::move(sheet));
    };
    for (auto& [sheet, first, last] : filled(paper, groups_, 0)) {
      make_port(sheet.drawing, groups_[first].in, Label::Kind::input);
      make_port(sheet.drawing, groups_[last - 1].out, Label::Kind::output);
      add(std::move(sheet),
          last == first + 1 ? fmt::format("stage {}", last) : fmt::format("stages {} to {}", first + 1, last),
          groups_[first].in, groups_[last - 1].out);
    }
    // Connectors and supplies below the boxes, or, when there are too many, the supplies on sheets like the stages.
    std::vector<const Group*> board;
    for (const Group& group : board_) board.push_back(&group);
    const auto below = [&](const Paper& size) { return kMargin + kBoxLine * lines_of(boxes.size(), size); };
    if (fitted_rows(paper, board, below(paper)).empty()) {
      board.resize(1);
      int number = 0;
      for (auto& [sheet, first, last] : filled(paper, board_, 1))
        add(std::move(sheet), fmt::format("supplies {}", ++number), "", "");
    }
    for (const Paper& size : kPapers) {
      const Rows rows = fitted_rows(size, board, below(size));
      if (rows.empty()) continue;
      Sheet& root = out[0];
      root.file = stem_ + ".kicad_sch";
      root.paper = size.name;
      root.boxes = boxes;
      place_boxes(root, columns_of(size));
      root.drawing.append(rows.drawing(), {0, 0});
      return out;
    }
    throw DesignError("the circuit is larger than a KiCad project of A0 sheets");
  }

  static constexpr int kBoxWidth = 28, kBoxHeight = 16, kBoxStep = 42, kBoxLine = 26;
  static int columns_of(const Paper& paper) { return (paper.width - 2 * kMargin) / kBoxStep; }
  static int lines_of(size_t boxes, const Paper& paper) {
    return (static_cast<int>(boxes) + columns_of(paper) - 1) / columns_of(paper);
  }

  /// Sheets that take the groups from `first` on in their order, as many as each holds.
  struct Filled {
    Sheet sheet;
    size_t first = 0, last = 0;
  };
  static std::vector<Filled> filled(const Paper& paper, const std::vector<Group>& groups, size_t first) {
    std::vector<Filled> out;
    while (first < groups.size()) {
      Rows rows(paper);
      std::vector<const Group*> here;
      size_t last = first;
      while (last < groups.size() && rows.add(groups[last])) here.push_back(&groups[last++]);
      out.push_back({{"", paper.name, fitted_rows(paper, here).drawing(), {}}, first, last});
      first = last;
    }
    return out;
  }

  /// In lines of `across`, the signal from each to the next by a wire or, at the end of a line, by name.
  static void place_boxes(Sheet& root, int across) {
    Drawing& drawing = root.drawing;
    for (size_t i = 0; i < root.boxes.size(); ++i) {
      SheetBox& box = root.boxes[i];
      const int column = static_cast<int>(i) % across, line = static_cast<int>(i) / across;
      box.at = {kMargin + 6 + column * kBoxStep, kMargin + 4 + line * kBoxLine};
      box.width = kBoxWidth;
      box.height = kBoxHeight;
      drawing.reach(box.at + Point{kBoxWidth, kBoxHeight + 2});
      if (box.in.empty()) continue;
      const int y = box.at.y + kBoxHeight / 2;
      const Point in{box.at.x, y}, end{box.at.x + kBoxWidth, y};
      drawing.taps.push_back({in, box.in});
      drawing.taps.push_back({end, box.out});
      const bool wired_before = i > 0 && column > 0;
      const bool wired_after =
          i + 1 < root.boxes.size() && column + 1 < across && !root.boxes[i + 1].in.empty();
      if (!wired_before) {
        drawing.wire(in + Point{-2, 0}, in, box.in);
        drawing.label({in + Point{-2, 0}, box.in, true});
      }
      drawing.wire(end, end + Point{wired_after ? kBoxStep - kBoxWidth : 2, 0}, box.out);
      drawing.label({end + Point{2, 0}, box.out, false});
    }
  }

  /// A3, or what the largest stage needs.
  const Paper& paper_for_stages() const {
    for (const Paper& paper : kPapers) {
      const bool holds =
          std::ranges::all_of(groups_, [&](const Group& group) { return Rows(paper).add(group); });
      if (holds && paper.width >= kPapers[1].width) return paper;
    }
    throw DesignError("a stage is larger than an A0 sheet");
  }

  /// The first label of the net leads out of the sheet.
  static void make_port(Drawing& drawing, const std::string& net, Label::Kind kind) {
    for (Label& label : drawing.labels) {
      if (label.net == net && label.to_left == (kind == Label::Kind::input)) {
        label.kind = kind;
        return;
      }
    }
    throw std::logic_error("the net " + net + " has no label to lead it out of the sheet");
  }

  std::string stem_;
  std::vector<Group> groups_, board_;
};

}  // namespace

void add_netlist_project(const schematic::Netlist& netlist, const SheetOptions& options, OutputSet& out,
                         const std::filesystem::path& folder) {
  const Sheet sheet = one_sheet(netlist, options);
  add_project_files({sheet}, options.stem, options.title, options.comment, out, folder);
  out.add(folder / (options.stem + ".svg"), sheet_svg(sheet, options.title));
}

std::string netlist_svg(const schematic::Netlist& netlist, const SheetOptions& options) {
  return sheet_svg(one_sheet(netlist, options), options.title);
}

void add_chain_project(const schematic::Netlist& netlist, const std::vector<ChainStage>& chain,
                       const SheetOptions& options, OutputSet& out) {
  add_project_files(Schematic(netlist, chain, options).sheets(), options.stem, options.title, options.comment,
                    out);
}

}  // namespace bodesmith::kicad
