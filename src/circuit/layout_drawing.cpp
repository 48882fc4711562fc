#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text.hpp"
#include "base/text_template.hpp"
#include "circuit/layout.hpp"

namespace bodesmith {
namespace {

std::string superscript(int power) {
  static const char* const digits[] = {"", "", "\u00b2", "\u00b3", "\u2074", "\u2075", "\u2076", "\u2077"};
  return digits[power];
}
std::string power_label(int power) {
  return "x" + superscript(power);
}

std::string value_label(const LayoutPart& part) {
  return engineering_text(part.realised, part.kind == LayoutPart::Kind::resistor ? "\u2126" : "F");
}

std::string formula(const LayoutBranch& branch) {
  std::string out = branch.name + ":  d(x) =";
  bool first = true;
  for (size_t k = 0; k < branch.wanted.size(); ++k) {
    const double a = branch.wanted[k];
    if (a == 0.0) continue;
    out += fmt::format(" {}{} {}", a < 0.0 ? "\u2212 " : (first ? "" : "+ "), rounded_text(std::abs(a)),
                       power_label(static_cast<int>(k) + 1));
    first = false;
  }
  return first ? out + " 0" : out;
}

/// Collects shapes; the template turns them into SVG.
class Sheet {
 public:
  using Points = std::vector<std::pair<double, double>>;

  void line(const Points& points, const std::string& kind = "wire") {
    shapes_["lines"].push_back({{"class", kind}, {"points", text_of(points)}});
  }
  void dot(double x, double y) {
    shapes_["dots"].push_back({{"class", "dot"}, {"x", x}, {"y", y}, {"r", 3.2}});
  }
  void terminal(double x, double y) {
    shapes_["dots"].push_back({{"class", "terminal"}, {"x", x}, {"y", y}, {"r", 5.0}});
  }
  void text(double x, double y, const std::string& what, const std::string& kind) {
    shapes_["texts"].push_back({{"class", kind}, {"x", x}, {"y", y}, {"text", what}});
  }
  void box(double x, double y, double w, double h, const std::string& kind, double r = 0.0) {
    shapes_["boxes"].push_back({{"class", kind}, {"x", x}, {"y", y}, {"w", w}, {"h", h}, {"r", r}});
  }
  void ground(double x, double y, bool up) {
    const double s = up ? -1.0 : 1.0;
    line({{x, y}, {x, y + 8 * s}});
    for (int i = 0; i < 3; ++i)
      line({{x - 9 + 3 * i, y + (8 + 4 * i) * s}, {x + 9 - 3 * i, y + (8 + 4 * i) * s}});
  }
  void resistor_down(double x, double y, const LayoutPart& part) {
    box(x - 6, y, 12, 40, "resistor");
    text(x + 10, y + 17, part.name, "name");
    text(x + 10, y + 31, value_label(part), "value");
  }
  void resistor_right(double x, double y, const LayoutPart& part) {
    box(x, y - 6, 44, 12, "resistor");
    text(x + 22, y - 11, fmt::format("{}  {}", part.name, value_label(part)), "value middle");
  }
  /// Input pins at (x, minus) and (x, plus); tip returned.
  std::pair<double, double> opamp(double x, double minus, double plus, const std::string& name) {
    const double middle = 0.5 * (minus + plus), half = 0.5 * (plus - minus) + 18;
    shapes_["opamps"].push_back(
        {{"points", text_of({{x, middle - half}, {x, middle + half}, {x + 66, middle}})}});
    text(x + 6, minus + 5, "\u2212", "sign");
    text(x + 6, plus + 5, "+", "sign");
    text(x + 24, middle + 4, name, "name");
    return {x + 66, middle};
  }
  std::string render(double width, double height, const std::string& title) {
    Json data;
    for (const char* list : {"lines", "boxes", "opamps", "dots", "texts"}) {
      data[list] = shapes_.contains(list) ? shapes_[list] : Json::array();
    }
    data["width"] = std::lround(width);
    data["height"] = std::lround(height);
    data["title"] = title;
    return render_template("layout/drawing.svg", data);
  }

 private:
  static std::string text_of(const Points& points) {
    std::string out;
    for (const auto& [x, y] : points) out += fmt::format("{}{:.6g},{:.6g}", out.empty() ? "" : " ", x, y);
    return out;
  }
  std::map<std::string, Json> shapes_;
};

class Drawing {
 public:
  explicit Drawing(const DisturbanceLayout& layout) : layout_(layout) {}

  std::string draw() {
    header();
    rails();
    double x = kLeft + 70 + 140.0 * static_cast<double>(layout_.multipliers.size());
    std::vector<std::pair<double, double>> outs;
    for (const LayoutBranch& branch : layout_.branches) {
      outs.push_back(sum(branch, x));
      x = outs.back().first + 60;
    }
    const auto source = layout_.branches.size() > 1 ? change_over(outs) : straight(outs[0]);
    const double right = output(source);
    for (const auto& [power, from] : rail_from_) {
      sheet_.line({{from, rail_y_[power]}, {rail_to_[power], rail_y_[power]}}, "rail");
    }
    return sheet_.render(std::max({x, right + 90, 640.0}), bottom_ + 30, "Disturbance generator");
  }

