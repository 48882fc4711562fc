#include "schematic/writers/kicad/drawing.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

namespace bodesmith::kicad {

void Drawing::reach(Point a) {
  left = std::min(left, a.x);
  right = std::max(right, a.x);
  top = std::min(top, a.y);
  bottom = std::max(bottom, a.y);
}

void Drawing::wire(Point a, Point b, const std::string& net) {
  if (a == b) return;
  if (a.x != b.x && a.y != b.y) throw std::logic_error("a slanted wire");
  reach(a);
  reach(b);
  wires.push_back({a, b, net});
}

void Drawing::label(Label label) {
  reach(label.at);
  const int length = static_cast<int>(label.net.size()) + 1;
  reach(label.at + Point{label.to_left ? -length : length, -1});
  taps.push_back({label.at, label.net, false});
  labels.push_back(std::move(label));
}

void Drawing::symbol(Symbol symbol, const std::vector<Tap>& pins) {
  for (const Tap& pin : pins) {
    reach(pin.at);
    taps.push_back(pin);
  }
  symbols.push_back(std::move(symbol));
}

void Drawing::part(const schematic::Part& part, const Symbol& like, Point at, bool horizontal,
                   const std::string& first, const std::string& second) {
  Symbol out = like;
  const bool resistor = part.kind == schematic::Part::Kind::resistor;
  out.kind = resistor ? "R" : "C";
  out.at = at;
  out.angle = horizontal ? 90 : 0;
  out.pins = {"1", "2"};
  const double aside = resistor ? 2.286 : 3.302;
  if (horizontal) {
    out.reference_mm[1] = -aside;
    out.value_mm[1] = aside;
    reach(at + Point{0, -3});
    reach(at + Point{0, 3});
  } else {
    out.text_to_right = true;
    out.reference_mm[0] = out.value_mm[0] = aside - 0.4;
    out.reference_mm[1] = -1.27;
    out.value_mm[1] = 1.27;
    reach(at + Point{9, 0});
  }
  const Point half = horizontal ? Point{3, 0} : Point{0, 3};
  symbol(std::move(out), {{at + Point{-half.x, -half.y}, first}, {at + half, second}});
}

void Drawing::supply(const std::string& kind, Point at, const std::string& net, int angle) {
  Symbol out;
  out.kind = kind;
  out.value = kind;
  out.at = at;
  out.angle = angle;
  out.pins = {"1"};
  const bool downwards = kind == "GND" || kind == "VEE" || kind == "V5N" || angle == 180;
  const double away = downwards ? 3.302 : -3.556;
  out.value_mm[1] = away;
  reach(at + Point{0, downwards ? 4 : -4});
  symbol(std::move(out), {{at, net}});
}

void Drawing::append(const Drawing& other, Point shift) {
  for (Wire one : other.wires) {
    one.a = one.a + shift;
    one.b = one.b + shift;
    wires.push_back(std::move(one));
  }
  const auto add = [&](const auto& from, auto& to) {
    for (auto one : from) {
      one.at = one.at + shift;
      to.push_back(std::move(one));
    }
  };
  add(other.taps, taps);
  add(other.labels, labels);
  add(other.symbols, symbols);
  add(other.texts, texts);
  reach(Point{other.left, other.top} + shift);
  reach(Point{other.right, other.bottom} + shift);
}

Joined join_wires(const Drawing& drawing) {
  std::map<Point, std::string> ends;
  const auto claim = [&](Point at, const std::string& net) {
    const auto [place, is_new] = ends.try_emplace(at, net);
    if (!is_new && place->second != net) {
      throw std::logic_error("nets " + place->second + " and " + net + " touch in the schematic");
    }
  };
  for (const Wire& wire : drawing.wires) {
    claim(wire.a, wire.net);
    claim(wire.b, wire.net);
  }
  for (const Tap& tap : drawing.taps) claim(tap.at, tap.net);

  Joined out;
  std::set<std::pair<Point, Point>> seen;
  std::map<Point, int> meeting;
  for (const Wire& wire : drawing.wires) {
    const Point low = std::min(wire.a, wire.b), high = std::max(wire.a, wire.b);
    std::vector<Point> stops;
    for (const auto& [at, net] : ends) {
      const bool on = at >= low && at <= high && (low.x == high.x ? at.x == low.x : at.y == low.y);
      if (!on) continue;
      if (net != wire.net) {
        throw std::logic_error("nets " + net + " and " + wire.net + " touch in the schematic");
      }
      stops.push_back(at);
    }
    for (size_t i = 1; i < stops.size(); ++i) {
      if (!seen.insert({stops[i - 1], stops[i]}).second) continue;
      out.wires.push_back({stops[i - 1], stops[i], wire.net});
      ++meeting[stops[i - 1]];
      ++meeting[stops[i]];
    }
  }
  for (const Tap& tap : drawing.taps) {
    if (tap.pin) ++meeting[tap.at];
  }
  for (const auto& [at, count] : meeting) {
    if (count >= 3) out.junctions.push_back(at);
  }
  return out;
}

}  // namespace bodesmith::kicad
