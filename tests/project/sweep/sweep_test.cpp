// A sweep over a small filter: its rows are runs of the project, what an earlier sweep finished is kept, a slip ends it at once.
#include "project/sweep/sweep.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/files.hpp"
#include "lti/sections.hpp"
#include "signal/csv.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::project {
namespace {

using Status = SweptVariant::Status;

/// A shelf that two poles reach and one pole does not, which is a limit.
class Shelf {
 public:
  Shelf() {
    write_file(folder_ / "points.csv",
               "frequency_hz,magnitude_db\n10,0\n100,0.5\n300,2.5\n1000,5.5\n3000,6.5\n10000,7\n");
    write_file(
        folder_ / "p.toml",
        "schema = \"bodesmith.project/1\"\nname = \"shelf\"\n[target]\npoints = \"points.csv\"\n[fit]\norder = 2\n"
        "[limits]\npoints_db = 0.1\n");
  }
  Sweep swept(const std::string& variants, bool resume = false) const {
    write_file(folder_ / "v.toml", "schema = \"bodesmith.variants/1\"\n" + variants);
    SweepOptions options;
    options.resume = resume;
    return run_sweep(folder_ / "p.toml", folder_ / "v.toml", folder_ / "out", options, Team());
  }
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
};

constexpr const char* kTwo =
    "[[variant]]\nname = \"one\"\nset.fit.order = 1\n[[variant]]\nname = \"two\"\nset.fit.order = 2\nset.name = \"x, y\"\n";

double figure_of(const SweptVariant& variant, const std::string& name) {
  for (const auto& [key, value] : variant.figures) {
    if (key == name) return value;
  }
  return -1.0;
}

TEST(Sweep, RowsAreRunsOfTheProject) {
  const Shelf shelf;
  const Sweep sweep = shelf.swept(kTwo);
  EXPECT_EQ(sweep.project, "shelf");
  EXPECT_EQ(sweep.keys, (std::vector<std::string>{"fit.order", "name"}));
  ASSERT_EQ(sweep.variants.size(), 2U);
  EXPECT_EQ(sweep.variants[0].status, Status::limit_missed);
  EXPECT_EQ(sweep.variants[1].status, Status::done);
  EXPECT_FALSE(sweep.limits_met());
  EXPECT_EQ(sweep.variants[0].values, (std::vector<std::string>{"1", ""}));
  EXPECT_EQ(sweep.variants[1].values, (std::vector<std::string>{"2", "x, y"}));
  for (const SweptVariant& one : sweep.variants) {
    Provenance from;
    const Sections sections = Sections::read(shelf / ("out/" + one.name + "/sections.json"), from);
    EXPECT_EQ(figure_of(one, "poles"), sections.pole_count()) << one.name;
    EXPECT_FALSE(one.kept);
  }
  EXPECT_EQ(read_file(shelf / "out/sweep.csv"), sweep_csv(sweep));
}

TEST(Sweep, WhatIsFinishedIsKeptAsLongAsItIsOfTheSame) {
  const Shelf shelf;
  const Sweep first = shelf.swept(kTwo);
  const auto kept = [&](const Sweep& sweep) {
    std::string out;
    for (const SweptVariant& one : sweep.variants) out += one.kept ? 'k' : 'n';
    return out;
  };
  EXPECT_EQ(kept(shelf.swept(kTwo)), "nn") << "only where it is asked";
  const Sweep again = shelf.swept(kTwo, true);
  EXPECT_EQ(kept(again), "kk");
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again.variants[i].figures, first.variants[i].figures);
    EXPECT_EQ(again.variants[i].status, first.variants[i].status);
  }
  const std::string more = kTwo + std::string("[[variant]]\nname = \"three\"\nset.fit.order = 1\n");
  EXPECT_EQ(kept(shelf.swept(more, true)), "kkn") << "a table that grew costs what is missing";
  EXPECT_EQ(kept(shelf.swept("[[variant]]\nname = \"one\"\nset.fit.order = 2\n", true)), "n")
      << "of other changes";
  EXPECT_EQ(kept(shelf.swept(kTwo, true)), "nk");
  write_file(shelf / "out/two/variant.json", "{");
  EXPECT_EQ(kept(shelf.swept(kTwo, true)), "kn") << "damaged";
  write_file(shelf / "points.csv",
             "frequency_hz,magnitude_db\n10,0\n100,0.5\n300,2.5\n1000,5.5\n3000,6.5\n10000,7.1\n");
  EXPECT_EQ(kept(shelf.swept(kTwo, true)), "nn") << "of other points";
}

TEST(Sweep, ASlipInAnyVariantEndsItBeforeTheFirst) {
  const Shelf shelf;
  EXPECT_THROW(
      shelf.swept(
          "[[variant]]\nname = \"one\"\nset.fit.order = 1\n[[variant]]\nname = \"bad\"\nset.fit.ordr = 2\n"),
      InputError);
  EXPECT_FALSE(std::filesystem::exists(shelf / "out/one/run.json"));
}

}  // namespace
}  // namespace bodesmith::project
