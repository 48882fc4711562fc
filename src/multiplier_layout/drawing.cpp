#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "base/whole_number.hpp"
#include "multiplier_layout/layout.hpp"

namespace bodesmith::multiplier_layout {
namespace {

std::string superscript(int power) {
  static const char* const digits[] = {"", "", "\u00b2", "\u00b3", "\u2074", "\u2075", "\u2076", "\u2077"};
  return digits[power];
}
std::string power_label(int power) {
  return "x" + superscript(power);
}

std::string value_label(const Part& part) {
  return engineering_text(part.realised, part.kind == Part::Kind::resistor ? "\u2126" : "F");
}

std::string formula(const Branch& branch) {
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
  void resistor_down(double x, double y, const Part& part) {
    box(x - 6, y, 12, 40, "resistor");
    text(x + 10, y + 17, part.name, "name");
    text(x + 10, y + 31, value_label(part), "value");
  }
  /// Net label at the end of a wire.
  void net(double x, double y, const std::string& name, const std::string& anchor = "middle") {
    text(x, y, name, "net " + anchor);
  }
  void resistor_right(double x, double y, const Part& part) {
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
    data["width"] = nearest_whole<long>(width);
    data["height"] = nearest_whole<long>(height);
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

/// Blocks in rows, joined by net labels: the names in the netlist.
class Drawing {
 public:
  explicit Drawing(const Layout& layout) : layout_(layout) {}

  std::string draw() {
    header();
    powers();
    for (size_t b = 0; b < layout_.branches.size(); ++b) branch(b);
    if (layout_.amplitude) amplitude();
    next_row();
    output();
    return sheet_.render(std::max(right_ + 40, 760.0), y_ + 30, "Disturbance generator");
  }

 private:
  static constexpr double kLeft = 30, kWide = 1560, kColumn = 72;

  void header() {
    sheet_.text(kLeft, 34, "Disturbance generator", "title");
    y_ = 58;
    for (const Branch& branch : layout_.branches) {
      sheet_.text(kLeft, y_, formula(branch), "formula");
      y_ += 19;
    }
    sheet_.text(kLeft, y_,
                fmt::format("{}: W = X\u00b7Y/U + Z, U = {} V; 1 V at x is full stroke, 1 V at out is d = 1; "
                            "parts from {}",
                            layout_.multiplier.name, rounded_text(layout_.multiplier.scale_v),
                            layout_.part(layout_.output_input).series),
                "formula");
    if (layout_.amplitude) {
      y_ += 19;
      sheet_.text(
          kLeft, y_,
          "With amplitude gains: x is the reference divided by its stroke \u03b1, 1 V at amplitude is "
          "\u03b1 = 1",
          "formula");
    }
    y_ += 34;
  }

  void next_row() {
    y_ += row_;
    x_ = kLeft;
    row_ = 0.0;
  }

  /// Room for a block of this size at (x_, y_), in the next row if this one is full.
  void room(double width, double height) {
    if (x_ > kLeft && x_ + width > kWide) next_row();
    row_ = std::max(row_, height);
    right_ = std::max(right_, x_ + width);
  }

  /// The shared powers on rails.
  void powers() {
    std::vector<const Multiplier*> shared;
    for (const Multiplier& m : layout_.multipliers) {
      if (m.z == "0" && m.x.starts_with("x") && m.y.starts_with("x") && m.out.starts_with("x"))
        shared.push_back(&m);
    }
    std::map<std::string, double> rail = {{"x", y_}}, from = {{"x", kLeft + 30}};
    double y = y_;
    for (const Multiplier* m : shared) rail[m->out] = y += 28;
    const double top = y + 24;
    const double end = kLeft + 70 + 140.0 * static_cast<double>(shared.size());
    double x = kLeft + 60;
    for (const Multiplier* m : shared) {
      multiplier_box(x, top, m->name);
      for (const auto& [pin, node] : {std::pair{14.0, m->x}, std::pair{42.0, m->y}}) {
        sheet_.line({{x + pin, top}, {x + pin, rail[node]}});
        sheet_.dot(x + pin, rail[node]);
      }
      sheet_.line({{x + 68, top + 29}, {x + 92, top + 29}, {x + 92, rail[m->out]}});
      sheet_.dot(x + 92, rail[m->out]);
      from[m->out] = x + 92;
      x += 140;
    }
    sheet_.terminal(kLeft + 25, rail["x"]);
    sheet_.text(kLeft, rail["x"] + 5, "x", "net");
    for (const auto& [node, at] : rail) {
      sheet_.line({{from[node], at}, {end, at}}, "rail");
      std::string label = node;
      for (const Multiplier* m : shared) {
        if (m->out == node) label += " = " + label_of(m->role);
      }
      sheet_.text(end + 8, at + 5, label, "net");
    }
    right_ = std::max(right_, end + 90);
    y_ = top + (shared.empty() ? 0.0 : 58.0) + 34;
    x_ = kLeft;
  }

  /// "x^2/U" with raised digits.
  static std::string label_of(const std::string& what) {
    std::string out;
    for (size_t i = 0; i < what.size(); ++i) {
      if (what[i] == '^' && i + 1 < what.size()) {
        out += superscript(what[++i] - '0');
      } else {
        out += what[i];
      }
    }
    return out;
  }

  void multiplier_box(double x, double y, const std::string& name) {
    sheet_.box(x, y, 68, 58, "multiplier", 4);
    sheet_.text(x + 34, y + 34, "\u00d7", "times middle");
    sheet_.text(x + 34, y + 52, name, "name middle");
    sheet_.text(x + 13, y + 14, "X", "value middle");
    sheet_.text(x + 41, y + 14, "Y", "value middle");
    sheet_.text(x + 58, y + 33, "W", "value middle");
  }

  /// X and Y by labels above, Z from `z` (a point to wire to, or ground), W to a label.
  void multiplier(const Multiplier& m, const std::pair<double, double>* z) {
    const double x = x_ + 26, y = z != nullptr ? z->second - 44 : y_ + 42;
    multiplier_box(x, y, m.name);
    sheet_.text(x + 10, y + 48, "Z", "value middle");
    for (const auto& [pin, node, up] : {std::tuple{14.0, m.x, 34.0}, std::tuple{42.0, m.y, 16.0}}) {
      sheet_.line({{x + pin, y}, {x + pin, y - up + 4}});
      sheet_.net(x + pin, y - up, node);
    }
    if (z != nullptr) {
      sheet_.line({*z, {x, y + 44}});
    } else {
      sheet_.line({{x, y + 44}, {x - 12, y + 44}});
      sheet_.ground(x - 12, y + 44, false);
    }
    sheet_.line({{x + 68, y + 29}, {x + 84, y + 29}});
    sheet_.net(x + 88, y + 33, m.out, "start");
    x_ = x + 140;
  }

  /// A sum from x_ on; the point where its output ends.
  std::pair<double, double> sum(const Sum& one) {
    const double top = y_ + 22, minus = top + 84, plus = minus + 40;
    double first_minus = 0.0, first_plus = 0.0, x = x_ + 16;
    const auto column = [&](const std::string& node, const Part& part, bool to_plus) {
      if (node == "0") {
        sheet_.ground(x, top, true);
      } else {
        sheet_.line({{x, top}, {x, top - 8}});
        sheet_.net(x, top - 12, node == "vr" ? "\u22121 V" : node);
      }
      sheet_.resistor_down(x, top, part);
      const double end = to_plus ? plus : minus;
      sheet_.line({{x, top + 40}, {x, end}});
      double& first = to_plus ? first_plus : first_minus;
      if (first == 0.0) {
        first = x;
      } else {
        sheet_.dot(x, end);
      }
      x += kColumn;
    };
    for (const bool to_plus : {true, false}) {
      for (const Sum::Term& term : one.terms) {
        if (term.at_plus == to_plus) column(term.node, layout_.part(term.part), to_plus);
      }
      if (one.balance >= 0 && (layout_.part(one.balance).from == layout_.op(one.opamp).plus) == to_plus)
        column("0", layout_.part(one.balance), to_plus);
    }
    x += 34;
    const double knot = x - 22, above = minus - 42;
    const auto tip = sheet_.opamp(x, minus, plus, layout_.op(one.opamp).name);
    sheet_.line({{first_minus > 0.0 ? first_minus : knot, minus}, {x, minus}});
    if (first_plus > 0.0) {
      sheet_.line({{first_plus, plus}, {x, plus}});
    } else {
      sheet_.line({{x, plus}, {x - 14, plus}});
      sheet_.ground(x - 14, plus, false);
    }
    if (first_minus > 0.0) sheet_.dot(knot, minus);
    sheet_.line({{knot, minus}, {knot, above}, {knot + 28, above}});
    sheet_.resistor_right(knot + 28, above, layout_.part(one.feedback));
    const double out = tip.first + 20;
    sheet_.line({{knot + 72, above}, {out, above}, {out, tip.second}});
    sheet_.line({tip, {out + 14, tip.second}});
    sheet_.dot(out, tip.second);
    x_ = out + 14;
    return {out + 14, tip.second};
  }

  static double sum_width(const Sum& one) {
    return kColumn * static_cast<double>(one.terms.size() + (one.balance >= 0 ? 1 : 0)) + 250;
  }

  void sum_with_label(const Sum& one) {
    room(sum_width(one), 190);
    const auto end = sum(one);
    sheet_.net(end.first + 4, end.second + 4, layout_.op(one.opamp).out, "start");
    x_ = end.first + 60;
  }

  void branch(size_t b) {
    const Branch& branch = layout_.branches[b];
    sheet_.text(
        kLeft, y_ + 2,
        fmt::format("{}: {} = \u2212{} d(x)", branch.name, branch.out, rounded_text(layout_.branch_gain)),
        "note");
    y_ += 22;
    x_ = kLeft;
    const auto sum_at = [&](const std::string& node) -> const Sum* {
      for (const int index : branch.sums) {
        if (layout_.op(layout_.sums[static_cast<size_t>(index)].opamp).out == node)
          return &layout_.sums[static_cast<size_t>(index)];
      }
      return nullptr;
    };
    sum_with_label(layout_.sums[static_cast<size_t>(branch.sums[0])]);
    for (const int index : branch.multipliers) {
      const Multiplier& m = layout_.multipliers[static_cast<size_t>(index)];
      if (const Sum* added = sum_at(m.z)) {
        room(sum_width(*added) + 160, 190);
        const auto end = sum(*added);
        multiplier(m, &end);
      } else {
        room(166, 190);
        multiplier(m, nullptr);
      }
    }
    if (layout_.amplitude) {
      room(166, 190);
      multiplier(layout_.product(layout_.amplitude->multipliers[b]), nullptr);
    }
    next_row();
  }

  void amplitude() {
    const AmplitudeControl& a = *layout_.amplitude;
    sheet_.text(kLeft, y_ + 2,
                fmt::format("amplitude gains: control voltages of {} V for a gain of 1; bends by precision "
                            "rectifiers (op-amp, two diodes)",
                            rounded_text(a.control_scale_v)),
                "note");
    y_ += 18;
    x_ = kLeft + 40;
    for (const AmplitudeControl::Rectifier& r : a.rectifiers) {
      room(250, 84);
      sheet_.box(x_, y_, 178, 66, "box", 6);
      sheet_.text(x_ + 10, y_ + 18,
                  fmt::format("{}: \u2212max(0, \u03b1 \u2212 {})", layout_.op(r.opamp).name,
                              rounded_text(r.realised)),
                  "name");
      const Part& in = layout_.part(r.input);
      const Part& reference = layout_.part(r.reference);
      sheet_.text(x_ + 10, y_ + 36,
                  fmt::format("{}, {}: {}", in.name, layout_.part(r.feedback).name, value_label(in)),
                  "value");
      sheet_.text(x_ + 10, y_ + 53,
                  fmt::format("{} from \u22121 V: {}", reference.name, value_label(reference)), "value");
      sheet_.line({{x_ - 10, y_ + 33}, {x_, y_ + 33}});
      sheet_.net(x_ - 14, y_ + 37, "\u03b1", "end");
      sheet_.line({{x_ + 178, y_ + 33}, {x_ + 190, y_ + 33}});
      sheet_.net(x_ + 194, y_ + 37, r.node, "start");
      x_ += 250;
    }
    next_row();
    y_ += 14;
    for (const AmplitudeControl::Control& one : a.controls) {
      if (one.negative) sum_with_label(*one.negative);
      sum_with_label(one.sum);
    }
    next_row();
  }

  /// Slope detector, branch switch and output amplifier.
  void output() {
    const auto source = layout_.switched() ? change_over() : std::pair{kLeft + 60.0, y_ + 60.0};
    const double y = source.second;
    if (!layout_.switched()) {
      sheet_.net(source.first - 6, y + 4,
                 layout_.amplitude ? layout_.product(layout_.amplitude->multipliers[0]).out
                                   : layout_.branches[0].out,
                 "end");
    }
    const double knot = source.first + 104, pin = knot + 22;
    sheet_.line({source, {source.first + 24, y}});
    sheet_.resistor_right(source.first + 24, y, layout_.part(layout_.output_input));
    sheet_.line({{source.first + 68, y}, {pin, y}});
    const auto tip = sheet_.opamp(pin, y, y + 40, fmt::format("U{}", layout_.sums.size() + 1));
    sheet_.line({{pin, y + 40}, {pin - 14, y + 40}});
    sheet_.ground(pin - 14, y + 40, false);
    sheet_.dot(knot, y);
    sheet_.line({{knot, y}, {knot, y - 42}, {knot + 28, y - 42}});
    sheet_.resistor_right(
        knot + 28, y - 42,
        layout_.part(layout_.amplitude ? layout_.amplitude->output_feedback : layout_.output_feedback));
    const double out = tip.first + 22;
    sheet_.line({{knot + 72, y - 42}, {out, y - 42}, {out, tip.second}});
    sheet_.dot(out, tip.second);
    sheet_.line({tip, {out + 40, tip.second}});
    sheet_.terminal(out + 44, tip.second);
    sheet_.text(out + 56, tip.second + 5, layout_.amplitude ? "out" : "out = d(x)", "net");
    if (layout_.amplitude) {
      const Part& without = layout_.part(layout_.output_feedback);
      sheet_.text(knot - 60, y + 78,
                  fmt::format("without the amplitude gains: {} {} and no gain multipliers", without.name,
                              value_label(without)),
                  "note");
    }
    right_ = std::max(right_, out + 130);
    y_ = std::max(y_ + row_, y + 90);
  }

  /// The switch between the branches and what drives it; the common contact.
  std::pair<double, double> change_over() {
    const SwitchModel& model = layout_.analog_switch;
    const double count = static_cast<double>(layout_.branches.size());
    const double step = 28, top = y_ + 30, height = step * (count - 1);
    const double left = kLeft + 60, width = 262;
    const double x = left + width + 240, common = top + 0.5 * height;
    for (size_t b = 0; b < layout_.branches.size(); ++b) {
      const double y = top + step * static_cast<double>(b);
      sheet_.net(x - 52, y + 4,
                 layout_.amplitude ? layout_.product(layout_.amplitude->multipliers[b]).out
                                   : layout_.branches[b].out,
                 "end");
      sheet_.line({{x - 46, y}, {x - 5, y}});
      sheet_.terminal(x, y);
    }
    sheet_.terminal(x + 56, common);
    sheet_.line({{x + 51, common}, {x + 7, top + 2}});
    // Below the output amplifier, which stands to the right.
    sheet_.text(
        x - 46, std::max(common + 98, top + height + 26),
        fmt::format("{}: {} \u2126, closes after {}, opens after {}", model.name, rounded_text(model.on_ohm),
                    engineering_text(model.on_delay_s, "s"), engineering_text(model.off_delay_s(), "s")),
        "value");
    sheet_.box(left, top - 16, width, 92, "box", 6);
    sheet_.text(left + 12, top + 5,
                fmt::format("slope detector, U{} and U{}", layout_.sums.size() + 2, layout_.sums.size() + 3),
                "name");
    const auto value = [&](const char* name) {
      const Part* part = layout_.part_named(name);
      return part == nullptr ? std::string() : fmt::format("{} {}", name, value_label(*part));
    };
    sheet_.text(left + 12, top + 25, fmt::format("differentiator: {}, {}", value("Cd"), value("Rd")),
                "value");
    sheet_.text(left + 12, top + 42, fmt::format("{}, {}, two diodes across Rd", value("Rs"), value("Cf")),
                "value");
    sheet_.text(left + 12, top + 59, fmt::format("comparator: {}, {}", value("Rh1"), value("Rh2")), "value");
    sheet_.line({{left - 18, top + 30}, {left, top + 30}});
    sheet_.net(left - 22, top + 34, "x", "end");
    // The control goes round the contacts' labels, to the lever from above.
    const double lever = x + 30, above = top - 26;
    sheet_.line({{left + width, top + 6},
                 {left + width + 60, top + 6},
                 {left + width + 60, above},
                 {lever, above},
                 {lever, top + 2 + (common - top) * (lever - x - 7) / 44.0}},
                "control");
    sheet_.text(left + width + 70, above - 6, "branch", "note");
    for (int line = 0; line < layout_.select_lines(); ++line) {
      const double at = above - 14.0 * (layout_.select_lines() - line);
      sheet_.text(lever + 8, at + 12, fmt::format("select{}", line + 1), "note");
    }
    row_ = std::max({row_, 150.0, height + 70});
    return {x + 61, common};
  }

  const Layout& layout_;
  Sheet sheet_;
  double x_ = kLeft, y_ = 0.0, row_ = 0.0, right_ = 0.0;
};

}  // namespace

std::string drawing_svg(const Layout& layout) {
  return Drawing(layout).draw();
}

}  // namespace bodesmith::multiplier_layout
