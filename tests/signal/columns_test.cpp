#include "signal/columns.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "signal/csv.hpp"

namespace bodesmith {
namespace {

TEST(ColumnWords, OtherNamesAndUnitsAreUnderstood) {
  const Csv csv = Csv::parse("frequency_kHz, Gain_dB\n1,0\n13.2,3 dB\n0.5 k,-1\n", "p.csv");
  EXPECT_EQ(csv.column("frequency_hz"), (std::vector<double>{1e3, 13200.0, 500e3}));
  EXPECT_EQ(csv.column("magnitude_db"), (std::vector<double>{0.0, 3.0, -1.0}));
  EXPECT_EQ(column_word("time_ms").name, "time_s");
  EXPECT_EQ(column_word("u").scale, 1.0);
  EXPECT_EQ(column_word("something_else").name, "something_else");
  // A column that the file has itself is the file's.
  const Csv both = Csv::parse("gain_db,magnitude_db\n1,2\n", "p.csv");
  EXPECT_EQ(both.column("gain_db")[0], 1.0);
  EXPECT_EQ(both.column("magnitude_db")[0], 2.0);
  EXPECT_THROW(Csv::parse("frequency_hz,gain\n1,one\n", "p.csv"), InputError);
}

}  // namespace
}  // namespace bodesmith
