// What a stage lacks whose branches are made of powers: errors of the multipliers, or a plain curve.
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "gap/cases/signals.hpp"
#include "gap/cases/stages.hpp"
#include "gap/cases/time_base.hpp"
#include "gap/diagnosis.hpp"
#include "gap/made_model.hpp"

namespace {

using namespace bodesmith;

constexpr std::size_t kPowerRows = 1500;
constexpr double kPowerStepS = 1e-3;
constexpr std::array<double, 3> kPowersUp = {-0.2, 0.4, -0.2};
constexpr std::array<double, 3> kPowersDown = {0.25, -0.4, 0.15};

TimeRecord powers_record(const hidden::Stage& stage, hidden::Drive drive, unsigned seed, double middle) {
  hidden::Random random(seed);
  TimeRecord r;
  r.file = "record.csv";
  r.step_s = kPowerStepS;
  r.u = hidden::make_drive(drive, kPowerRows, kPowerStepS, 12.0, random);
  for (std::size_t i = 0; i < kPowerRows; ++i)
    r.u[i] = middle > 0.0 ? (middle + 0.5 * r.u[i]) * std::min(1.0, static_cast<double>(i) / 100.0) : r.u[i];
  r.y = hidden::play_chain({stage}, r.u, kPowerStepS);
  const auto noise = hidden::make_noise(hidden::Colour::white, kPowerRows, random);
  for (std::size_t i = 0; i < kPowerRows; ++i) r.y[i] += 5e-4 * noise[i];
  return r;
}

std::vector<std::string> names_for_powers(const std::string& model, const hidden::Stage& stage,
                                          double middle) {
  const auto base = model_of(model);
  const auto study = gap::Study::of({powers_record(stage, hidden::Drive::triangle, 1, middle)},
                                    {powers_record(stage, hidden::Drive::modulated_sine, 2, middle)}, base);
  std::vector<std::string> all;
  for (const auto& s : gap::diagnose(base, study, {}).steps) all.push_back(s.effect);
  return all;
}

std::vector<std::string> names_in_stage(const hidden::Stage& stage) {
  return names_for_powers(
      "[[block]]\ntype = \"polynomial_hysteresis\"\nascending = [-0.2, 0.4, -0.2]\ndescending = [0.25, -0.4, 0.15]\n"
      "[[block]]\ntype = \"gain\"\ngain = 0.97\noffset = 0.0\nfree = [\"gain\"]\n",
      stage, 0.5);
}

using PowersNames = std::vector<std::string>;

TEST(MultiplierError, OfAllPowersIsNamed) {
  EXPECT_EQ(names_in_stage(hidden::branches_by_multipliers(kPowersUp, kPowersDown, 1.0, 0.03, 0.0)),
            PowersNames{"multiplier_error"});
  EXPECT_EQ(names_in_stage(hidden::branches_by_multipliers(kPowersUp, kPowersDown, 1.0, 0.0, 0.02)),
            PowersNames{"multiplier_error"});
  EXPECT_EQ(names_in_stage(hidden::branches_by_multipliers(kPowersUp, kPowersDown, 1.05, 0.03, 0.02)),
            PowersNames{"multiplier_error"});
}

TEST(MultiplierError, OfTheSquareAloneIsNamed) {
  const hidden::Stage stage = [](const hidden::Fine& u, double) {
    hidden::Fine y(u);
    bool rising = true;
    for (std::size_t i = 0; i < u.size(); ++i) {
      if (i > 0 && u[i] != u[i - 1]) rising = u[i] > u[i - 1];
      const auto& a = rising ? kPowersUp : kPowersDown;
      const double square = 0.94 * u[i] * u[i] + 0.03 * u[i] - 0.01;
      y[i] = u[i] + a[0] * u[i] + (a[1] + a[2] * u[i]) * square;
    }
    return y;
  };
  EXPECT_EQ(names_in_stage(stage), PowersNames{"multiplier_error"});
}

TEST(AsymmetricHysteresis, IsNoNameForACurve) {
  const auto curve = hidden::curve([](double x) { return x + 0.08 * x * x - 0.05 * x * x * x; });
  const auto found = names_for_powers(
      "[[block]]\ntype = \"gain\"\ngain = 0.97\noffset = 0.0\nfree = [\"gain\"]\n", curve, 0.0);
  EXPECT_EQ(found.size(), 2U);
  for (const auto& name : found) EXPECT_TRUE(name.ends_with("_nonlinearity")) << name;
}

}  // namespace
