#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "base/provenance.hpp"
#include "fpaa/device/mismatch.hpp"
#include "numeric/parallel_for.hpp"
#include "tolerance/design.hpp"

namespace bodesmith::tolerance {

/// Counts of one quantity in equal bins; `low` and `high` belong to the design, not to the samples, so that
/// counts from different processes add up.
struct Histogram {
  double low = 0.0, high = 1.0;
  std::vector<std::uint64_t> counts;
  double min = 0.0, max = 0.0;  ///< exact

  /// Linear within a bin.
  double quantile(double p) const;
};

/// How parts differ from what is printed on them.
struct Spread : schematic::Tolerances {
  enum class Kind {
    uniform,   ///< evenly within +-tolerance
    gaussian,  ///< standard deviation tolerance/sigmas, not cut off
    corners,   ///< every part at one of its two limits
  };
  Kind kind = Kind::uniform;
  double sigmas = 3.0;
  /// Temperature is even in [low, high]; every part has a coefficient of its own, even within +-ppm; 25 C is
  /// neutral.
  double temperature_low_c = 25.0;
  double temperature_high_c = 25.0;
  double resistor_ppm_per_k = 100.0;
  double capacitor_ppm_per_k = 30.0;
  fpaa::MismatchModel mismatch;  ///< of switched capacitors

  Spread() = default;
  /// As the design itself states its parts.
  explicit Spread(const Design& design);
};

std::string_view to_string(Spread::Kind kind);

struct Options {
  Spread spread;
  std::uint64_t samples = 100000;
  std::uint64_t seed = 1;
  std::vector<Hertz> grid;
  std::optional<double> limit_db;  ///< counts samples that stay within at every frequency
  std::optional<double> limit_deg;
  int threads = 0;  ///< 0: as many as the machine has (one when a team shares the job)
  /// Where an unfinished run is kept, and taken up again when the same job is started once more; empty:
  /// nowhere.
  std::filesystem::path checkpoint;
  std::string job;  ///< identifies inputs and options to the checkpoint
  std::function<void(double)> progress;
};

struct PartRank {
  std::string part;
  double worst_db = 0.0;  ///< by this part alone at its limit, at the frequency where that is most
  Hertz worst_hz;
  double db_per_percent = 0.0;  ///< sensitivity there
  double share = 0.0;  ///< of the variance of dB at the frequency where the design's variance is greatest
};

struct Result {
  std::string name;
  std::uint64_t samples = 0;
  std::vector<Hertz> grid;
  std::vector<Histogram> magnitude_db;  ///< one a frequency, deviation from the reference
  std::vector<Histogram> phase_deg;
  Histogram worst_db;  ///< of each sample, the greatest |deviation| over the grid
  Histogram worst_deg;
  Histogram worst_percent;   ///< the same of |H/reference - 1|: magnitude and phase in one
  std::uint64_t within = 0;  ///< samples within the limits
  double worst_case_db =
      0.0;  ///< every part at its limit in the worst direction at some frequency, judged as the samples are
  std::vector<PartRank> ranking;  ///< largest share first
};

/// Monte Carlo. Sample n's parts depend on (seed, n) alone and results are integer counts and extremes, so
/// that they are the same bit for bit for any number of threads and processes, and after an interruption.
/// Throws Interrupted (with the checkpoint written) after Ctrl-C. Only the team's leader gets a complete
/// result.
Result run_monte_carlo(const Design& design, const Options& options, const Team& team);

/// Tolerance classes of resistors and capacitors that can be bought, each with the 95th percentile of the
/// worst dB.
struct Purchase {
  double resistor_percent = 0.0;
  double capacitor_percent = 0.0;
  double worst_db_95 = 0.0;
  bool meets = false;
};
/// What to buy so that 95 % of the circuits (options.samples, 4096 at most) stay within limit_db; cheapest (largest tolerances)
/// first among those that meet it.
std::vector<Purchase> tolerances_to_buy(const Design& design, const Options& options, double limit_db);

/// Everything that the counts depend on besides samples and seed: identifies a checkpoint (Options::job).
std::string job_text(const Options& options, const Provenance& from);

/// One design's part of yield.json.
Json to_json(const Result& result, const Options& options);
/// `to_buy`: pairs of tolerances and whether they keep the limit.
Json to_json(const std::vector<Purchase>& purchases);

}  // namespace bodesmith::tolerance
