#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fpaa/plan/plan.hpp"

namespace bodesmith::fpaa {

/// A CAM as AnadigmDesigner2's HTML report shows it: "name (FilterBilinear v1.2)" and rows of label and
/// value.
struct ReportedCam {
  std::string chip;
  std::string name;
  std::string cam;
  std::vector<std::pair<std::string, std::string>> rows;
};

struct DesignerReport {
  struct Chip {
    std::string name;
    std::vector<std::pair<std::string, std::string>> clocks;  ///< "Clock 3 (sys1 / 64)", "250 kHz"
  };
  std::vector<Chip> chips;
  std::vector<ReportedCam> cams;
};

/// Reads the report by its visible text (headings "Chip: X", "Clocks: X", "Configurable Analog Modules: X",
/// bold names, rows of side_label and side_value cells). Throws InputError when it holds no CAM.
DesignerReport read_report(std::string_view html, const std::string& file);

/// Every difference between what was typed and the plan, one line each: CAMs missing or unknown, kind,
/// ClockA, output phase, parameters (more than `tolerance` off the realised value; the report rounds), clock
/// divisors. Empty: none.
std::vector<std::string> compare_report(const DesignerReport& report, const Plan& plan,
                                        double tolerance = 0.005);

}  // namespace bodesmith::fpaa
