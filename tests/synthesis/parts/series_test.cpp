#include "synthesis/parts/series.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace bodesmith::synthesis {
namespace {

TEST(Series, TablesOfIec60063) {
  EXPECT_EQ(Series::named("E12").values(1.0, 9.99),
            (std::vector<double>{1.0, 1.2, 1.5, 1.8, 2.2, 2.7, 3.3, 3.9, 4.7, 5.6, 6.8, 8.2}));
  EXPECT_EQ(Series::named("E6").values(100, 1000), (std::vector<double>{100, 150, 220, 330, 470, 680, 1000}));
  for (const auto& [name, count] :
       {std::pair{"E3", 3}, {"E6", 6}, {"E12", 12}, {"E24", 24}, {"E48", 48}, {"E96", 96}, {"E192", 192}}) {
    EXPECT_EQ(Series::named(name).values(1e3, 9.999e3).size(), static_cast<size_t>(count)) << name;
  }
  const auto e192 = Series::named("E192").values(9.0, 9.5);
  EXPECT_EQ(e192, (std::vector<double>{9.09, 9.2, 9.31, 9.42}));  // the standard has 9.20, not 9.19
}

TEST(Series, NearestRoundsUpADecade) {
  EXPECT_EQ(Series::named("E96").nearest(9.95e3), 1e4);  // FOMCON's prefnumerize gives 9.76e3
  EXPECT_EQ(Series::named("E12").nearest(9.5e-9), 1e-8);
  EXPECT_EQ(Series::named("E96").nearest(1.0e6, 3), (std::vector<double>{1e6, 1.02e6, 9.76e5}));
  EXPECT_EQ(Series::named("exact").nearest(1234.5, 5), std::vector<double>{1234.5});
  EXPECT_EQ(Series::stock("drawer", {470.0, 100.0}).nearest(300.0), 470.0);
}

TEST(Series, NearestAboveIsTheFirstThatIsNotBelow) {
  for (const char* name : {"E3", "E12", "E96"}) {
    const Series series = Series::named(name);
    for (double wanted = 1e3; wanted < 2e4; wanted *= 1.037) {
      const double got = series.nearest_above(wanted);
      EXPECT_GE(got, wanted) << name;
      for (const double value : series.values(wanted, got)) EXPECT_EQ(value, got) << name << " " << wanted;
    }
  }
  EXPECT_EQ(Series::named("exact").nearest_above(1234.5), 1234.5);
}

TEST(Series, NamesWhatItExpects) {
  EXPECT_THROW(Series::named("E97"), InputError);
  EXPECT_THROW(Series::stock("drawer", {}), InputError);
  EXPECT_THROW(Series::stock("drawer", {0.0}), InputError);
}

}  // namespace
}  // namespace bodesmith::synthesis
