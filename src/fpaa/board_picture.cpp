#include "fpaa/board_picture.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"

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
  for (size_t i = 1; i + 1 < points.size(); ++i) {
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

std::string summary_of(const PlacedCam& cam) {
  const auto hz = [&](const char* key) { return rounded_text(cam.realised[key].get<double>(), 4); };
  if (cam.realised.contains("pole_hz"))
    return fmt::format("zero {} Hz  pole {} Hz", hz("zero_hz"), hz("pole_hz"));
  if (cam.realised.contains("corner_hz")) return fmt::format("corner {} Hz", hz("corner_hz"));
  if (cam.realised.contains("gain")) return fmt::format("gain {}", hz("gain"));
  return "";
}

}  // namespace

std::string board_picture_svg(const Plan& plan) {
  const Board& board = board_by_name(plan.board);
  Json data;
  data["board"] = plan.board;
  data["chips"] = Json::array();
  data["wires"] = Json::array();
  data["links"] = Json::array();
  std::map<int, const ChipPlan*> used;
  for (const ChipPlan& chip : plan.chips) used[chip.chip] = &chip;
  Point last_out;
  bool have_out = false;
  for (int number = 1; number <= board.chips; ++number) {
    const Point o = chip_origin(number);
    Json item;
    item["x"] = o.x;
    item["y"] = o.y;
    item["width"] = kChipWidth;
    item["height"] = kChipHeight;
    item["title"] = fmt::format("Chip {}", number);
    item["title_x"] = o.x + 16;
    item["title_y"] = o.y + 28;
    item["used"] = used.count(number) > 0;
    item["clock_text"] = "not used";
    item["clock_x"] = o.x + 16;
    item["clock_y"] = o.y + 50;
    item["cabs"] = Json::array();
    item["cams"] = Json::array();
    const ChipPlan* chip = used.count(number) > 0 ? used[number] : nullptr;
    std::map<int, std::vector<const PlacedCam*>> in_cab;
    if (chip != nullptr) {
      std::string clocks =
          fmt::format("ACLK {}   Sys1 /{}", clock_text(chip->master_clock.value), chip->clocks.sys1_divisor);
      for (size_t k = 0; k < chip->clocks.clocks.size(); ++k) {
        clocks += fmt::format("   Clock {} /{} = {}", k, chip->clocks.clocks[k].divisor,
                              clock_text(chip->clocks.frequency(board, k).value));
      }
      item["clock_text"] = clocks;
      for (const PlacedCam& cam : chip->cams) in_cab[cam.cab].push_back(&cam);
    }
    std::map<std::string, std::pair<Box, int>> boxes;
    for (int cab = 1; cab <= board.cabs_per_chip; ++cab) {
      const Box box = cab_box(number, cab);
      Resources sum;
      double y = box.y + 34;
      for (const PlacedCam* cam : in_cab[cab]) {
        sum += cam->resources;
        const Box cam_box{box.x + 12, y, box.width - 24, kCamHeight};
        y += kCamHeight + 14;
        boxes[cam->name] = {cam_box, cab};
        item["cams"].push_back({{"x", cam_box.x},
                                {"y", cam_box.y},
                                {"width", cam_box.width},
                                {"height", cam_box.height},
                                {"text_x", cam_box.x + 12},
                                {"name_y", cam_box.y + 20},
                                {"kind_y", cam_box.y + 36},
                                {"what_y", cam_box.y + 51},
                                {"name", cam->name},
                                {"kind", cam->option.empty() ? cam->cam : cam->cam + ", " + cam->option},
                                {"what", summary_of(*cam)},
                                {"gain", cam->cam == "GainInv"}});
      }
      Json pip_list = pips(box.x + box.width - 14 - 9 * 8, box.y + 17, sum.capacitors,
                           board.per_cab.capacitors, "capacitor");
      for (auto& pip :
           pips(box.x + box.width - 14 - 9 * 8 - 26, box.y + 17, sum.opamps, board.per_cab.opamps, "opamp")) {
        pip_list.push_back(pip);
      }
      item["cabs"].push_back({{"x", box.x},
                              {"y", box.y},
                              {"width", box.width},
                              {"height", box.height},
                              {"title", fmt::format("CAB {}", cab)},
                              {"title_x", box.x + 12},
                              {"title_y", box.y + 21},
                              {"pips", pip_list}});
    }
    if (chip != nullptr && !chip->cams.empty()) {
      const auto& [first, first_cab] = boxes[chip->cams.front().name];
      const auto& [last, last_cab] = boxes[chip->cams.back().name];
      const Point in{o.x, first.left().y};
      const Point out{o.x + kChipWidth, o.y + kChipHeight - 40};
      item["pins"] = {
          {{"x", in.x}, {"y", in.y}, {"label", "in1"}, {"label_x", in.x + 9}, {"label_y", in.y - 8}},
          {{"x", out.x}, {"y", out.y}, {"label", "out1"}, {"label_x", out.x - 38}, {"label_y", out.y + 19}}};
      data["wires"].push_back({{"d", path_text({in, first.left()})}});
      for (size_t c = 0; c + 1 < chip->cams.size(); ++c) {
        const auto& [a, a_cab] = boxes[chip->cams[c].name];
        const auto& [b, b_cab] = boxes[chip->cams[c + 1].name];
        data["wires"].push_back({{"d", path_text(route(a, a_cab, b, b_cab, number))}});
      }
      // Down the nearest gutter to the strip below the CABs, then out.
      const double gutter = last.right().x + 24;
      data["wires"].push_back(
          {{"d", path_text({last.right(), {gutter, last.right().y}, {gutter, out.y}, out})}});
      if (have_out) {
        const double middle = last_out.x < in.x ? (last_out.x + in.x) / 2 : last_out.x + kChipGap / 2;
        if (last_out.x < in.x) {
          data["links"].push_back({{"d", path_text({last_out, {middle, last_out.y}, {middle, in.y}, in})}});
        } else {
          const double between = o.y - kChipGap / 2;
          data["links"].push_back({{"d", path_text({last_out,
                                                    {last_out.x + 14, last_out.y},
                                                    {last_out.x + 14, between},
                                                    {o.x - 14, between},
                                                    {o.x - 14, in.y},
                                                    in})}});
        }
      }
      last_out = out;
      have_out = true;
      const Resources sum = chip->resources();
      item["resources"] = fmt::format("{} of {} op-amps, {} of {} capacitors", sum.opamps,
                                      board.cabs_per_chip * board.per_cab.opamps, sum.capacitors,
                                      board.cabs_per_chip * board.per_cab.capacitors);
    } else {
      item["resources"] = "";
      item["pins"] = Json::array();
    }
    item["resources_x"] = o.x + kPad;
    item["resources_y"] = o.y + kChipHeight - 16;
    data["chips"].push_back(item);
  }
  const int rows = (board.chips + 1) / 2;
  data["width"] = 2 * kMargin + 2 * kChipWidth + kChipGap;
  data["height"] = kHeader + rows * kChipHeight + (rows - 1) * kChipGap + kMargin;
  data["error"] = rounded_text(plan.error.max_complex_percent, 3);
  data["from"] = rounded_text(plan.error.band.from.value, 3);
  data["to"] = rounded_text(plan.error.band.to.value, 4);
  data["margin"] = kMargin;
  data["legend_x"] = 2 * kMargin + 2 * kChipWidth + kChipGap - kMargin - 210;
  data["legend_text_1"] = 2 * kMargin + 2 * kChipWidth + kChipGap - kMargin - 198;
  data["legend_x2"] = 2 * kMargin + 2 * kChipWidth + kChipGap - kMargin - 110;
  data["legend_text_2"] = 2 * kMargin + 2 * kChipWidth + kChipGap - kMargin - 98;
  return render_template("fpaa/board.svg", data);
}

}  // namespace bodesmith::fpaa