 private:
  void header() {
    sheet_.text(kLeft - 14, 34, "Disturbance generator", "title");
    double y = 58;
    for (const LayoutBranch& branch : layout_.branches) {
      sheet_.text(kLeft - 14, y, formula(branch), "formula");
      y += 19;
    }
    sheet_.text(
        kLeft - 14, y,
        fmt::format(
            "{}: W = X\u00b7Y/U + Z, U = {} V; 1 V at x is full stroke, 1 V at out is d = 1; parts from {}",
            layout_.multiplier.name, rounded_text(layout_.multiplier.scale_v), series()),
        "formula");
    top_ = y + 36;
  }

  std::string series() const {
    for (const LayoutPart& part : layout_.parts) {
      if (part.kind == LayoutPart::Kind::resistor) return part.series;
    }
    return "";
  }

  void tap(int power, double x) {
    sheet_.dot(x, rail_y_[power]);
    rail_to_[power] = std::max(rail_to_[power], x);
    rail_from_[power] = std::min(rail_from_[power], x);
  }

  void rails() {
    std::vector<int> powers = {1};
    for (const LayoutMultiplier& m : layout_.multipliers) powers.push_back(m.power);
    double y = top_;
    for (const int power : powers) {
      rail_y_[power] = y;
      rail_from_[power] = power == 1 ? kLeft : 1e9;
      rail_to_[power] = power == 1 ? kLeft + 30 : 0.0;
      y += 30;
    }
    sheet_.terminal(kLeft, rail_y_[1]);
    sheet_.text(kLeft - 12, rail_y_[1] + 5, "x", "net end");
    row_ = y + 22;
    double x = kLeft + 60;
    for (const LayoutMultiplier& m : layout_.multipliers) {
      sheet_.box(x, row_, 68, 58, "multiplier", 4);
      sheet_.text(x + 34, row_ + 34, "\u00d7", "times middle");
      sheet_.text(x + 34, row_ + 52, m.name, "name middle");
      sheet_.text(x + 13, row_ + 14, "X", "value middle");
      sheet_.text(x + 41, row_ + 14, "Y", "value middle");
      sheet_.text(x + 58, row_ + 33, "W", "value middle");
      sheet_.line({{x + 14, row_}, {x + 14, rail_y_[m.x_power]}});
      sheet_.line({{x + 42, row_}, {x + 42, rail_y_[m.y_power]}});
      tap(m.x_power, x + 14);
      tap(m.y_power, x + 42);
      sheet_.line({{x + 68, row_ + 29}, {x + 92, row_ + 29}, {x + 92, rail_y_[m.power]}});
      tap(m.power, x + 92);
      sheet_.text(x + 98, rail_y_[m.power] - 6,
                  power_label(m.power) + (m.power == 2 ? "/U" : "/U" + superscript(m.power - 1)), "net");
      x += 140;
    }
  }

  /// One branch from x on; its output.
  std::pair<double, double> sum(const LayoutBranch& branch, double x) {
    const double minus = row_ + 84, plus = minus + 44;
    double first_minus = 0.0, first_plus = 0.0;
    const double start = x;
    const auto column = [&](int power, const LayoutPart& part, bool to_plus) {
      if (power > 0) {
        tap(power, x);
        sheet_.line({{x, rail_y_[power]}, {x, row_}});
      } else {
        sheet_.ground(x, row_, true);
      }
      sheet_.resistor_down(x, row_, part);
      const double end = to_plus ? plus : minus;
      sheet_.line({{x, row_ + 40}, {x, end}});
      double& first = to_plus ? first_plus : first_minus;
      if (first == 0.0) {
        first = x;
      } else {
        sheet_.dot(x, end);
      }
      x += 72;
    };
    const auto columns = [&](bool to_plus) {
      for (size_t k = 0; k < branch.weight.size(); ++k) {
        if (branch.weight[k] >= 0 && branch.at_plus[k] == to_plus) {
          column(static_cast<int>(k) + 1, layout_.part(branch.weight[k]), to_plus);
        }
      }
      if (branch.balance >= 0 && (layout_.part(branch.balance).to == "0") &&
          (layout_.part(branch.balance).from == branch.plus) == to_plus) {
        column(0, layout_.part(branch.balance), to_plus);
      }
    };
    columns(true);
    columns(false);
    x += 34;
    const auto tip = sheet_.opamp(x, minus, plus, fmt::format("U{}", &branch - layout_.branches.data() + 1));
    const double knot = x - 22;
    sheet_.line({{first_minus > 0.0 ? first_minus : knot, minus}, {x, minus}});
    if (first_plus > 0.0) {
      sheet_.line({{first_plus, plus}, {x, plus}});
    } else {
      sheet_.line({{x, plus}, {x - 14, plus}});
      sheet_.ground(x - 14, plus, false);
    }
    // Feedback over the top.
    const double above = minus - 42;
    if (first_minus > 0.0) sheet_.dot(knot, minus);
    sheet_.line({{knot, minus}, {knot, above}, {knot + 28, above}});
    sheet_.resistor_right(knot + 28, above, layout_.part(branch.feedback));
    const double out = tip.first + 20;
    sheet_.line({{knot + 72, above}, {out, above}, {out, tip.second}});
    sheet_.line({{tip.first, tip.second}, {out, tip.second}});
    sheet_.dot(out, tip.second);
    sheet_.text(start, plus + 40,
                fmt::format("{}: \u2212{} d(x)", branch.name, rounded_text(layout_.branch_gain)), "note");
    lower_ = plus + 84;
    return {out, tip.second};
  }

