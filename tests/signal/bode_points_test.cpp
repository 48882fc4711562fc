#include "signal/bode_points.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/files.hpp"
#include "temporary_folder.hpp"

namespace {

using namespace bodesmith;

std::filesystem::path written(const TemporaryFolder& folder, const std::string& text) {
  const auto path = folder / "response.csv";
  write_file(path, text);
  return path;
}

TEST(FrequencyRecord, HasAveragesAndDriveWhereTheyAreGiven) {
  const TemporaryFolder folder;
  Provenance from;
  const auto plain = FrequencyRecord::read_csv(
      written(folder, "frequency_hz,magnitude_db,phase_deg\n1,0,0\n2,-3,-45\n"), from);
  EXPECT_TRUE(plain.averages.empty());
  EXPECT_TRUE(plain.drive_v.empty());
  const auto full = FrequencyRecord::read_csv(
      written(
          folder,
          "frequency_hz,magnitude_db,phase_deg,coherence,averages,drive_v\n1,0,0,1,16,0.1\n2,-3,-45,0.9,16,0.1\n"
          "3,-3,-45,0.8,16,0.1\n"),
      from);
  EXPECT_EQ(full.averages, (std::vector<double>(3, 16.0)));
  EXPECT_EQ(full.drive_v, (std::vector<double>(3, 0.1)));
  const auto half = full.thinned(0, 2);
  ASSERT_EQ(half.frequency.size(), 2U);
  EXPECT_EQ(half.coherence, (std::vector<double>{1.0, 0.8}));
  EXPECT_EQ(half.drive_v.size(), 2U);
}

TEST(FrequencyRecord, RefusesADriveOfNothing) {
  const TemporaryFolder folder;
  Provenance from;
  const auto path = written(folder, "frequency_hz,magnitude_db,phase_deg,drive_v\n1,0,0,0.1\n2,-3,-45,0\n");
  try {
    FrequencyRecord::read_csv(path, from);
    FAIL() << "was read";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(":3: drive_v is 0"), std::string::npos) << error.what();
  }
}

}  // namespace
