#include "gap/search/stretches.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/whole_number.hpp"
#include "gap/made_model.hpp"
#include "gap/runner.hpp"

namespace {

using namespace bodesmith;

/// One full stroke, then small ones about the middle whose output grows: what memory the first one left is in all of them.
TimeRecord strokes() {
  TimeRecord r;
  r.file = "record.csv";
  r.step_s = 1e-3;
  for (int i = 0; i < 14000; ++i) {
    const double t = i * r.step_s;
    const double small = 0.1 + 0.02 * t;
    const double turn = 2.0 * std::numbers::pi * t;
    r.u.push_back(t < 0.2 ? std::sin(5.0 * turn) : small * std::sin(turn));
  }
  return r;
}

constexpr std::size_t kShortStretches = 3000;

struct Stretched {
  gap::Experiments train;
  gap::Experiments stretches;
  const gap::TimeExperiment& stretch() const { return std::get<gap::TimeExperiment>(stretches.front()); }
};

/// The record of a model, its output off by `gap` of itself, with the stretch that a search by this model looks at.
Stretched stretched(const gap::Model& model, double gap_share) {
  TimeRecord record = strokes();
  record.y.assign(record.u.size(), 0.0);
  record.y = gap::output_of(model, gap::TimeExperiment(record));
  for (double& y : record.y) y *= 1.0 + gap_share;
  Stretched out;
  out.train.emplace_back(gap::TimeExperiment(record));
  out.stretches = gap::stretches_of(out.train, model, kShortStretches);
  return out;
}

const char* const kPlays =
    "[[block]]\ntype = \"prandtl_ishlinskii\"\nr = [0.0, 0.1, 0.2, 0.4]\nw = [1.0, 0.1, 0.1, 0.2]\n";

TEST(Stretches, AreOfLongRecordsAlone) {
  TimeRecord record = strokes();
  record.y = record.u;
  record.u.resize(5000);
  record.y.resize(5000);
  const gap::Model model(model_of("[[block]]\ntype = \"gain\"\ngain = 2.0\n"));
  EXPECT_TRUE(gap::stretches_of({gap::TimeExperiment(record)}, model).empty());
}

TEST(Stretches, BeginShortlyBeforeWhatIsScoredWhereNothingIsRemembered) {
  const auto cut = stretched(gap::Model(model_of("[[block]]\ntype = \"gain\"\ngain = 2.0\n")), 0.1);
  ASSERT_EQ(cut.stretches.size(), 1U);
  EXPECT_GT(cut.stretch().record().start_s, 1.0);
  EXPECT_EQ(cut.stretch().first(), 0U);
}

TEST(Stretches, GoBackToWhatMemoryHolds) {
  const gap::Model model(model_of(kPlays));
  const auto cut = stretched(model, 0.001);
  ASSERT_EQ(cut.stretches.size(), 1U);
  // Behind the full stroke's turns, the first of which is at .05 s.
  EXPECT_LT(cut.stretch().record().start_s, 0.06);
  EXPECT_GT(cut.stretch().first(), 1000U);
  EXPECT_EQ(cut.stretch().scored(), kShortStretches);
  // What is left of the stretch is what is left of the whole record there.
  const auto& whole = std::get<gap::TimeExperiment>(cut.train.front());
  const auto output = gap::output_of(model, whole);
  const auto own = gap::output_of(model, cut.stretch());
  const auto begin = nearest_whole<std::size_t>(cut.stretch().record().start_s / whole.record().step_s);
  for (std::size_t i = cut.stretch().first(); i < cut.stretch().end(); i += 97)
    EXPECT_NEAR(own[i], output[begin + i], 1e-9) << i;
}

TEST(Stretches, GoBackToTheStartWhereALagIsSlow) {
  const auto cut =
      stretched(gap::Model(model_of("[[block]]\ntype = \"lowpass\"\ncorner_hz = 0.003\n")), 0.001);
  ASSERT_EQ(cut.stretches.size(), 1U);
  EXPECT_EQ(cut.stretch().record().start_s, 0.0);
}

TEST(Stretches, AreWhereMostIsLeft) {
  const gap::Model model(model_of("[[block]]\ntype = \"gain\"\ngain = 2.0\n"));
  TimeRecord record = strokes();
  for (std::size_t i = 0; i < record.u.size(); ++i) {
    const double t = record.time_s(i);
    record.y.push_back(2.0 * record.u[i] + (t > 3.0 && t < 5.0 ? 0.01 * std::sin(200.0 * t) : 0.0));
  }
  const gap::Experiments train{gap::TimeExperiment(record)};
  const gap::Experiments stretches = gap::stretches_of(train, model, kShortStretches);
  const auto& stretch = std::get<gap::TimeExperiment>(stretches.front());
  const double scored_from = stretch.record().start_s + static_cast<double>(stretch.first()) * record.step_s;
  EXPECT_LT(scored_from, 3.01);
  EXPECT_GT(scored_from + 3.0, 4.99);
  EXPECT_EQ(stretch.scored(), kShortStretches);
}

}  // namespace
