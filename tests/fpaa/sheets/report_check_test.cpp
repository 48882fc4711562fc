#include "fpaa/sheets/report_check.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/seed_sections.hpp"
#include "fpaa/sheets/build_sheet.hpp"
#include "run_program.hpp"

namespace bodesmith::fpaa {
namespace {

using ::testing::HasSubstr;

std::string row(const std::string& label, const std::string& value) {
  return "\t<tr>\n<td class=\"side_label\" width=\"50%\">" + label + "</td>\n<td class=\"side_value\">" +
         value + "</td>\n\t</tr>\n";
}

/// The report as AnadigmDesigner2 writes it, of a project typed from the plan.
std::string report_of(const Plan& plan) {
  std::string out = "<html>\n<head><style type=\"text/css\">TD { font-size: 10pt }</style></head>\n<body>\n";
  const Board& board = board_by_name(plan.board);
  for (const ChipPlan& chip : plan.chips) {
    out += "<h1>Chip: FPAA1</h1><img src=\"x.png\" /><br />\n<h1>Clocks: FPAA1</h1>\n<table>";
    out += row("Master Clock - ACLK (fc)", "16 MHz");
    out += row(fmt::format("System Clock 1 (sys1 = fc / {})", chip.clocks.sys1_divisor), "x");
    for (std::size_t k = 0; k < chip.clocks.clocks.size(); ++k) {
      out += row(fmt::format("Clock {} (sys1 / {})", k, chip.clocks.clocks[k].divisor),
                 rounded_text(chip.clocks.frequency(board.master_clock, k).value / 1e3) + " kHz");
    }
    out += "</table><p class=pagebreak><h1>Configurable Analog Modules: FPAA1</h1><table border=\"1\">\n";
    for (const PlacedCam& cam : chip.cams) {
      out += fmt::format(
          "<tr><td valign=\"top\"><b>{}<br />({} v1.0.1)</b><br />\n<i>Anadigm "
          "(Approved)</i>\n</td><td><table>",
          cam.name, cam.cam_name());
      out += row("Filter Type", cam.option) + row("Output Phase", "Phase 1");
      for (const CamValues::Entry& entry : cam.realised.entries()) {
        const CamParameter* parameter = cam.cam->parameter(entry.key);
        if (parameter == nullptr) continue;
        out += row(std::string(parameter->words) + (parameter->frequency ? " [kHz]" : ""),
                   rounded_text(*entry.number() / (parameter->frequency ? 1e3 : 1.0), 4));
      }
      out += row("ClockA", fmt::format("{} kHz (Chip Clock {})", rounded_text(cam.clock_a.value / 1e3, 4),
                                       cam.clock_index));
      out += "</table></td></tr>\n";
    }
    out += "</table>";
  }
  return out + "</body></html>";
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(ReportCheck, WhatWasTypedFromThePlanAgrees) {
  DesignerReport report = read_report(report_of(seed_plan()), "r.htm");
  EXPECT_EQ(report.cams.size(), 8u);
  EXPECT_EQ(report.cams[0].cam, "FilterBilinear");
  EXPECT_THAT(compare_report(report, seed_plan()), ::testing::IsEmpty());
  // A report may leave out its clocks.
  for (DesignerReport::Chip& chip : report.chips) chip.clocks.clear();
  EXPECT_THAT(compare_report(report, seed_plan()), ::testing::IsEmpty());
}

TEST(ReportCheck, EveryKindOfMistakeIsListed) {
  const std::string good = report_of(seed_plan());
  const auto differences = [&](const std::string& html) {
    return compare_report(read_report(html, "r.htm"), seed_plan());
  };
  const auto expect_one = [&](const std::string& html, const std::string& what) {
    const auto list = differences(html);
    ASSERT_EQ(list.size(), 1u) << what;
    EXPECT_THAT(list[0], HasSubstr(what));
  };
  expect_one(with(good, "Pole and Zero", "Low Pass"), "Section1a: Filter Type is Low Pass");
  EXPECT_THAT(differences(with(good, "Pole and Zero", "Pole&nbsp; and Zero")), ::testing::IsEmpty());
  expect_one(with(good, "Pole and Zero", "&lt;A&amp;B&gt; &other;"),
             "Section1a: Filter Type is <A&B> &other;");
  expect_one(with(good, "Phase 1", "Phase 2"), "Output Phase is Phase 2");
  expect_one(with(good, "2 kHz (Chip Clock 0)", "2 kHz (Chip Clock 3)"), "ClockA");
  expect_one(with(good, "2 kHz (Chip Clock 0)", "20 kHz (Chip Clock 0)"), "Section1a: ClockA");
  expect_one(with(good, "<b>Section2b<br />(FilterBilinear", "<b>Section2b<br />(FilterBiquad"),
             "Section2b: the CAM is FilterBiquad");
  EXPECT_EQ(differences(with(good, "<b>Section2b", "<b>Section9")).size(), 2u);
  const double pole = seed_plan().cams()[0]->realised.required_number("pole_hz") / 1e3;
  expect_one(with(good, rounded_text(pole, 4), rounded_text(1.02 * pole, 4)), "Section1a: Pole Frequency");
  expect_one(
      with(good, fmt::format("(sys1 / {})", seed_plan().chips[0].clocks.clocks[0].divisor), "(sys1 / 6)"),
      "the plan divides by");
}

TEST(ReportCheck, BrokenPagesAreRefusedOrCompared) {
  EXPECT_THROW(read_report("", "r"), InputError);
  EXPECT_THROW(read_report("<html><b>x</b>", "r"), InputError);
  const std::string good = report_of(seed_plan());
  for (std::size_t cut = 0; cut < good.rfind("ClockA"); cut += 97) {
    try {
      EXPECT_FALSE(compare_report(read_report(good.substr(0, cut), "r"), seed_plan()).empty());
    } catch (const InputError&) {
    }
  }
}

TEST(ZrnaScript, IsPythonAndSetsEveryParameter) {
  const std::string script = zrna_script(seed_plan()).value();
  EXPECT_THAT(script, HasSubstr("z.FilterPoleZero(dependent_variable=z.HIGH_FREQUENCY_GAIN)"));
  for (const PlacedCam* cam : seed_plan().cams()) {
    EXPECT_THAT(script, HasSubstr("\"" + cam->name + "\""));
    EXPECT_THAT(script, HasSubstr(rounded_text(cam->realised.required_number("pole_hz") * 1e-3, 9)));
  }
  if (run_shell("python3 --version").status != 0) GTEST_SKIP() << "python3 is not installed";
  const TemporaryFolder folder;
  write_file(folder / "s.py", script);
  const auto result = run_shell("python3 -m py_compile " + (folder / "s.py").string());
  EXPECT_EQ(result.status, 0) << result.err;
}

}  // namespace
}  // namespace bodesmith::fpaa
