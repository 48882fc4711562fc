#include "gap/study.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "gap/made_response.hpp"

namespace study_of {
namespace {

using namespace bodesmith;

// Responses are told apart by what they hold, not by the order in which they are named.
TEST(Study, ResponsesStandInTheOrderOfWhatTheyHold) {
  const auto response = [](double corner) {
    return made::measured([corner](double hz) { return made::lag(hz, corner); }, 1.0, 100.0, 30,
                          [](double) { return 0.0; }, 1);
  };
  const auto base = model_of("[[block]]\ntype = \"gain\"\ngain = 1.0\noffset = 0.0\nfree = [\"gain\"]\n");
  const auto first_of = [&](std::vector<FrequencyRecord> train) {
    const gap::Study study = gap::Study::of(std::move(train), {response(7.0)}, base);
    std::vector<double> out;
    for (const auto& one : study.train())
      out.push_back(std::get<gap::FrequencyExperiment>(one).record().response[5].real());
    return out;
  };
  const std::vector<double> one = first_of({response(30.0), response(3.0), response(10.0)});
  EXPECT_EQ(first_of({response(10.0), response(30.0), response(3.0)}), one);
  EXPECT_TRUE(std::is_sorted(one.begin(), one.end()));
}

}  // namespace
}  // namespace study_of
