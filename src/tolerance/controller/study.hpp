#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tolerance/controller/board.hpp"
#include "tracking/stage.hpp"

namespace bodesmith::tolerance {

struct StudyOptions {
  generator::PartErrors errors;
  std::vector<Hertz> frequencies;
  tracking::Reference reference;
  std::uint64_t draws = 1000;
  std::uint64_t seed = 1;
  int threads = 0;                           ///< 0: as many as there are cores
  std::size_t samples = 256;                 ///< a period
  std::vector<double> switch_delays_s = {};  ///< of the frequencies, where they are known
};
/// generator::switch_delay_s() of the triangle at each frequency; 0 without a switch.
std::vector<double> switch_delays_s(const generator::DisturbanceCircuit& controller,
                                    const std::vector<Hertz>& frequencies);

/// Tracking error (rms, percent of range, lag removed) of all copies at one frequency.
struct ErrorSpread {
  double nominal_percent = 0.0;
  double median_percent = 0.0;
  double p95_percent = 0.0;
  double max_percent = 0.0;
};
ErrorSpread spread_of(std::vector<double> percent, double nominal);

/// What is left of e over one repeat of r without what a delay of r would make (r's slope times anything).
std::vector<double> without_lag(std::vector<double> e, const std::vector<double>& r);

/// One thing that may be off, or a group of them: its share of the mean square that the errors of all parts add.
struct Share {
  std::string name;
  std::string group;
  double share = 0.0;
  double rms_percent = 0.0;  ///< what it adds at one standard deviation, worst frequency
};

struct Study {
  std::vector<Hertz> frequencies;
  std::vector<ErrorSpread> at;  ///< each frequency
  ErrorSpread worst;            ///< of each copy the frequency that is worst for it
  std::vector<Share> parts;     ///< largest first
  std::vector<Share> groups;    ///< largest first
  /// Mean square that the shares explain over the one that was drawn: near 1 where the errors add linearly.
  double explained = 0.0;
  std::uint64_t draws = 0;
  /// Of each copy, by its number: errors at the frequencies.
  std::vector<std::vector<double>> percent;
};

/// The stage reads the drives that boards make. One for every thread to share: it keeps nothing.
class Bench {
 public:
  Bench(const generator::DisturbanceCircuit& controller, const tracking::Stage& stage,
        const StudyOptions& options);

  std::vector<double> errors_percent(const Board& board) const;
  double error_percent(const Board& board, std::size_t frequency) const;
  /// y of the stage.
  std::vector<double> displacement(const Board& board, std::size_t frequency) const;
  const generator::RestWiring& wiring() const { return wiring_; }
  const Input& input(std::size_t frequency) const { return inputs_[frequency]; }
  std::size_t frequencies() const { return inputs_.size(); }

 private:
  generator::RestWiring wiring_;
  const tracking::Stage& stage_;
  std::vector<Hertz> frequencies_;
  std::vector<Input> inputs_;
};

/// Same seed, same figures, whatever the number of threads. InputError without frequencies.
Study study_errors(const generator::DisturbanceCircuit& controller, const tracking::Stage& stage,
                   const StudyOptions& options);

/// One drawn copy at one frequency: the fast model alongside ngspice on the netlist with those very deviations.
struct DrawCheck {
  std::uint64_t draw = 0;
  Hertz frequency;
  double percent = 0.0;  ///< tracking error, lag removed
  double ngspice_percent = 0.0;
  double drive_rms_percent = 0.0;  ///< rms difference of v, of the stroke
};

/// The first `count` draws, at the frequencies in turn. Needs ngspice.
std::vector<DrawCheck> check_draws(const generator::DisturbanceCircuit& controller,
                                   const tracking::Stage& stage, const StudyOptions& options, int count);

}  // namespace bodesmith::tolerance
