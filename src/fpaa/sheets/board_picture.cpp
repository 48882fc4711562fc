#include "fpaa/sheets/board_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

// All in SVG units; a chip is a fixed frame with four CABs, two a row, gutters between for the wires.
constexpr double kMargin = 28;
constexpr double kHeader = 64;
constexpr double kChipWidth = 560;
constexpr double kChipHeight = 520;
constexpr double kChipGap = 56;
constexpr double kChipTop = 74;  // clocks above the CABs
constexpr double kPad = 46;      // left and right of the CABs: pins and wires
constexpr double kCabGap = 48;
constexpr double kCabWidth = (kChipWidth - 2 * kPad - kCabGap) / 2;
constexpr double kCabHeight = 182;
constexpr double kCabRowGap = 34;
constexpr double kCabTitle = 34;
constexpr double kCamHeight = 58;
constexpr double kCamGap = 14;
constexpr double kPinGap = 24;
constexpr double kInputGap = 9;
constexpr double kRound = 9;

struct Point {
  double x = 0.0;
  double y = 0.0;
};
struct Box {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  Point left() const { return {x, y + height / 2}; }
  Point right() const { return {x + width, y + height / 2}; }
};

/// A polyline with rounded corners.
std::string path_text(const std::vector<Point>& points) {
  std::string d = fmt::format("M{:.1f} {:.1f}", points[0].x, points[0].y);
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Point& a = points[i - 1];
    const Point& b = points[i];
    const Point& c = points[i + 1];
    const double in = std::hypot(b.x - a.x, b.y - a.y);
    const double out = std::hypot(c.x - b.x, c.y - b.y);
    const double r = std::min({kRound, in / 2, out / 2});
    if (r < 0.5) continue;
    d += fmt::format(" L{:.1f} {:.1f} Q{:.1f} {:.1f} {:.1f} {:.1f}", b.x - (b.x - a.x) / in * r,
                     b.y - (b.y - a.y) / in * r, b.x, b.y, b.x + (c.x - b.x) / out * r,
                     b.y + (c.y - b.y) / out * r);
  }
  return d + fmt::format(" L{:.1f} {:.1f}", points.back().x, points.back().y);
}

Point chip_origin(int chip) {
  const int column = (chip - 1) % 2;
  const int row = (chip - 1) / 2;
  return {kMargin + column * (kChipWidth + kChipGap), kHeader + row * (kChipHeight + kChipGap)};
}

Box cab_box(int chip, int cab) {
  const Point o = chip_origin(chip);
  return {o.x + kPad + ((cab - 1) % 2) * (kCabWidth + kCabGap),
          o.y + kChipTop + ((cab - 1) / 2) * (kCabHeight + kCabRowGap), kCabWidth, kCabHeight};
}

/// From a point at the right of a CAM (or an input pin) to one at the left of another, through the gutters between
/// CABs; `shift` keeps wires that share a gutter apart.
std::vector<Point> route(Point from, Point to, int chip, double shift) {
  const Box left_cab = cab_box(chip, 1);
  if (from.x < left_cab.x && to.x > left_cab.x + left_cab.width) {
    // From a pin past the left CABs: above them, not across what is written in them.
    const double above = left_cab.y - 12 + shift;
    const double in = from.x + 14 + shift;
    const double gutter = to.x - 16 + shift;
    return {from, {in, from.y}, {in, above}, {gutter, above}, {gutter, to.y}, to};
  }
  if (from.x < to.x) {
    const double gutter = to.x - 16 + shift;
    if (std::abs(from.y - to.y) < 0.5) return {from, to};
    return {from, {std::max(from.x + 4, gutter), from.y}, {std::max(from.x + 4, gutter), to.y}, to};
  }
  const Box first = cab_box(chip, 1);
  const double channel = first.y + kCabHeight + kCabRowGap / 2 + shift;
  const double out = from.x + 18 + shift;
  const double in = to.x - 16 + shift;
  return {from, {out, from.y}, {out, channel}, {in, channel}, {in, to.y}, to};
}

/// Attributes that press a text into `width` where it would be wider in a font of `pixels`.
std::string fitted(const std::string& text, double width, double pixels) {
  constexpr double kWidthOfACharacter = 0.58;  // of the font's size
  if (kWidthOfACharacter * pixels * static_cast<double>(text.size()) <= width) return {};
  return fmt::format(" textLength=\"{:.0f}\" lengthAdjust=\"spacingAndGlyphs\"", width);
}

Json pips(double x, double y, int used, int all, const char* kind) {
  Json out = Json::array();
  for (int i = 0; i < all; ++i) {
    out.push_back({{"x", x + 9.0 * i}, {"y", y}, {"used", i < used}, {"kind", kind}});
  }
  return out;
}

/// The picture's data for the template, chip after chip.
class BoardPicture {
 public:
  BoardPicture(const Plan& plan, const PinLabels& labels)
      : plan_(plan), labels_(labels), board_(board_by_name(plan.board)) {}

