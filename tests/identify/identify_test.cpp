// A new hysteresis model is one object and one registration: it is then read from model.toml, identified,
// written, inverted and simulated by the program's ordinary functions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "chain/inverse.hpp"
#include "chain/model_file.hpp"
#include "hysteresis/identification/record_tools.hpp"
#include "hysteresis/model_type.hpp"
#include "identify/stage_fit.hpp"

namespace bodesmith::identify {
namespace {

using hysteresis::Inverse;
using hysteresis::ModelType;
using hysteresis::Operator;
using hysteresis::Parameters;

/// One play of half width r: known to nobody but this file.
struct Play {
  double r = 0.0;
  static Play from(const Parameters& values) {
    const double r = values.number("r");
    if (r > 100.0) throw DesignError("r is wider than any backlash");
    return {r};
  }
};

class PlayOperator final : public Operator {
 public:
  explicit PlayOperator(Play play) : play_(play) {}
  double reset(double u) override { return y_ = u; }
  double step(double u, double dt_s) override { return y_ = peek(u, dt_s); }
  double peek(double u, double) const override { return std::clamp(y_, u - play_.r, u + play_.r); }
  bool rate_independent() const override { return true; }

 private:
  Play play_;
  double y_ = 0.0;
};

/// Jumps over the dead width when the reference turns.
class PlayInverse final : public Inverse {
 public:
  explicit PlayInverse(Play play) : play_(play) {}
  double reset(double y) override {
    y_ = y;
    return y;
  }
  double step(double y, double) override {
    if (y != y_) side_ = y > y_ ? 1.0 : -1.0;
    y_ = y;
    return y + side_ * play_.r;
  }
  double achieved() const override { return y_; }

 private:
  Play play_;
  double y_ = 0.0;
  double side_ = 0.0;
};

class PlayType final : public hysteresis::ShapedModelType<Play> {
 public:
  PlayType()
      : ShapedModelType("play_in_identify_test", "one play", {not_negative("r", "u", "half the width")}) {}

 protected:
  std::unique_ptr<Operator> operator_of(const Play& play) const override {
    return std::make_unique<PlayOperator>(play);
  }
  std::unique_ptr<Inverse> inverse_of(const Play& play) const override {
    return std::make_unique<PlayInverse>(play);
  }
  /// The best of a grid.
  Identified fit(std::span<const TimeRecord> records, const IdentifyOptions& options) const override {
    const double width = hysteresis::swept_range(records).width();
    Identified out;
    double best = INFINITY;
    for (int i = 0; i <= 100; ++i) {
      const double r = 0.005 * width * i;
      Eigen::VectorXd residual;
      operator_residual(PlayOperator({r}), records, options.skip_s, residual);
      if (residual.squaredNorm() < best) {
        best = residual.squaredNorm();
        out.model = model(Parameters().set("r", r));
      }
    }
    out.method = "grid";
    return out;
  }
};

const ModelType& play_type() {
  static const PlayType type;
  static const bool registered = [] {
    hysteresis::model_type_registry().add(type);
    return true;
  }();
  (void)registered;
  return type;
}

TimeRecord played_record(double r) {
  TimeRecord out;
  out.file = "record";
  out.step_s = 1e-3;
  PlayOperator op({r});
  for (int i = 0; i < 1000; ++i) {
    out.u.push_back(1.0 - std::cos(0.02 * i));
    out.y.push_back(i == 0 ? op.reset(out.u[0]) : op.step(out.u.back(), out.step_s));
  }
  return out;
}

TEST(NewModel, IsIdentifiedWrittenReadAndInverted) {
  const ModelType& type = play_type();
  EXPECT_EQ(hysteresis::model_type_registry().find("play_in_identify_test"), &type);
  const TimeRecord record = played_record(0.25);
  const StageFit fit = fit_stage(&type, {&record, 1}, {}, {});
  EXPECT_EQ(fit.model, "play_in_identify_test");
  EXPECT_LT(fit.training.rms_percent, 0.5);
  EXPECT_NEAR(fit.stage.model.parameters.number("r"), 0.25, 0.006);

  const std::string text = chain::model_text(fit.stage.chain(), "found");
  const chain::Chain back = chain::model_from_node(parse_toml(text, "model.toml"));
  ASSERT_EQ(back.blocks.size(), 1u);
  EXPECT_EQ(back.blocks[0].hysteresis_model(), &type);
  EXPECT_EQ(chain::model_text(back, "found"), text);

  chain::WantedOutput wanted{0.0, 1e-3, {}};
  for (int i = 0; i < 500; ++i) wanted.values.push_back(std::sin(0.05 * i));
  const auto drive = back.blocks[0].inverse(wanted);
  ASSERT_TRUE(drive.has_value());
  EXPECT_TRUE(drive->out_of_reach.empty());
  EXPECT_LT(bodesmith::error_figures(fit.stage.simulate(drive->values, 1e-3), wanted.values).max, 1e-12);
}

TEST(NewModel, ItsOwnRefusalCarriesTheLine) {
  play_type();
  try {
    chain::model_from_node(
        parse_toml("schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"play_in_identify_test\"\nr = 101\n",
                   "model.toml"));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 13), "model.toml:4:") << error.what();
    EXPECT_NE(std::string(error.what()).find("wider than any backlash"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace bodesmith::identify
