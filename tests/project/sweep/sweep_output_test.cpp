// A sweep's table: every variant's figures under their names, what is missing empty, and the best by what matters most.
#include <gtest/gtest.h>

#include "base/documents/json.hpp"
#include "project/sweep/sweep.hpp"
#include "signal/csv.hpp"

namespace bodesmith::project {
namespace {

using Status = SweptVariant::Status;

SweptVariant variant(const char* name, Status status, std::vector<std::string> values,
                     std::vector<std::pair<std::string, double>> figures) {
  SweptVariant out;
  out.name = name;
  out.what = std::string("what ") + name + " is";
  out.status = status;
  out.values = std::move(values);
  out.figures = std::move(figures);
  out.compute_s = 0.5;
  return out;
}

Sweep example() {
  Sweep out;
  out.project = "shelf";
  out.keys = {"fit.order", "hardware.circuit.resistors"};
  out.variants = {
      variant("a", Status::done, {"2", ""}, {{"target_db", 0.3}, {"yield_db", 1.2}}),
      variant("b", Status::limit_missed, {"3", "E24"}, {{"target_db", 0.1}, {"yield_db", 0.7}}),
      variant("c", Status::done, {"4", "E96"}, {{"target_db", 0.2}, {"poles", 4.0}, {"yield_db", 1.1}}),
      variant("d", Status::refused, {"9", ""}, {})};
  out.variants[3].message = "no \"parts\", of these values";
  out.variants[1].kept = true;
  return out;
}

TEST(SweepOutput, ATableHasAllFiguresUnderTheirNames) {
  const std::string text = sweep_csv(example());
  EXPECT_EQ(text,
            "variant,fit.order,hardware.circuit.resistors,status,target_db,yield_db,poles,compute_s,message\n"
            "a,2,,done,0.3,1.2,,0.5,\nb,3,E24,limit_missed,0.1,0.7,,0.5,\nc,4,E96,done,0.2,1.1,4.0,0.5,\n"
            "d,9,,refused,,,,0.5,\"no \"\"parts\"\", of these values\"\n");
  const Json json = sweep_json(example());
  ASSERT_EQ(json["variants"].size(), 4U);
  EXPECT_EQ(json["variants"][0]["changes"], (Json{{"fit.order", "2"}}));
  EXPECT_EQ(json["variants"][2]["changes"],
            (Json{{"fit.order", "4"}, {"hardware.circuit.resistors", "E96"}}));
  EXPECT_EQ(json["variants"][2]["figures"], (Json{{"target_db", 0.2}, {"poles", 4.0}, {"yield_db", 1.1}}));
  EXPECT_FALSE(json["variants"][0].contains("message"));
  EXPECT_EQ(json["variants"][3]["message"], "no \"parts\", of these values");
  EXPECT_EQ(json["variants"][1]["kept"], true);
  EXPECT_EQ(json["variants"][0]["kept"], false);
}

// Of those that meet their limits; tracking before tolerances before the error at the target.
TEST(SweepOutput, TheBestIsByWhatMattersMost) {
  Sweep sweep = example();
  EXPECT_EQ(sweep_json(sweep)["best"], (Json{{"name", "c"}, {"by", "yield_db"}}));
  EXPECT_NE(sweep_summary(sweep).find("best by yield_db: c (what c is)"), std::string::npos);
  EXPECT_NE(sweep_summary(sweep).find("1 of them kept from an earlier sweep"), std::string::npos);
  EXPECT_NE(sweep_summary(sweep).find("d: no \"parts\""), std::string::npos);
  sweep.variants[0].figures.emplace_back("tracking_percent", 0.9);
  sweep.variants[1].kept = false;
  EXPECT_EQ(sweep_json(sweep)["best"], (Json{{"name", "a"}, {"by", "tracking_percent"}}));
  EXPECT_EQ(sweep_summary(sweep).find("kept"), std::string::npos);
  for (SweptVariant& one : sweep.variants) {
    std::erase_if(one.figures, [](const auto& figure) { return figure.first != "target_db"; });
  }
  EXPECT_EQ(sweep_json(sweep)["best"], (Json{{"name", "c"}, {"by", "target_db"}}));
  for (SweptVariant& one : sweep.variants) one.status = Status::refused;
  EXPECT_FALSE(sweep_json(sweep).contains("best"));
}

}  // namespace
}  // namespace bodesmith::project
