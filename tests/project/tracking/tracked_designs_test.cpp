#include "project/tracking/tracked_designs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace bodesmith::project {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using tracking::ConstantGain;
using tracking::GeneratorForm;

TrackedCandidate candidate(const char* name, double gain, GeneratorForm form) {
  return {name, true, 1, {name, ConstantGain{gain}, ConstantGain{gain}, "", form}};
}

// |d'| is .35 at most: three times that goes round the loop and grows; one pass has no loop.
TEST(TrackedDesigns, ALoopThatDoesNotSettleIsTakenOutAndSaid) {
  tracking::Plant plant;
  plant.disturbance.ascending = {0.3546, -0.6433, 0.2887};
  plant.disturbance.descending = {-0.2398, 0.0838, 0.156};
  tracking::Options options;
  options.frequencies = {Hertz{1.0}, Hertz{100.0}};
  std::vector<TrackedCandidate> all = {candidate("good", 1.0, GeneratorForm::self_fed()),
                                       candidate("wild", 6.0, GeneratorForm::self_fed()),
                                       candidate("open", 6.0, GeneratorForm::one_pass())};
  EXPECT_THAT(take_out_unsettled(plant, options, all),
              ElementsAre(HasSubstr("'wild': the generator fed by its own drive does not settle")));
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].key, "good");
  EXPECT_EQ(all[1].key, "open");
}

}  // namespace
}  // namespace bodesmith::project
