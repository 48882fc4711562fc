// Files of every kind as models: the response of what they describe.
#include "project/output/as_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "lti/sections.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::project {
namespace {

using testing::HasSubstr;

chain::Chain model_of(const std::string& text, ModelRequest request = {}) {
  const TemporaryFolder folder;
  write_file(folder / "it.json", text);
  Provenance from;
  return as_model(folder / "it.json", request, from);
}

Section section(double gain, std::vector<Complex> zeros, std::vector<Complex> poles) {
  return {gain, std::move(zeros), std::move(poles)};
}

chain::Chain model_of(const fpaa::Plan& plan, ModelRequest& request) {
  Json json = plan.to_json();
  json["schema"] = "bodesmith.fpaa_plan/1";
  const TemporaryFolder folder;
  write_file(folder / "it.json", to_text(json));
  Provenance from;
  return as_model(folder / "it.json", request, from);
}

/// Stages follow their inputs within a phase: by its samples alone this board is 8 degrees from what it does.
TEST(AsModel, ABoardsChainIsTheBoardAsItsSwitchesMakeIt) {
  Sections sections;
  sections.sections = {section(1.0, {-300.0}, {-500.0}),
                       section(2e6, {}, {{-400.0, 1300.0}, {-400.0, -1300.0}}),
                       section(700.0, {0.0}, {{-700.0, 600.0}, {-700.0, -600.0}})};
  fpaa::PlanOptions options;
  options.topology = fpaa::PlanOptions::Topology::chain;
  const fpaa::Plan plan = value_or_throw(fpaa::make_plan(sections, options));
  ModelRequest request;
  const chain::Chain model = model_of(plan, request);
  ASSERT_EQ(request.boards.size(), 1u);
  const double stated = 0.01 * request.boards[0].worst_percent;
  EXPECT_LT(stated, 0.01 * plan.error_with_delays.max_complex_percent);
  const fpaa::SwitchedBoard board(plan);
  for (const double f : {20.0, 40.0, 200.0, 390.0}) {
    const RadPerSecond w = Hertz{f}.rad_s();
    if (Hertz{f} < plan.error_with_delays.band.from || plan.error_with_delays.band.to < Hertz{f}) continue;
    EXPECT_LE(std::abs(*model.response(w) / board.gain(w) - 1.0), stated) << f;
  }
  // One section has a zero at rest, and every CAM its own name.
  EXPECT_EQ(*model.response({0.0}), 0.0);
  for (const fpaa::PlacedCam* cam : plan.cams()) {
    EXPECT_TRUE(std::ranges::any_of(model.blocks, [&](const chain::Block& block) {
      return block.part.starts_with(cam->name);
    })) << cam->name;
  }
}

/// What a Hold shows is half a cycle old and more: no section is that, so the model has a delay.
TEST(AsModel, ABoardsHoldIsADelay) {
  Sections sections;
  sections.sections = {section(1000.0, {}, {-1000.0})};
  fpaa::PlanOptions options;
  options.topology = fpaa::PlanOptions::Topology::chain;
  fpaa::Plan plan = value_or_throw(fpaa::make_plan(sections, options));
  ModelRequest request;
  const auto has_delay = [](const chain::Chain& model) {
    return std::ranges::any_of(model.blocks,
                               [](const chain::Block& block) { return block.type_name() == "delay"; });
  };
  EXPECT_FALSE(has_delay(model_of(plan, request)));
  fpaa::PlacedCam hold;
  hold.name = "Late";
  hold.cam = fpaa::cam_registry().find("Hold");
  hold.cab = 4;
  hold.clock_a = plan.cams().front()->clock_a;
  hold.delay_cycles = 0.5;
  hold.resources = *hold.cam->facts().resources;
  hold.find_z();
  plan.chips.front().cams.push_back(hold);
  for (fpaa::Wire& wire : plan.wires) {
    if (wire.to == plan.output_pin()) wire.to = "chip1.Late";
  }
  plan.wires.push_back({"chip1.Late", "chip1.out1", 1});
  const chain::Chain late = model_of(plan, request);
  EXPECT_TRUE(has_delay(late));
  const RadPerSecond w = plan.error_with_delays.band.to.rad_s();
  EXPECT_LE(std::abs(*late.response(w) / fpaa::SwitchedBoard(plan).gain(w) - 1.0),
            0.01 * request.boards.back().worst_percent);
  EXPECT_LT(request.boards.back().worst_percent, 0.5);
}

TEST(AsModel, AnIdentifiedStageIsScaledAtBothEndsAndLagsWhereItDoes) {
  const auto stage = [](const std::string& kind, double seconds) {
    return R"({"schema": "bodesmith.disturbance/1", "ascending": [0.3, -0.3, 0], "descending": [-0.2, 0.2, 0],
      "amplitude": {"alpha": [0.5, 1], "ascending": [0.4, 1], "descending": [0.6, 1]},
      "identified": {"input": {"low": 2, "high": 10}, "output": {"stroke": 30, "offset": -4},
                     "lag": {"kind": ")" +
           kind + R"(", "lag_s": )" + std::to_string(seconds) + "}}}";
  };
  const chain::Chain none = model_of(stage("delay", 0.0));
  ASSERT_EQ(none.blocks.size(), 3u);
  const auto line = [](const chain::Block& block, double u) {
    const auto curve = block.affine();
    return curve->factor * u + curve->constant;
  };
  EXPECT_NEAR(line(none.blocks[0], 2.0), 0.0, 1e-15);
  EXPECT_NEAR(line(none.blocks[0], 10.0), 1.0, 1e-15);
  EXPECT_NEAR(line(none.blocks[2], 0.0), -4.0, 1e-15);
  EXPECT_NEAR(line(none.blocks[2], 1.0), 26.0, 1e-15);
  const chain::Chain late = model_of(stage("delay", 2e-3));
  EXPECT_EQ(late.blocks.back().get("delay_s"), 2e-3);
  const chain::Chain behind = model_of(stage("pole behind the stage", 2e-3));
  EXPECT_EQ(behind.blocks.back().part, "sensor");
  EXPECT_NEAR(behind.blocks.back().get("corner_hz"), 79.57747154594767, 1e-9);
  EXPECT_EQ(model_of(stage("pole in front of the stage", 2e-3)).blocks.at(1).part, "amplifier");
  // Under a load that leaves half the stroke the same drive moves half as far, and d is that of half the stroke.
  ModelRequest loaded;
  loaded.load_stroke = 0.5;
  const chain::Chain half = model_of(stage("delay", 0.0), loaded);
  EXPECT_NEAR(line(half.blocks[2], 1.0), 11.0, 1e-15);
  EXPECT_NEAR(half.blocks[1].list("ascending")[0], 0.3 * 0.4 / 0.5, 1e-12);
}

TEST(AsModel, SectionsAndCascadesAreTheirResponse) {
  const chain::Chain sections = model_of(R"({"schema": "bodesmith.sections/1", "sections": [
    {"gain": 2, "zeros_rad_s": [[-50, 0]], "poles_rad_s": [[-200, 0]]}]})");
  const chain::Chain cascade = model_of(R"({"schema": "bodesmith.cascade/1", "gain": 1.5,
    "terms": [{"lambda_s": 0.02, "x": 0.25, "beta": 0.5}]})");
  for (const double w : {1.0, 90.0, 3000.0}) {
    const Complex s(0.0, w);
    EXPECT_LT(std::abs(*sections.response({w}) / (2.0 * (s + 50.0) / (s + 200.0)) - 1.0), 1e-12);
    const Complex wanted = 1.5 * std::sqrt((0.02 * s + 1.0) / (0.005 * s + 1.0));
    EXPECT_LT(std::abs(*cascade.response({w}) / wanted - 1.0), 1e-12);
  }
  EXPECT_THROW(model_of(R"({"schema": "bodesmith.yield/1"})"), InputError);
}

}  // namespace
}  // namespace bodesmith::project
