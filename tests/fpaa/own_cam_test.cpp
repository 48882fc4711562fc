// A CAM that the library does not know, defined here and registered, goes through everything that a plan goes
// through.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/json.hpp"
#include "base/json_header.hpp"
#include "fpaa/board_picture.hpp"
#include "fpaa/build_sheet.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/error_budget.hpp"
#include "fpaa/update_stream.hpp"
#include "fpaa/zrna_script.hpp"
#include "project_source.hpp"
#include "seed_sections.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;
using ::testing::HasSubstr;

/// 1 + s/(Q w0) + (s/w0)^2.
struct Quadratic {
  double natural = 1.0;
  double quality = 1.0;

  static Quadratic of(const std::vector<Complex>& roots) {
    const double natural = std::abs(roots[0]);
    return {natural, natural / (-2.0 * roots[0].real())};
  }
  Complex value(Complex s) const { return 1.0 + s / (quality * natural) + s * s / (natural * natural); }
  /// Of (2 - D)^2 times it, s = 2 fc D/(2 - D): coefficients of 1, D, D^2.
  std::array<double, 3> in_d(Hertz clock) const {
    const double a = clock.value / (quality * natural);
    const double b = clock.value * clock.value / (natural * natural);
    return {4.0, 4.0 * a - 4.0, 1.0 - 2.0 * a + 4.0 * b};
  }
};

/// H = -(N0 + N1 D + N2 D^2)/(M0 + M1 D + M2 D^2), D = 1 - 1/z.
class NotchTask : public CamTask {
 public:
  NotchTask(const Cam& cam, const SecondOrderPiece& piece)
      : CamTask(cam, piece.name, piece.section),
        above_(Quadratic::of(piece.zeros)),
        below_(Quadratic::of(piece.poles)) {}

  Resources resources() const override { return {.opamps = 2, .capacitors = 6}; }
  Complex response(RadPerSecond w) const override {
    return above_.value({0.0, w.value}) / below_.value({0.0, w.value});
  }
  std::vector<RadPerSecond> corners() const override { return {{above_.natural}, {below_.natural}}; }
  Band possible_clocks(int) const override { return {{5.0 * below_.natural}, {10.0 * below_.natural}}; }

  std::optional<PlacedCam> settle(const TaskSetting& setting) const override {
    const auto n = above_.in_d(setting.clock);
    const auto m = below_.in_d(setting.clock);
    const double scale = setting.max_capacitor / std::max(setting.gain * n[2], m[2]);
    PlacedCam out = start(setting, "Notch");
    out.requested = {{"notch_hz", RadPerSecond{above_.natural}.hz().value}, {"gain", setting.gain}};
    for (std::size_t i = 0; i < 3; ++i) {
      out.capacitors.push_back({fmt::format("N{}", i), units(setting.gain * n[i] * scale)});
    }
    for (std::size_t i = 0; i < 3; ++i)
      out.capacitors.push_back({fmt::format("M{}", i), units(m[i] * scale)});
    out.z = cam().transfer(out, CapacitorUnits(out.capacitors)).in_z();
    if (!out.z.is_stable()) return std::nullopt;
    out.realised = {{"notch_hz", RadPerSecond{above_.natural}.hz().value}, {"gain", -out.z.dc_gain()}};
    return out;
  }

 private:
  static int units(double wanted) { return std::max(1, static_cast<int>(std::lround(wanted))); }

  Quadratic above_, below_;
};

class FilterNotch : public Cam {
 public:
  FilterNotch() : Cam(facts_of_notch()) {}

  CamOffer offer_second_order(const SecondOrderPiece& piece) const override {
    const auto is_pair = [](const auto& roots) { return roots.size() == 2 && roots[0].imag() != 0.0; };
    if (!is_pair(piece.zeros) || !is_pair(piece.poles)) return {};
    return {.task = std::make_shared<NotchTask>(*this, piece),
            .log_gain = 2.0 * std::log(std::abs(piece.zeros[0]) / std::abs(piece.poles[0]))};
  }
  std::string assumption() const override { return "FilterNotch is made up."; }
  std::string note(const PlacedCam&) const override { return "FilterNotch cancels hum."; }
  DeltaTransfer transfer(const PlacedCam&, const CapacitorUnits& c) const override {
    return {{-c["N0"], -c["N1"], -c["N2"]}, {c["M0"], c["M1"], c["M2"]}};
  }
  std::vector<NoiseCharge> noise_charges(const PlacedCam& cam) const override {
    const CapacitorUnits c(cam.capacitors);
    return {{c["N0"] + c["M0"], {{1.0}, cam.z.denominator}}};
  }
  std::vector<Capacitor> vendor_capacitors(const PlacedCam& cam,
                                           std::span<const std::string>) const override {
    std::vector<Capacitor> out = cam.capacitors;
    std::swap(out.front(), out.back());
    return out;
  }
  std::optional<ZrnaModule> zrna_module(const PlacedCam&) const override {
    return ZrnaModule{"FilterNotch", "depth=3", {{"notch_hz", "notch_frequency"}, {"gain", "gain"}}};
  }
  std::string picture_text(const PlacedCam& cam) const override {
    return fmt::format("notch {:.1f} Hz", cam.realised.required_number("notch_hz"));
  }

