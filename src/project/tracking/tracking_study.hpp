#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "project/design/budget.hpp"
#include "project/design/design.hpp"
#include "project/project.hpp"
#include "report/page.hpp"
#include "tracking/built_controller.hpp"
#include "tracking/stage.hpp"

namespace bodesmith::project {

/// Keys of the columns: in run.json, and in tracking.csv without the unit. A BuiltController has its own.
namespace tracked {
// One pass, v = x - d(x), as in the disturbance paper.
inline constexpr std::string_view none = "none";              ///< no compensation at all
inline constexpr std::string_view polynomial = "polynomial";  ///< the generator's polynomial at constant gain
inline constexpr std::string_view cascade = "cascade";
inline constexpr std::string_view sections = "sections";
inline constexpr std::string_view waveform =
    "waveform";  ///< the best waveform fit, when something else is built
inline constexpr std::string_view scheduled = "scheduled";  ///< a gain set by the known frequency
inline constexpr std::string_view fpaa = "fpaa";            ///< the capacitors' transfer functions alone
inline constexpr std::string_view fpaa_with_holds = "fpaa_with_holds";
inline constexpr std::string_view paper_board = "paper_board";  ///< FilterBilinear, one chip, one clock
inline constexpr std::string_view circuit = "circuit";
// Two passes, v = x - d(x - d(x)).
inline constexpr std::string_view two_passes = "two_passes";
inline constexpr std::string_view two_passes_scheduled = "two_passes_scheduled";
// The generator fed by its own drive, v = x - d(v).
inline constexpr std::string_view self_fed = "self_fed";  ///< at constant gain
inline constexpr std::string_view self_fed_sections = "self_fed_sections";
inline constexpr std::string_view self_fed_scheduled = "self_fed_scheduled";
inline constexpr std::string_view self_fed_slope = "self_fed_slope";  ///< gain by the measured slope
inline constexpr std::string_view self_fed_sum = "self_fed_sum";  ///< sections, and a gain for what they lack
inline constexpr std::string_view self_fed_fpaa = "self_fed_fpaa";
inline constexpr std::string_view self_fed_circuit = "self_fed_circuit";
}  // namespace tracked

/// One way of compensating, followed through the plant at every tracked frequency.
struct TrackedDesign {
  std::string key;
  std::string name;                         ///< for a person
  bool built = false;                       ///< made of what the run writes
  int parts = 0;                            ///< op-amps and multipliers, for ties
  std::vector<tracking::TrackingError> at;  ///< one a frequency (disturbance paper, eq. 8)
  /// rms_percent as formulas have it, the stage evaluated on the reference: for comparison, no stage shows it.
  /// Empty for a built controller, of which only the drive is known.
  std::vector<double> on_reference_percent;

  /// One figure at every frequency.
  std::vector<double> each(double tracking::TrackingError::*figure) const;
  /// Over the frequencies; infinite without any.
  double worst_percent() const;
  double worst_without_lag_percent() const;
};

/// A controller on a stage along one reference, `drives` its drive at each frequency.
TrackedDesign tracked_controller(const tracking::BuiltController& controller, const tracking::Stage& stage,
                                 const tracking::Reference& reference, const std::vector<Hertz>& frequencies,
                                 const std::vector<tracking::DriveWaveform>& drives);

/// One period of the steady state, for the time plots.
struct TrackedPeriod {
  Hertz frequency;
  std::vector<double> time_s;
  std::vector<double> reference;                   ///< 0 to 1
  std::vector<std::vector<double>> error_percent;  ///< one curve a design; empty where it is not known
};

/// The same designs on a stage of another family, or along another reference.
struct TrackedElsewhere {
  std::string stage;  ///< "polynomial", "polynomial_nested", "preisach", …
  tracking::Reference::Shape waveform = tracking::Reference::Shape::triangle;
  double amplitude = 1.0;
  /// How far the family's model is from the loops it was identified from, one a frequency; empty: it is the
  /// polynomial itself.
  std::vector<double> fit_percent;
  std::vector<TrackedDesign> designs;
};

/// What is built by engines that share nothing: worst rms error over the frequencies, the best pure delay removed, % of range.
struct EngineRow {
  std::string what;
  std::optional<double> closed_form_percent =
      {};  ///< or harmonic by harmonic; a board by charge conservation
  std::optional<double> cvode_percent = {};
  std::optional<double> ngspice_percent = {};
  /// Greatest rms difference in time: the controller's drive by ngspice and CVODE; the circuit's displacement by harmonics and
  /// either of them.
  std::optional<double> agreement_percent = {};
  std::string missing = {};  ///< why an engine has no figure
  /// Where what the closed form leaves out (BoardsInTime::apart) makes most, and its share: ngspice's figure less the closed form's, there.
  std::string apart_where = {};
  double apart_percent = 0.0;
};

/// Table II of the disturbance paper (docs/papers.md) by simulation, on a stage that reads its drive.
struct TrackingStudy {
  std::vector<Hertz> frequency;
  tracking::Reference::Shape waveform = tracking::Reference::Shape::triangle;
  double amplitude = 1.0;
  std::vector<TrackedDesign> designs;
  std::string as_built;                     ///< key of the design that stands for the run
  std::vector<TrackedElsewhere> elsewhere;  ///< tracking_elsewhere.hpp
  TrackedPeriod shown;                      ///< at the highest tracked frequency
  /// CVODE against the harmonic computation, rms percent of range.
  double max_cross_check_percent = 0.0;
  std::optional<double> agreement_percent;  ///< ControllersTracked::agreement_percent
  std::vector<EngineRow> engines;           ///< engines.hpp
  std::vector<std::string>
      findings;  ///< sentences: where accuracy is lost, what is worse than no compensation
  double compute_s = 0.0;

  /// Null when that one is not in the table.
  const TrackedDesign* find(std::string_view key) const;
};

/// The study as it stands in run.json, and as tracking.csv and tracking_stages.csv.
Json to_json(const TrackingStudy& study);
std::string tracking_csv(const TrackingStudy& study);
std::string tracking_stages_csv(const TrackingStudy& study);

/// "1 to 100 Hz".
std::string frequency_span(const TrackingStudy& study);

/// What was tracked as built, and next to it nothing, the disturbance paper's design and what was measured: worst rms
/// errors over the frequencies, for the first lines of summary and report.
report::Table headline_table(const Project& project, const TrackingStudy& study);

}  // namespace bodesmith::project
