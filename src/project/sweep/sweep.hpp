#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "base/provenance.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::project {

/// What became of one variant: its figures as they stand in its variant.json.
struct SweptVariant {
  std::string name;
  std::string what;                 ///< what it changes, in words
  std::vector<std::string> values;  ///< one for each of Sweep::keys
  enum class Status { done, limit_missed, refused } status = Status::done;
  std::string message;                                  ///< why it was refused
  std::vector<std::pair<std::string, double>> figures;  ///< names with units, see Run::figures
  double compute_s = 0.0;
  bool kept = false;  ///< taken from an earlier sweep
};

struct Sweep {
  std::string project;
  Provenance from;
  std::vector<std::string> keys;  ///< of the project, that some variant changes
  std::vector<SweptVariant> variants;
  double compute_s = 0.0;

  bool limits_met() const;
};

struct SweepOptions {
  /// Keeps variants that an earlier sweep into the folder finished with the same files, values and program.
  bool resume = false;
};

/// Runs a project once for each variant (variants.hpp), into FOLDER/NAME, with NAME/variant.json next to its files, then
/// writes sweep.json and sweep.csv. The processes of `team` share the variants (one in turn each) over a common file
/// system; the leader's answer is complete, those of the others are empty. A design that cannot be made is a row of the
/// table. All variants are read before the first is run: a slip in one is an InputError before anything is written.
Sweep run_sweep(const std::filesystem::path& project, const std::filesystem::path& variants,
                const std::filesystem::path& folder, const SweepOptions& options, const Team& team);

/// sweep.json without its header, sweep.csv, and the table that is printed.
Json sweep_json(const Sweep& sweep);
std::string sweep_csv(const Sweep& sweep);
std::string sweep_summary(const Sweep& sweep);

std::string_view to_string(SweptVariant::Status status);

}  // namespace bodesmith::project