  Json data() {
    data_["board"] = plan_.board;
    data_["chips"] = Json::array();
    data_["wires"] = Json::array();
    data_["links"] = Json::array();
    for (int number = 1; number <= board_.chips; ++number) data_["chips"].push_back(chip_item(number));
    add_wires();
    add_frame();
    return std::move(data_);
  }

 private:
  /// Where a wire starts or ends.
  struct DrawnEnd {
    Point out;  ///< it leaves here
    Point in;   ///< the first of its inputs
    int inputs = 1;
    int chip = 1;
    bool cam = true;
  };

  const ChipPlan* chip_of(int number) const {
    const auto at = std::ranges::find(plan_.chips, number, &ChipPlan::chip);
    return at == plan_.chips.end() ? nullptr : &*at;
  }

  Json chip_item(int number) {
    const Point o = chip_origin(number);
    const ChipPlan* chip = chip_of(number);
    Json item;
    item["x"] = o.x;
    item["y"] = o.y;
    item["width"] = kChipWidth;
    item["height"] = kChipHeight;
    item["title"] = fmt::format("Chip {}", number);
    item["title_x"] = o.x + 16;
    item["title_y"] = o.y + 28;
    item["used"] = chip != nullptr;
    item["clock_text"] = chip != nullptr ? clocks_text(*chip) : "not used";
    item["clock_fit"] = fitted(item["clock_text"].get<std::string>(), kChipWidth - 32, 12.0);
    item["clock_x"] = o.x + 16;
    item["clock_y"] = o.y + 50;
    add_cabs(number, chip, item);
    item["resources"] = chip != nullptr && !chip->cams.empty() ? resources_text(*chip) : "";
    item["pins"] = Json::array();
    if (chip != nullptr) add_pins(number, item);
    item["resources_x"] = o.x + kPad;
    item["resources_y"] = o.y + kChipHeight - 16;
    return item;
  }

  std::string clocks_text(const ChipPlan& chip) const {
    std::string out = fmt::format("ACLK {} · Sys1 /{}", engineering_text(chip.master_clock.value, "Hz", 5),
                                  chip.clocks.sys1_divisor);
    for (std::size_t k = 0; k < chip.clocks.clocks.size(); ++k) {
      out += fmt::format(" · Clock {} /{} = {}", k, chip.clocks.clocks[k].divisor,
                         engineering_text(chip.clocks.frequency(chip.master_clock, k).value, "Hz", 5));
    }
    return out;
  }

  std::string resources_text(const ChipPlan& chip) const {
    const Resources sum = chip.resources();
    return fmt::format("{} of {} op-amps, {} of {} capacitors", sum.opamps, kCabs * kOpAmps, sum.capacitors,
                       kCabs * kCapacitors);
  }

  /// The CABs of a chip and the CAMs in them.
  void add_cabs(int number, const ChipPlan* chip, Json& item) {
    item["cabs"] = Json::array();
    item["cams"] = Json::array();
    for (int cab = 1; cab <= kCabs; ++cab) {
      const Box box = cab_box(number, cab);
      const std::vector<PlacedCam> none;
      const std::vector<PlacedCam>& cams = chip != nullptr ? chip->cams : none;
      const auto here = static_cast<double>(
          std::ranges::count_if(cams, [&](const PlacedCam& cam) { return cam.cab == cab; }));
      const double step = std::min(kCamHeight + kCamGap, (kCabHeight - kCabTitle) / std::max(1.0, here));
      Resources sum;
      double y = box.y + kCabTitle;
      for (const PlacedCam& cam : cams) {
        if (cam.cab != cab) continue;
        sum += cam.resources;
        const Box cam_box{box.x + 12, y, box.width - 24, step - kCamGap * step / (kCamHeight + kCamGap)};
        y += step;
        const std::string name = fmt::format("chip{}.{}", number, cam.name);
        ends_[name] = {cam_box.right(), cam_box.left(), inputs_of(name), number, true};
        item["cams"].push_back(cam_item(cam, cam_box));
      }
      item["cabs"].push_back(cab_item(cab, box, sum));
    }
  }

  /// The highest number of an input that a wire leads to.
  int inputs_of(const std::string& name) const {
    int out = 1;
    for (const Wire& wire : plan_.wires) {
      if (wire.to == name) out = std::max(out, wire.input);
    }
    return out;
  }

  static Json cam_item(const PlacedCam& cam, const Box& box) {
    std::string kind(cam.cam_name());
    if (!cam.option.empty()) kind += ", " + cam.option;
    const std::string what = cam.cam->picture_text(cam);
    const double room = box.width - 24;
    return {{"x", box.x},
            {"y", box.y},
            {"width", box.width},
            {"height", box.height},
            {"name_fit", fitted(cam.name, room, 14.0)},
            {"kind_fit", fitted(kind, room, 11.5)},
            {"what_fit", fitted(what, room, 11.5)},
            {"text_x", box.x + 12},
            {"name_y", box.y + 0.345 * box.height},
            {"kind_y", box.y + 0.62 * box.height},
            {"what_y", box.y + 0.88 * box.height},
            {"name", cam.name},
            {"kind", kind},
            {"what", what},
            {"gain", cam.cam->is_gain()}};
  }

