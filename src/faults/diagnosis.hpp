#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "faults/fault.hpp"
#include "faults/finding.hpp"

namespace bodesmith::faults {

/// What is believed before anything is measured; docs/faults.md states the same.
struct Priors {
  double good = 0.50;
  double one_fault = 0.44;
  double two_faults = 0.06;
  /// Of the good boards: all parts' errors so many times as large as stated.
  double wider_spread[2] = {2.5, 6.0};
  double wider_share = 0.04;  ///< each
};

/// ln of every fault's share among single faults: the kinds' priors, normalised over those that are there, each shared
/// by its faults evenly.
std::vector<double> log_priors(const std::vector<Fault>& faults);

enum class Verdict { nothing_wrong, uncertain, one_fault, two_faults, tie, unexplained };
const char* to_string(Verdict verdict);

/// Everything that accuses the same part (or the same two), and its probability.
struct Suspect {
  std::string site;
  double probability = 0.0;
  Finding best;
  double worst_error_percent =
      0.0;  ///< of the measurement against this explanation, parts at their nominal values
};

/// Where to measure next: the node at which the rivals' predictions differ most.
struct Probe {
  std::string node;
  Hertz at;
  double db = 0.0;  ///< least difference between two rivals there, where the difference is largest
  double deg = 0.0;
  double factor = 0.0;  ///< that difference in tolerances of a part: below about 3 it tells nothing
  std::vector<std::string> tells_apart;  ///< "R1_1 from R2_1"
};

/// What mends the board.
struct Rework {
  std::string text;
  std::size_t parts = 1;       ///< to exchange
  double error_percent = 0.0;  ///< worst complex error that is left, whichever of the tied ones is wrong
  /// One part more: place in Board::soldered_parts() of the one that it is soldered across, and its value.
  struct Across {
    std::size_t part = 0;
    double value = 0.0;
  };
  std::optional<Across> across = std::nullopt;
};

struct DiagnosisOptions {
  Priors priors;
  /// Standard deviations of the measurement; absent: from the measurement itself.
  std::optional<double> gain_noise;
  std::optional<double> phase_noise;
  std::function<void(double)> progress = [](double) {};
  std::function<bool()> stop = [] { return false; };
};

struct Diagnosis {
  Verdict verdict = Verdict::unexplained;
  double good_probability = 0.0;   ///< nothing wrong, the parts as stated or wider spread
  double wider_probability = 0.0;  ///< of it: wider
  /// ln p(measured | this board, with whatever may be wrong with it), but for what the measurement's points alone decide.
  double log_evidence = 0.0;
  std::vector<Suspect> suspects;  ///< most probable first
  std::size_t tied = 1;           ///< the first so many of them cannot be told apart
  std::vector<std::pair<std::string, double>>
      parts;  ///< of each part alone: the sum over everything that accuses it
  Noise noise;
  double misfit =
      0.0;  ///< of the best explanation over its number of values: 1 when nothing but noise is left
  std::size_t tried = 0;
  std::optional<Probe> probe;
  std::vector<Rework> rework;
  std::vector<std::string> hidden;  ///< parts that cannot be judged before what is wrong is mended
  std::vector<Fault> faults;        ///< the findings point into it
};

/// Throws Interrupted.
Diagnosis diagnose_board(const Board& board, const DiagnosisOptions& options);

/// Of the tied suspects; nothing where no node can be reached.
std::optional<Probe> next_probe(const Board& board, std::span<const Suspect> rivals);
std::vector<Rework> rework_for(const Board& board, std::span<const Suspect> rivals);
/// Parts that could have any wrong value of the catalogue without showing it as long as the board has what one of the rivals
/// says (whichever of them), and would show some on a good board.
std::vector<std::string> hidden_behind(const Board& board, const std::vector<Fault>& faults,
                                       std::span<const Suspect> rivals);

}  // namespace bodesmith::faults
