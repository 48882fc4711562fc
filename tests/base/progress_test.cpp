// Who hears of progress, and of Ctrl-C.
#include "base/progress.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "base/error.hpp"

namespace bodesmith {
namespace {

TEST(Progress, AListenerHearsTheOutermostOnly) {
  std::vector<double> heard;
  {
    const ProgressListener listener([&](double fraction) { heard.push_back(fraction); });
    Progress outer("all of it");
    outer.at(0.25);
    {
      Progress inner("a part");
      inner.at(0.9);
    }
    outer.at(0.5);
  }
  Progress unheard("afterwards");
  unheard.at(0.75);
  EXPECT_EQ(heard, (std::vector<double>{0.25, 0.5}));
}

TEST(Progress, AProgramMayAskToStopAndGoOn) {
  EXPECT_FALSE(interrupted()) << "nobody asked";
  ask_to_stop();
  EXPECT_TRUE(interrupted());
  EXPECT_THROW(stop_if_interrupted(), Interrupted);
  forget_interruption();
  EXPECT_NO_THROW(stop_if_interrupted());
}

TEST(InputError, KnowsFileAndLine) {
  const InputError in_file("points.csv", 7, "is wrong");
  EXPECT_STREQ(in_file.what(), "points.csv:7: is wrong");
  EXPECT_EQ(in_file.file(), "points.csv");
  EXPECT_EQ(in_file.line(), 7);
  EXPECT_EQ(InputError("no place").file(), "");
}

}  // namespace
}  // namespace bodesmith
