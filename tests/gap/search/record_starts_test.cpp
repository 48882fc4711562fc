#include "gap/search/record_starts.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "gap/evidence/noise_floor.hpp"
#include "gap/made_model.hpp"

namespace {

using namespace bodesmith;

constexpr std::size_t kStart = 40;

/// A line, off by one to either side in turn, and by so many times that in its first samples; they are scored.
gap::TimeExperiment off_at_start(double times, std::size_t start = kStart) {
  TimeRecord r;
  r.file = "made.csv";
  r.step_s = 1e-3;
  for (std::size_t i = 0; i < 400; ++i) {
    r.u.push_back(0.01 * static_cast<double>(i));
    r.y.push_back(r.u.back() + (i % 2 == 0 ? 1.0 : -1.0) * (i < kStart ? times : 1.0));
  }
  gap::TimeExperiment out(r, start);
  out.score_start();
  return out;
}

bool is_left_out(const gap::Experiment& one) {
  return std::get<gap::TimeExperiment>(one).start_is_left_out();
}

TEST(RecordStarts, AreLeftOutOnceWhereTheyStandOut) {
  const gap::Model model(model_of("[[block]]\ntype = \"gain\"\ngain = 1.0\n"));
  const double limit = gap::kOverFloor;
  gap::SearchRecords records{
      {off_at_start(0.99 * limit), off_at_start(1.01 * limit), off_at_start(1.01 * limit, 0)}, {}};
  EXPECT_TRUE(gap::leave_out_wrong_starts(records, model));
  EXPECT_FALSE(is_left_out(records.train[0]));
  EXPECT_TRUE(is_left_out(records.train[1]));
  EXPECT_FALSE(is_left_out(records.train[2]));
  // What is left out already is no news.
  EXPECT_FALSE(gap::leave_out_wrong_starts(records, model));
  EXPECT_TRUE(is_left_out(records.train[1]));
}

TEST(RecordStarts, OfARecordThatIsAllStartIsKept) {
  const gap::Model model(model_of("[[block]]\ntype = \"gain\"\ngain = 1.0\n"));
  gap::SearchRecords records{{off_at_start(1.0, 400)}, {}};
  EXPECT_FALSE(gap::leave_out_wrong_starts(records, model));
}

TEST(RecordStarts, AreScoredAgainUnderAModelInWhichTheyDoNotStandOut) {
  const chain::Chain line = model_of("[[block]]\ntype = \"gain\"\ngain = 1.0\nfree = [\"gain\"]\n");
  gap::Model model(line);
  const gap::SearchOptions options;
  const gap::SearchSetting setting{options};
  gap::SearchRecords records{{off_at_start(1.0), off_at_start(2.0)}, {}};
  for (auto& one : records.train) std::get<gap::TimeExperiment>(one).leave_out_start();
  gap::score_starts_again(setting, records, model);
  EXPECT_FALSE(is_left_out(records.train[0]));
  EXPECT_TRUE(is_left_out(records.train[1]));
}

}  // namespace
