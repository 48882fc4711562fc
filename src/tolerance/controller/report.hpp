#pragma once

#include <string>

#include "base/documents/json_fwd.hpp"
#include "synthesis/controller/loop.hpp"
#include "tolerance/controller/study.hpp"
#include "tolerance/controller/trim.hpp"

namespace bodesmith::tolerance {

/// What is known of a controller's parts: how far they put it off, what trimming brings, whether its loop is stable.
struct ControllerReport {
  generator::PartErrors errors;
  Study study;
  TrimStudy trims;
  generator::LoopStability loop;
  std::vector<DrawCheck> checked;  ///< against ngspice
};

struct ControllerReportOptions {
  StudyOptions study;
  TrimOptions trims;
  int checked_draws = 2;        ///< run through ngspice too, when it is installed
  bool ngspice = true;          ///< the loop in ngspice too, when it is installed
  bool allow_unstable = false;  ///< no refusal below generator::kLeastMarginDeg
};

/// The stroke at which a controller's parts are examined: with amplitude gains the full one, at which trims are read too.
double examined_stroke(const generator::DisturbanceCircuit& controller, double asked);

/// DesignError as require_stable().
ControllerReport examine(const generator::DisturbanceCircuit& controller, const tracking::Stage& stage,
                         const ControllerReportOptions& options);

/// Three keys for controller.json: `errors_of_parts`, `trim`, `stability`.
Json to_json(const ControllerReport& report, const generator::DisturbanceCircuit& controller);
/// For a person at the bench: the steps with the expected readings of this very design (trim.md).
std::string trim_page(const ControllerReport& report, const generator::DisturbanceCircuit& controller,
                      const std::string& title);
/// A line each: spread, parts that matter, trims, stability.
std::string summary_text(const ControllerReport& report, const generator::DisturbanceCircuit& controller);
/// `draw,frequency columns…`: the tracking error of every copy, untrimmed.
std::string draws_csv(const Study& study);

}  // namespace bodesmith::tolerance
