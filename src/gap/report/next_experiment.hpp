#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gap/search_options.hpp"
#include "gap/search_result.hpp"
#include "gap/study.hpp"

namespace bodesmith::gap {

/// The drive that best tells models apart that the records cannot.
struct NextExperiment {
  double step_s = 0.0;
  std::vector<double> u;
  /// What is told apart: effects, or the two ends of an open parameter; and what each predicts.
  std::vector<std::string> rivals;
  std::vector<std::vector<double>> predicted;
  double difference_over_noise = 0.0;  ///< rms to expect of the nearest two, after each one's own refit
  std::string shape;                   ///< of the drive, for a person
};

/// A parameter that the records leave open, between these values.
struct OpenParameter {
  std::size_t unknown = 0;  ///< of the model
  std::string name;
  double low = 0.0;
  double high = 0.0;
};

/// For the last tie of a search, or else the parameter that is most open; nothing when there is neither, or
/// for frequency responses. Tried are multisines, sweeps, triangles and stairs of several
/// sizes and speeds, within `request` and otherwise the training inputs' range, rate, length and step. The winner keeps the
/// most pairs of rivals apart by the most standard deviations of the noise that was found, of what no refit within the
/// parameters' uncertainty takes away, whichever of the two is right.
std::optional<NextExperiment> next_experiment(const SearchResult& result,
                                              const std::vector<OpenParameter>& open, const Study& study,
                                              const DriveRequest& request = {});

/// time_s,u and a column a rival.
std::string to_csv(const NextExperiment& experiment);

}  // namespace bodesmith::gap