  std::pair<double, double> straight(std::pair<double, double> out) {
    const double y = lower_ + 40;
    sheet_.line({out, {out.first, y}});
    return {out.first, y};
  }

  /// The switch between two branch outputs and the detector that drives it; the common contact.
  std::pair<double, double> change_over(const std::vector<std::pair<double, double>>& outs) {
    const double y = lower_;
    const double x = std::round(0.5 * (outs[0].first + outs[1].first));
    sheet_.line({outs[0], {outs[0].first, y}, {x - 34, y}});
    sheet_.line({outs[1], {outs[1].first, y}, {x + 34, y}});
    sheet_.terminal(x - 34, y);
    sheet_.terminal(x + 34, y);
    sheet_.terminal(x, y + 50);
    sheet_.line({{x - 3, y + 45}, {x - 30, y + 6}}, "wire");
    sheet_.text(x + 16, y + 42, fmt::format("S1  {} \u2126", rounded_text(layout_.switch_on_ohm)), "value");
    // Slope detector at the left, its output to the lever.
    const double left = kLeft + 60, top = y - 16, width = 250;
    sheet_.box(left, top, width, 92, "box", 6);
    sheet_.text(left + 12, top + 21, "slope detector", "name");
    const auto value = [&](const char* name) {
      const LayoutPart* part = layout_.part_named(name);
      return part == nullptr ? std::string() : fmt::format("{} {}", name, value_label(*part));
    };
    sheet_.text(left + 12, top + 41, fmt::format("differentiator: {}, {}", value("Cd"), value("Rd")),
                "value");
    sheet_.text(left + 12, top + 58, fmt::format("{}, {}, two diodes across Rd", value("Rs"), value("Cf")),
                "value");
    sheet_.text(left + 12, top + 75, fmt::format("comparator: {}, {}", value("Rh1"), value("Rh2")), "value");
    sheet_.line({{kLeft + 24, rail_y_[1]}, {kLeft + 24, top + 46}, {left, top + 46}});
    tap(1, kLeft + 24);
    sheet_.line({{left + width, top + 40}, {x - 18, top + 40}}, "control");
    sheet_.text(left + width + 12, top + 34, "branch", "note");
    bottom_ = std::max(bottom_, top + 92);
    return {x, y + 55};
  }

  double output(std::pair<double, double> source) {
    const double y = source.second + 40;
    double x = source.first;
    sheet_.line({source, {x, y}, {x + 30, y}});
    sheet_.resistor_right(x + 30, y, layout_.part(layout_.output_input));
    const double knot = x + 110, pin = knot + 22;
    sheet_.line({{x + 74, y}, {pin, y}});
    const auto tip = sheet_.opamp(pin, y, y + 40, fmt::format("U{}", layout_.branches.size() + 1));
    sheet_.line({{pin, y + 40}, {pin - 14, y + 40}});
    sheet_.ground(pin - 14, y + 40, false);
    sheet_.dot(knot, y);
    sheet_.line({{knot, y}, {knot, y - 38}, {knot + 28, y - 38}});
    sheet_.resistor_right(knot + 28, y - 38, layout_.part(layout_.output_feedback));
    const double out = tip.first + 22;
    sheet_.line({{knot + 72, y - 38}, {out, y - 38}, {out, tip.second}});
    sheet_.dot(out, tip.second);
    sheet_.line({tip, {out + 40, tip.second}});
    sheet_.terminal(out + 44, tip.second);
    sheet_.text(out + 56, tip.second + 5, "out = d(x)", "net");
    bottom_ = std::max(bottom_, y + 80);
    return out + 90;
  }

  static constexpr double kLeft = 44;

  const DisturbanceLayout& layout_;
  Sheet sheet_;
  double top_ = 0.0, row_ = 0.0, lower_ = 0.0, bottom_ = 0.0;
  std::map<int, double> rail_y_, rail_from_, rail_to_;
};

}  // namespace

std::string layout_drawing(const DisturbanceLayout& layout) {
  return Drawing(layout).draw();
}

}  // namespace bodesmith
