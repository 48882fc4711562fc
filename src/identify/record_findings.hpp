#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "chain/chain.hpp"
#include "hysteresis/model_type.hpp"
#include "identify/stage_fit.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::identify {

/// What records are like, found before any model is chosen.
struct RecordFindings {
  double transient_s = 0.0;  ///< how long a start transient lasts that no model at rest explains; 0: none
  double delay_s = 0.0;      ///< pure delay between input and output; 0: none worth having
  /// Where all inputs repeat at one frequency.
  std::optional<double> frequency_hz;
  /// The same in words.
  std::vector<std::string> notes;
};
/// By a bank of ten plays, which is cheap and general: fitted to the second half of every record, it shows how long
/// the first half is off by more than three times what is usual later; with and without a delay, whether that pays
/// (5 % of the error at least).
RecordFindings find_in_records(std::span<const TimeRecord> records,
                               const hysteresis::IdentifyOptions& options, bool look_for_delay);

/// A fit as reports have it: errors in training and held out, parameters with their deviations; or why it was refused.
Json to_json(const StageFit& fit);
/// The fitted stage as model.toml has it: with a free gain and offset behind it where nothing is free (what diagnose may
/// refit before it blames what is missing), and with what it has seen in its table [trained].
chain::Chain identified_model(const StageFit& fit, std::span<const TimeRecord> training, double skip_s);

}  // namespace bodesmith::identify
