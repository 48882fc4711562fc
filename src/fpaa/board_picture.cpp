#include "fpaa/board_picture.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>

#include "base/json.hpp"
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
constexpr double kCamHeight = 58;
constexpr double kRound = 9;

struct Point {
  double x = 0.0;
  double y = 0.0;
};
struct Box {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  Point left() const { return {x, y + height / 2}; }
  Point right() const { return {x + width, y + height / 2}; }
  Point bottom() const { return {x + width / 2, y + height}; }
  Point top() const { return {x + width / 2, y}; }
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

/// From the right edge of one CAM to the left edge of another, through the gutters between CABs.
std::vector<Point> route(const Box& from, int from_cab, const Box& to, int to_cab, int chip) {
  if (from_cab == to_cab) return {from.bottom(), to.top()};
  const Point a = from.right();
  const Point b = to.left();
  if (a.x < b.x) {
    const double middle = (a.x + b.x) / 2;
    return {a, {middle, a.y}, {middle, b.y}, b};
  }
  const Box first = cab_box(chip, 1);
  const double channel = first.y + kCabHeight + kCabRowGap / 2;
  const double out = a.x + 20;
  const double in = b.x - 20;
  return {a, {out, a.y}, {out, channel}, {in, channel}, {in, b.y}, b};
}

std::string clock_text(double hertz) {
  if (hertz >= 1e6) return rounded_text(hertz / 1e6, 5) + " MHz";
  if (hertz >= 1e3) return rounded_text(hertz / 1e3, 5) + " kHz";
  return rounded_text(hertz, 5) + " Hz";
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
  explicit BoardPicture(const Plan& plan) : plan_(plan), board_(board_by_name(plan.board)) {}

  Json data() {
    data_["board"] = plan_.board;
    data_["chips"] = Json::array();
    data_["wires"] = Json::array();
    data_["links"] = Json::array();
    for (int number = 1; number <= board_.chips; ++number) data_["chips"].push_back(chip_item(number));
    add_frame();
    return std::move(data_);
  }

 private:
  /// Where a CAM is drawn.
  struct DrawnCam {
    Box box;
    int cab = 1;
  };
  using DrawnCams = std::map<std::string, DrawnCam>;

  const ChipPlan* chip_of(int number) const {
    for (const ChipPlan& chip : plan_.chips) {
      if (chip.chip == number) return &chip;
    }
    return nullptr;
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
    item["clock_x"] = o.x + 16;
    item["clock_y"] = o.y + 50;
    const DrawnCams drawn = add_cabs(number, chip, item);
    item["resources"] = chip != nullptr && !chip->cams.empty() ? resources_text(*chip) : "";
    item["pins"] = Json::array();
    if (chip != nullptr && !chip->cams.empty()) add_wires(*chip, drawn, item);
    item["resources_x"] = o.x + kPad;
    item["resources_y"] = o.y + kChipHeight - 16;
    return item;
  }

  std::string clocks_text(const ChipPlan& chip) const {
    std::string out =
        fmt::format("ACLK {}   Sys1 /{}", clock_text(chip.master_clock.value), chip.clocks.sys1_divisor);
    for (std::size_t k = 0; k < chip.clocks.clocks.size(); ++k) {
      out += fmt::format("   Clock {} /{} = {}", k, chip.clocks.clocks[k].divisor,
                         clock_text(chip.clocks.frequency(board_, k).value));
    }
    return out;
  }

  std::string resources_text(const ChipPlan& chip) const {
    const Resources sum = chip.resources();
    return fmt::format("{} of {} op-amps, {} of {} capacitors", sum.opamps,
                       board_.cabs_per_chip * board_.per_cab.opamps, sum.capacitors,
                       board_.cabs_per_chip * board_.per_cab.capacitors);
  }

  /// The CABs of a chip and the CAMs in them.
  DrawnCams add_cabs(int number, const ChipPlan* chip, Json& item) const {
    DrawnCams drawn;
    item["cabs"] = Json::array();
    item["cams"] = Json::array();
    for (int cab = 1; cab <= board_.cabs_per_chip; ++cab) {
      const Box box = cab_box(number, cab);
      Resources sum;
      double y = box.y + 34;
      const std::vector<PlacedCam> none;
      for (const PlacedCam& cam : chip != nullptr ? chip->cams : none) {
        if (cam.cab != cab) continue;
        sum += cam.resources;
        const Box cam_box{box.x + 12, y, box.width - 24, kCamHeight};
        y += kCamHeight + 14;
        drawn[cam.name] = {cam_box, cab};
        item["cams"].push_back(cam_item(cam, cam_box));
      }
      item["cabs"].push_back(cab_item(cab, box, sum));
    }
    return drawn;
  }

  static Json cam_item(const PlacedCam& cam, const Box& box) {
    std::string kind(cam.cam_name());
    if (!cam.option.empty()) kind += ", " + cam.option;
    return {{"x", box.x},
            {"y", box.y},
            {"width", box.width},
            {"height", box.height},
            {"text_x", box.x + 12},
            {"name_y", box.y + 20},
            {"kind_y", box.y + 36},
            {"what_y", box.y + 51},
            {"name", cam.name},
            {"kind", kind},
            {"what", cam.cam->picture_text(cam)},
            {"gain", cam.cam->is_gain()}};
  }

  Json cab_item(int cab, const Box& box, const Resources& used) const {
    const double right = box.x + box.width - 14 - 9 * 8;
    Json pip_list = pips(right, box.y + 17, used.capacitors, board_.per_cab.capacitors, "capacitor");
    for (auto& pip : pips(right - 26, box.y + 17, used.opamps, board_.per_cab.opamps, "opamp")) {
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

  /// From the input pin through the CAMs to the output pin, and the link from the chip before.
  void add_wires(const ChipPlan& chip, const DrawnCams& drawn, Json& item) {
    const Point o = chip_origin(chip.chip);
    const DrawnCam& first = drawn.at(chip.cams.front().name);
    const DrawnCam& last = drawn.at(chip.cams.back().name);
    const Point in{o.x, first.box.left().y};
    const Point out{o.x + kChipWidth, o.y + kChipHeight - 40};
    item["pins"] = {
        {{"x", in.x}, {"y", in.y}, {"label", "in1"}, {"label_x", in.x + 9}, {"label_y", in.y - 8}},
        {{"x", out.x}, {"y", out.y}, {"label", "out1"}, {"label_x", out.x - 38}, {"label_y", out.y + 19}}};
    add_wire({in, first.box.left()});
    for (std::size_t c = 0; c + 1 < chip.cams.size(); ++c) {
      const DrawnCam& a = drawn.at(chip.cams[c].name);
      const DrawnCam& b = drawn.at(chip.cams[c + 1].name);
      add_wire(route(a.box, a.cab, b.box, b.cab, chip.chip));
    }
    // Down the nearest gutter to the strip below the CABs, then out.
    const double gutter = last.box.right().x + 24;
    add_wire({last.box.right(), {gutter, last.box.right().y}, {gutter, out.y}, out});
    if (last_out_) add_link(*last_out_, in, o);
    last_out_ = out;
  }

  void add_wire(const std::vector<Point>& points) { data_["wires"].push_back({{"d", path_text(points)}}); }

  /// From the output pin of one chip to the input pin of the next, whose origin is `o`.
  void add_link(Point from, Point in, Point o) {
    std::vector<Point> points;
    if (from.x < in.x) {
      const double middle = (from.x + in.x) / 2;
      points = {from, {middle, from.y}, {middle, in.y}, in};
    } else {
      const double between = o.y - kChipGap / 2;
      points = {from, {from.x + 14, from.y}, {from.x + 14, between}, {o.x - 14, between}, {o.x - 14, in.y},
                in};
    }
    data_["links"].push_back({{"d", path_text(points)}});
  }

  void add_frame() {
    const int rows = (board_.chips + 1) / 2;
    const double width = 2 * kMargin + 2 * kChipWidth + kChipGap;
    data_["width"] = width;
    data_["height"] = kHeader + rows * kChipHeight + (rows - 1) * kChipGap + kMargin;
    data_["error"] = rounded_text(plan_.error.max_complex_percent, 3);
    data_["from"] = rounded_text(plan_.error.band.from.value, 3);
    data_["to"] = rounded_text(plan_.error.band.to.value, 4);
    data_["margin"] = kMargin;
    data_["legend_x"] = width - kMargin - 210;
    data_["legend_text_1"] = width - kMargin - 198;
    data_["legend_x2"] = width - kMargin - 110;
    data_["legend_text_2"] = width - kMargin - 98;
  }

  const Plan& plan_;
  const Board& board_;
  Json data_;
  std::optional<Point> last_out_;  ///< output pin of the chip before
};

}  // namespace

std::string board_picture_svg(const Plan& plan) {
  return render_template("fpaa/board.svg", BoardPicture(plan).data());
}

}  // namespace bodesmith::fpaa
