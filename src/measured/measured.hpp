#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "base/files.hpp"
#include "base/provenance.hpp"
#include "gap/search_options.hpp"
#include "project/project.hpp"

namespace bodesmith::measured {

/// Hardware that was built, measured and held against its own prediction: what is wrong with it by the name of a part, and
/// the hardware for what was found.
struct Measured {
  Provenance from;
  std::string file;
  std::string of;  ///< "the controller and the stage", "the circuit"
  double gap_percent =
      0.0;  ///< rms between measurement and prediction; of the range, or complex of a response
  double noise_percent = 0.0;  ///< of it; 0: not known
  double left_percent = 0.0;   ///< the same with what was found
  std::string verdict;         ///< of the diagnosis
  std::vector<std::string>
      found;  ///< sentences: "Rd3 is 8.0 % above its value"; empty: nothing is wrong that has a name
  std::vector<std::string> tied;  ///< the names of parts of which it is one, where it cannot be said which
  std::string advice;
  std::vector<std::string> next;  ///< sentences: what was designed again, and what that makes of it
  std::string next_name;          ///< of the figures: "tracking_percent", "response_percent"
  double before_percent = 0.0;    ///< as measured
  double after_percent = 0.0;     ///< as predicted of next/
  double compute_s = 0.0;
  std::vector<std::filesystem::path> files;

  bool wrong() const { return !found.empty(); }
  Json json() const;
  std::string summary(const std::filesystem::path& folder) const;
};

/// gap.svg: the gap before and with what was found, and beneath it what the hardware did and what next/ will do.
struct GapPicture {
  std::string x_label;
  bool logarithmic = false;
  std::vector<double> x;
  std::vector<double> gap, left;      ///< percent
  std::vector<double> before, after;  ///< percent; empty: not known
  std::string what;                   ///< of those: "error of tracking"

  std::string svg() const;
};

/// `data`: a response of the built circuit (frequency_hz, magnitude_db, phase_deg), or a record (time_s, u, y) of the
/// controller, the stage or both. `folder`: what `run` wrote of this project; where nothing stands the project is run first.
/// Writes measured/ and, where something is wrong, next/.
Measured run_measured(const project::ProjectSource& source, const std::filesystem::path& data,
                      const std::filesystem::path& folder, const gap::SearchOptions& options);

// The two kinds of measurement; each adds its files to `measured` and, where something is wrong, to `next`.
Measured measured_record(const project::ProjectSource& source, const std::filesystem::path& data,
                         const std::filesystem::path& folder, const gap::SearchOptions& options,
                         OutputSet& measured, OutputSet& next);
Measured measured_response(const std::filesystem::path& data, const std::filesystem::path& folder,
                           const gap::SearchOptions& options, OutputSet& measured, OutputSet& next);

}  // namespace bodesmith::measured