 private:
  static CamFacts facts_of_notch() {
    CamFacts f;
    f.name = "FilterNotch";
    f.options = {"Notch"};
    f.parameters = {{"notch_hz", "Notch Frequency", true}, {"gain", "Gain"}};
    f.transfer = "-(N0 + N1 D + N2 D^2)/(M0 + M1 D + M2 D^2)";
    f.transfer_ground = Ground::assumed;
    return f;
  }
};

const Cam& filter_notch() {
  static const FilterNotch cam;
  if (cam_registry().find(cam.name()) == nullptr) cam_registry().add(cam);
  return cam;
}

/// A pair of complex zeros over a pair of complex poles, which no CAM of the library makes, and a real pair.
Sections notch_sections() {
  const auto pair = [](double natural, double quality) -> std::vector<Complex> {
    const double re = -natural / (2.0 * quality);
    const double im = std::sqrt(natural * natural - re * re);
    return {{re, im}, {re, -im}};
  };
  Sections out;
  out.sections = {{1.0, pair(400.0, 1.5), pair(377.0, 0.9)}, Section::pole_zero(1.0, {90.0}, {130.0})};
  return out;
}

class OwnCam : public ::testing::Test {
 protected:
  void SetUp() override {
    filter_notch();
    PlanOptions options;
    options.topology = PlanOptions::Topology::chain;  // asks every CAM of the library
    plan_ = plan_of(notch_sections(), options);
    cam_ = plan_.cams()[0];
  }
  Plan plan_;
  const PlacedCam* cam_ = nullptr;
};

TEST_F(OwnCam, IsUsedInThePlan) {
  ASSERT_EQ(cam_->cam, &filter_notch());
  EXPECT_EQ(plan_.cams()[1]->cam_name(), "FilterBilinear");
  EXPECT_LT(plan_.error.max_complex_percent, 10.0);
  EXPECT_THAT(plan_.assumptions, ::testing::Contains("FilterNotch is made up."));
  EXPECT_THAT(plan_.notes, ::testing::Contains("FilterNotch cancels hum."));
  ASSERT_GE(plan_.wires.size(), 3u);
  EXPECT_EQ(plan_.wires[0].from, "chip1.in1");
  EXPECT_EQ(plan_.wires[0].to, "chip1.Section1");
}

TEST_F(OwnCam, IsWrittenAndReadBack) {
  Json json = json_header("fpaa_plan", {});
  json.update(plan_.to_json());
  const Plan back = Plan::from_node(parse_json(to_text(json), "plan.json"));
  EXPECT_EQ(back.cams()[0]->cam, &filter_notch());
  EXPECT_EQ(to_text(back.to_json()), to_text(plan_.to_json()));
}

TEST_F(OwnCam, HasItsShareOfTheErrorBudget) {
  const ErrorBudget budget = error_budget(plan_, notch_sections(), {});
  EXPECT_EQ(budget.cams[0].name, "Section1");
  EXPECT_GT(budget.cams[0].noise_kt_per_cu, 0.0);
  EXPECT_GT(budget.mismatch.median_percent, 0.01);
  EXPECT_LT(budget.mismatch.max_percent, 10.0);
}

TEST_F(OwnCam, IsSetByUpdatesAndCalls) {
  const ApiProject project = parse_api_code(project_source(plan_), "ApiCode.c");
  const ConfigStream stream = update_stream(plan_.chips[0], project, {});
  EXPECT_THAT(compare_with_plan(stream, plan_.chips[0], project, {}), ::testing::IsEmpty());
  // The CAM's own order: its last capacitor first.
  EXPECT_THAT(c_calls(plan_, project, {}, "plan.json"),
              HasSubstr(fmt::format("an_SetCapValue(an_FPAA1_Section1, 5, {}); /* M2 */\n   "
                                    "an_SetCapValue(an_FPAA1_Section1, 1,",
                                    cam_->capacitors[5].units)));
}

TEST_F(OwnCam, IsPlacedByZrna) {
  const std::string script = zrna_script(plan_);
  EXPECT_THAT(script, HasSubstr("place(\"Section1\", z.FilterNotch(depth=3), z.CLOCK0, {\n"
                                "    \"notch_frequency\": 0.06"));
}

TEST_F(OwnCam, IsInThePictureAndTheBuildSheets) {
  const std::string svg = board_picture_svg(plan_);
  EXPECT_THAT(svg, HasSubstr(">FilterNotch, Notch<"));
  EXPECT_THAT(svg, HasSubstr(">notch 63.7 Hz<"));
  const std::string sheet = build_sheet_markdown(plan_);
  EXPECT_THAT(sheet, HasSubstr("insert CAM `FilterNotch`, filter type \"Notch\""));
  EXPECT_THAT(sheet, HasSubstr("| Notch Frequency | 0.063662 kHz |"));
  EXPECT_THAT(build_sheet_html(plan_), HasSubstr("FilterNotch"));
}

}  // namespace
}  // namespace bodesmith::fpaa
