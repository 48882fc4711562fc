#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "fpaa/device/config_stream.hpp"
#include "fpaa/streams/api_code.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::fpaa {

/// Where a branch's gain |Cin/Cout| stands on the board.
struct GainPlace {
  std::string words;  ///< as the user named it
  int address1 = 1;
  /// Capacitors over the fraction line that bear the same value (GainInv has its pair twice in some tables).
  std::vector<MemoryPlace> over;
  std::vector<MemoryPlace> under;
  int fixed_under = 0;  ///< units of a Cout that stays as it is; 0: Cout is chosen too
};

/// `CHIP.CAM` (its capacitors Cin and Cout), `CHIP.CAM:OVER/UNDER` by names of the project's table (UNDER may be
/// a number of units that stays as it is), or `ADDRESS1:BANK.BYTE/BANK.BYTE` where the addresses are known
/// without a project. Throws InputError that begins with `option`.
GainPlace parse_gain_place(const std::string& text, const ApiProject* project, const std::string& option);

/// One branch of the schedule.
struct GainBranch {
  Disturbance::Branch branch = Disturbance::Branch::ascending;
  GainPlace place;
  double at_one = 1.0;  ///< |Cin/Cout| where the table's gain is 1
  /// Where the ratios nearest the gains are further off than half a step (near 1 they are .4 % apart): the gain
  /// at 1 with the least such error, and that error; otherwise 0.
  double better_at_one = 0.0, better_error_percent = 0.0;
};

/// A gain as two capacitors make it.
struct GainCapacitors {
  double wanted = 1.0;  ///< |Cin/Cout|
  int over = 1;
  int under = 1;
  double realised() const { return static_cast<double>(over) / under; }
};

/// What is sent for one frequency. It serves from `from` to `to` (geometric means of neighbouring frequencies); a
/// host that already has it keeps it until a quarter of an interval further, so that it does not toggle.
struct GainSet {
  Hertz frequency, from, to, keep_from, keep_to;
  std::vector<GainCapacitors> gains;  ///< one a branch of the schedule
  std::map<int, Bytes> streams;       ///< update stream of each chip, by its Address1
};

struct GainSchedule {
  std::vector<GainBranch> branches;
  std::vector<GainSet> sets;                ///< frequency rising
  double step_percent = 0.0;                ///< largest step of a gain from one set to the next, of the gain
  double max_ratio_error_percent = 0.0;     ///< of the capacitor ratios, of the gain
  double max_gain_error_percent = 0.0;      ///< at any frequency of the table's range, steps included
  double max_tracking_error_percent = 0.0;  ///< that times the greatest |d| of its branch, of the stroke
  double update_s = 0.0;                    ///< longest packets of one set on the serial line

  std::string packets(const GainSet& set) const;  ///< the board's packets, one a chip
  Json to_json() const;
  std::string csv() const;
};

/// Largest step of a rate gain from one capacitor set of the controller to the next, of the gain.
inline constexpr double kGainStepPercent = 0.5;
/// Frequencies for which a host has a set of capacitors: those of the rate table, with as many (`most` parts) between neighbours as keep
/// each gain's step within `step_percent` (gains are straight lines in log f, as Disturbance::rate_gain has them). Empty without a table.
std::vector<Hertz> gain_set_frequencies(const Disturbance& disturbance,
                                        double step_percent = kGainStepPercent, int most = 200);

/// Sets between which no gain steps by more than `step_percent` of itself. Capacitors: the ratio of 1 to 255
/// units nearest the gain; among equals the largest, whose mismatch is the least. Throws DesignError when there
/// is nothing to schedule, a gain is out of reach, or two branches want one capacitor.
GainSchedule make_gain_schedule(const Disturbance& disturbance, const std::vector<GainBranch>& branches,
                                double step_percent, const std::string& file);

/// A host's loop with the table in it: C (POSIX, nothing else needed) and Python (standard library).
std::string gain_host_c(const GainSchedule& schedule, const std::string& file);
std::string gain_host_python(const GainSchedule& schedule, const std::string& file);
std::string gain_sheet(const GainSchedule& schedule, const std::string& file);

}  // namespace bodesmith::fpaa
