#pragma once

#include <compare>
#include <string>
#include <vector>

#include "schematic/netlist.hpp"

namespace bodesmith::kicad {

/// Lengths are whole steps of KiCad's 50 mil grid (1.27 mm); y grows downwards.
constexpr double kGridMm = 1.27;

struct Point {
  int x = 0, y = 0;
  auto operator<=>(const Point&) const = default;
  Point operator+(Point b) const { return {x + b.x, y + b.y}; }
};

struct Wire {
  Point a, b;
  std::string net;
};

/// A pin of a symbol, or a label: a point where a net can be taken.
struct Tap {
  Point at;
  std::string net;
  bool pin = true;
};

struct Label {
  Point at;
  std::string net;
  bool to_left = false;                                         ///< the text runs to the left of the point
  enum class Kind { local, input, output } kind = Kind::local;  ///< input and output lead out of the sheet
};

struct Field {
  std::string name, value;
};

struct Symbol {
  std::string kind;  ///< in the library: "R", "C", "OpAmp", "GND", …
  std::string reference, value, footprint;
  int unit = 1;
  Point at;
  int angle = 0;
  bool mirrored = false;            ///< upside down
  double reference_mm[2] = {0, 0};  ///< of the texts, from the symbol's place
  double value_mm[2] = {0, 0};
  bool text_to_right = false;  ///< texts begin there instead of being centred
  bool value_hidden = false;
  std::vector<Field> fields;      ///< hidden
  std::vector<std::string> pins;  ///< numbers
};

struct Text {
  Point at;
  std::string text;
};

/// What stands on one sheet, or on a piece of one.
class Drawing {
 public:
  std::vector<Wire> wires;
  std::vector<Tap> taps;
  std::vector<Label> labels;
  std::vector<Symbol> symbols;
  std::vector<Text> texts;
  int left = 0, right = 0, top = 0, bottom = 0;

  /// A straight wire; none when both ends are one.
  void wire(Point a, Point b, const std::string& net);
  void label(Label label);
  /// A resistor or capacitor centred at `at`, its pins 3 steps away on both sides.
  void part(const schematic::Part& part, const Symbol& like, Point at, bool horizontal,
            const std::string& first, const std::string& second);
  /// GND, VCC, VEE or PWR_FLAG with its pin at `at`.
  void supply(const std::string& kind, Point at, const std::string& net, int angle = 0);
  void symbol(Symbol symbol, const std::vector<Tap>& pins);
  void reach(Point a);
  void append(const Drawing& other, Point shift);
};

/// Wires cut wherever something of their net ends on them, each once, and the points where three or more
/// ends meet. Throws std::logic_error where two nets touch: a drawing must not join what the circuit does
/// not.
struct Joined {
  std::vector<Wire> wires;
  std::vector<Point> junctions;
};
Joined join_wires(const Drawing& drawing);

}  // namespace bodesmith::kicad
