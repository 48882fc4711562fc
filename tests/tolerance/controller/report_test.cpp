// What is told of a controller's parts is what its study found.
#include "tolerance/controller/report.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "kept_text.hpp"
#include "synthesis/controller/seed_controller.hpp"
#include "texts.hpp"

namespace bodesmith::tolerance {
namespace {
using ::testing::HasSubstr;

const ControllerReport& seed_report() {
  static const ControllerReport made = [] {
    ControllerReportOptions options;
    options.study.frequencies = {Hertz{1.0}, Hertz{100.0}};
    options.study.draws = 40;
    options.trims.draws = 20;
    options.ngspice = false;
    return examine(generator::seed_controller(), tracking::PolynomialStage(generator::seed_disturbance()),
                   options);
  }();
  return made;
}

TEST(PartErrors, ATableSetsWhatItNamesAndNothingElse) {
  for (const generator::PartErrors::Named& one : generator::PartErrors::names()) {
    const generator::PartErrors read =
        generator::PartErrors::from_node(parse_json(fmt::format(R"({{"{}": 7.5}})", one.name), "e.json"));
    for (const generator::PartErrors::Named& other : generator::PartErrors::names())
      EXPECT_EQ(read.*other.value, other.value == one.value ? 7.5 : generator::PartErrors().*other.value)
          << one.name;
    EXPECT_THROW(
        generator::PartErrors::from_node(parse_json(fmt::format(R"({{"{}": -1}})", one.name), "e.json")),
        InputError);
  }
  EXPECT_THROW(generator::PartErrors::from_node(parse_json(R"({"resistor": 1})", "e.json")), InputError);
}

TEST(ControllerReport, ThePageTellsSharesAndFiguresOfTheStudy) {
  const ControllerReport& report = seed_report();
  const std::string page = trim_page(report, generator::seed_controller(), "seed");
  const Share& first = report.study.parts.front();
  EXPECT_THAT(page, HasSubstr(fmt::format("| {} | {:.2g} | {:.2g} |", first.name, 100.0 * first.share,
                                          first.rms_percent)));
  EXPECT_THAT(page,
              HasSubstr(fmt::format("| 100 | {:.2g} | {:.2g} |", report.trims.before_at[1].median_percent,
                                    report.trims.before_at[1].p95_percent)));
  for (const TrimStep& step : report.trims.steps) EXPECT_THAT(page, HasSubstr(step.trim.how));
  const auto controller = generator::seed_controller();
  expect_kept("tolerance/controller/kept_report.txt",
              line_a_key(to_json(report, controller)) + summary_text(report, controller) +
                  digest(few_digits(page)) + " page\n" + digest(few_digits(draws_csv(report.study))) +
                  " draws\n");
}

// The wiper goes from one reference to the other: through R1 and R2 to ground its ends are the trim's ends.
TEST(ControllerReport, DividersOfPotentiometersSpanTheirRange) {
  int found = 0;
  for (const Trim& trim : trims_of(generator::seed_controller())) {
    const auto divider = matches(trim.how, "through ([0-9.]+) kohm to the pin and ([0-9.]+) ohm from there");
    if (divider.empty()) continue;
    const double top = 1e3 * std::stod(divider[0][1]), bottom = std::stod(divider[0][2]);
    EXPECT_NEAR(2.5 * bottom / (top + bottom), trim.limit, 0.02 * trim.limit) << trim.name;
    ++found;
  }
  EXPECT_GT(found, 2);
}

TEST(ControllerReport, DrawsAreARowEach) {
  const Study& study = seed_report().study;
  std::istringstream lines(draws_csv(study));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "draw,error_1_hz_percent,error_100_hz_percent");
  for (std::size_t i = 0; i < study.percent.size(); ++i) {
    std::getline(lines, line);
    EXPECT_THAT(line, ::testing::StartsWith(fmt::format("{},", i)));
    EXPECT_EQ(std::stod(line.substr(line.rfind(',') + 1)), study.percent[i][1]);
  }
}

}  // namespace
}  // namespace bodesmith::tolerance
