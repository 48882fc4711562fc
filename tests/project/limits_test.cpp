// What a limit is compared with: the worst of what was made, and what was not made meets none.
#include "project/limits.hpp"

#include <gtest/gtest.h>

namespace bodesmith::project {
namespace {

tracking::TrackingError error_of(double rms, double without_lag) {
  tracking::TrackingError out;
  out.rms_percent = rms;
  out.rms_percent_without_lag = without_lag;
  return out;
}

/// A circuit, and a board, each by engines that say this.
EngineRow circuit(std::optional<double> ngspice, std::optional<double> apart) {
  return {.what = "circuit", .cvode_percent = 0.1, .ngspice_percent = ngspice, .agreement_percent = apart};
}
EngineRow board(std::optional<double> ngspice, std::optional<double> apart) {
  return {.what = "board", .ngspice_percent = ngspice, .agreement_percent = apart};
}

LimitCheck agreement(std::vector<EngineRow> rows) {
  Project project;
  project.target.sections = Sections{};
  project.limits.agreement_percent = 0.25;
  TrackingStudy study;
  study.engines = std::move(rows);
  const auto checks = check_limits(project, Design{}, study);
  EXPECT_EQ(checks.size(), 1U);
  return checks.at(0);
}

TEST(Limits, AgreementIsTheWorstOfAllThatRan) {
  EXPECT_EQ(agreement({circuit(0.1, 0.2), circuit(0.1, 0.1)}).got, 0.2);
  EXPECT_EQ(agreement({circuit(0.1, 0.1), board(0.1, 0.3)}).got, 0.3);
  EXPECT_TRUE(agreement({circuit(0.1, 0.2), circuit(0.1, 0.1)}).met());
  EXPECT_FALSE(agreement({circuit(0.1, 0.1), board(0.1, 0.3)}).met());
  EXPECT_TRUE(agreement({circuit(0.1, 0.25)}).met()) << "a limit belongs to what it allows";
  // ngspice runs a board at its highest frequencies alone, and may run none; a circuit it must run.
  EXPECT_EQ(agreement({circuit(0.1, 0.2), board({}, {})}).got, 0.2);
  for (const auto& rows : {std::vector{circuit({}, 0.1)}, std::vector{circuit(0.1, {})},
                           std::vector{circuit(0.1, 0.1), board(0.1, {})}, std::vector<EngineRow>{}}) {
    EXPECT_FALSE(agreement(rows).got);
    EXPECT_FALSE(agreement(rows).met());
    EXPECT_EQ(agreement(rows).got_text(), "not made");
  }
}

TEST(Limits, TrackingIsTheWorstOfWhatIsBuiltWithoutItsDelay) {
  Project project;
  project.target.sections = Sections{};
  project.limits.tracking_percent = 0.3;
  project.limits.circuit_db = 1.0;
  TrackingStudy study;
  study.designs = {{.key = "other", .name = "other", .at = {error_of(9.0, 8.0)}, .on_reference_percent = {}},
                   {.key = "built",
                    .name = "built",
                    .at = {error_of(1.0, 0.1), error_of(2.0, 0.25), error_of(3.0, 0.2)},
                    .on_reference_percent = {}}};
  study.as_built = "built";
  const auto checks = check_limits(project, Design{}, study);
  ASSERT_EQ(checks.size(), 2U) << "those that the project sets, in the order of Limits";
  EXPECT_EQ(checks[0].name, "circuit_db");
  EXPECT_FALSE(checks[0].got);
  EXPECT_EQ(checks[1].name, "tracking_percent");
  EXPECT_EQ(checks[1].got, 0.25);
  EXPECT_EQ(limits_text(checks),
            "limit      circuit_db 1: not made NOT met\nlimit      tracking_percent 0.3: 0.25 met\n");
}

}  // namespace
}  // namespace bodesmith::project