  Json cab_item(int cab, const Box& box, const Resources& used) const {
    const double right = box.x + box.width - 14 - 9 * 8;
    Json pip_list = pips(right, box.y + 17, used.capacitors, kCapacitors, "capacitor");
    for (auto& pip : pips(right - 26, box.y + 17, used.opamps, kOpAmps, "opamp")) {
      pip_list.push_back(pip);
    }
    return {{"x", box.x},
            {"y", box.y},
            {"width", box.width},
            {"height", box.height},
            {"title", fmt::format("CAB {}", cab)},
            {"title_x", box.x + 12},
            {"title_y", box.y + 21},
            {"pips", pip_list}};
  }

  /// The chip's pins that wires use: inputs down its left edge, outputs along its right one, at the bottom.
  void add_pins(int chip, Json& item) {
    const Point o = chip_origin(chip);
    std::set<std::string> names;
    for (const Wire& wire : plan_.wires) {
      for (const std::string& end : {wire.from, wire.to}) {
        if (end.rfind(fmt::format("chip{}.", chip), 0) == 0 && ends_.count(end) == 0) names.insert(end);
      }
    }
    double in_y = o.y + kChipTop + 22;
    double out_y = o.y + kChipHeight - 24;
    for (const std::string& name : names) {
      const bool in = WireEnd(name).is_input_pin();
      const Point at{in ? o.x : o.x + kChipWidth, in ? in_y : out_y};
      (in ? in_y : out_y) += in ? kPinGap : -kPinGap;
      ends_[name] = {at, at, 1, chip, false};
      const std::string pin = name.substr(name.find('.') + 1);
      const auto label = labels_.find(name);
      const std::string text = label == labels_.end() ? pin : label->second;
      const double width = 6.4 * static_cast<double>(text.size());
      item["pins"].push_back({{"x", at.x},
                              {"y", at.y},
                              {"label", text},
                              {"label_x", in ? at.x + 9 : at.x - 9 - width},
                              {"label_y", at.y + 17}});  // wires that go up start at the pin's right
    }
  }

  /// Every wire of the plan: within a chip, and from chip to chip.
  void add_wires() {
    int number = 0;
    for (const Wire& wire : plan_.wires) {
      const auto from = ends_.find(wire.from);
      const auto to = ends_.find(wire.to);
      if (from == ends_.end() || to == ends_.end()) continue;
      const DrawnEnd& a = from->second;
      const DrawnEnd& b = to->second;
      const double shift = 3.5 * (number++ % 5 - 2);
      Point end = b.in;
      end.y += kInputGap * (wire.input - 0.5 * (b.inputs + 1));
      if (a.chip != b.chip) {
        add_link(a.out, b.in, chip_origin(b.chip), shift);
      } else if (!b.cam) {
        // Down the nearest gutter to the strip below the CABs, then out.
        const double gutter = a.out.x + 24 + shift;
        add_wire({a.out, {gutter, a.out.y}, {gutter, end.y}, end});
      } else {
        add_wire(route(a.out, end, a.chip, shift));
      }
    }
  }

  void add_wire(const std::vector<Point>& points) { data_["wires"].push_back({{"d", path_text(points)}}); }

  /// From the output pin of one chip to the input pin of another, whose origin is `o`.
  void add_link(Point from, Point in, Point o, double shift) {
    std::vector<Point> points;
    if (from.x < in.x) {
      const double middle = (from.x + in.x) / 2 + shift;
      points = {from, {middle, from.y}, {middle, in.y}, in};
    } else {
      const double between = o.y - kChipGap / 2 + shift;
      const double out = from.x + 14 + shift;
      points = {from, {out, from.y}, {out, between}, {o.x - 14 + shift, between}, {o.x - 14 + shift, in.y},
                in};
    }
    data_["links"].push_back({{"d", path_text(points)}});
  }

  void add_frame() {
    const int rows = (board_.chips + 1) / 2;
    const double width = 2 * kMargin + 2 * kChipWidth + kChipGap;
    data_["width"] = width;
    data_["height"] = kHeader + rows * kChipHeight + (rows - 1) * kChipGap + kMargin;
    const PlanError& error = plan_.error_with_delays;
    data_["has_error"] = error.band.to > error.band.from;
    data_["error"] = rounded_text(error.max_complex_percent, 3);
    data_["from"] = engineering_text(error.band.from.value, "Hz");
    data_["to"] = engineering_text(error.band.to.value, "Hz", 4);
    data_["margin"] = kMargin;
    data_["legend_x"] = width - kMargin - 238;
    data_["legend_text_1"] = width - kMargin - 228;
    data_["legend_x2"] = width - kMargin - 122;
    data_["legend_text_2"] = width - kMargin - 112;
  }

  const Plan& plan_;
  const PinLabels& labels_;
  const Board& board_;
  Json data_;
  std::map<std::string, DrawnEnd> ends_;
};

}  // namespace

std::string board_picture_svg(const Plan& plan, const PinLabels& labels) {
  return render_template("fpaa/board.svg", BoardPicture(plan, labels).data());
}

}  // namespace bodesmith::fpaa
