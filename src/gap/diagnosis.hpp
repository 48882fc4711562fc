#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/provenance.hpp"
#include "chain/chain.hpp"
#include "gap/experiment.hpp"
#include "gap/search.hpp"
#include "gap/verdict.hpp"
#include "gap/where.hpp"

namespace bodesmith::gap {

/// Measured records, some to fit and some held out, and how far into each the start transient may reach.
class Study {
 public:
  /// Time records and frequency responses (told by their columns); not both kinds at once. Without held-out
  /// files the last 30 % of each training record (every second frequency) is held out. InputErrors name the
  /// file.
  static Study read(const std::vector<std::filesystem::path>& data,
                    const std::vector<std::filesystem::path>& holdout, const chain::Chain& base,
                    Provenance& from);
  static Study of(std::vector<TimeRecord> data, std::vector<TimeRecord> holdout, const chain::Chain& base);

  const Experiments& train() const { return train_; }
  const Experiments& holdout() const { return holdout_; }
  bool frequency_responses() const { return frequency_; }
  bool split() const { return split_; }

 private:
  void add(std::unique_ptr<Experiment> experiment, bool held_out);
  std::vector<std::unique_ptr<Experiment>> owned_;
  Experiments train_;
  Experiments holdout_;
  bool frequency_ = false;
  bool split_ = false;
};

/// The sizes of a gap. Every figure is what `simulate` finds with the model.toml of that stage.
struct GapSize {
  double train_rms = 0.0;
  double holdout_rms = 0.0;
  double holdout_percent_of_range = 0.0;
  double train_whole_rms = 0.0;  ///< from the first sample on, start transients included
  double holdout_whole_rms = 0.0;
};

struct DiagnosedStep {
  std::string effect;
  std::vector<std::string> tied_with;
  std::vector<std::string> also_fit;
  std::string placed;
  std::vector<std::string> also_placed;
  struct Parameter {
    std::string name;
    double value = 0.0;
    double low = 0.0;
    double high = 0.0;
  };
  std::vector<Parameter> parameters;
  GapSize before;
  GapSize after;
  std::string runner_up;
  double runner_up_holdout_rms = 0.0;
  std::string runner_up_word;
  double significance = 0.0;
  double control_gain = 0.0;
};

struct ScoredFrom {
  std::string file;
  bool held_out = false;
  double from_s = 0.0;
};

struct Diagnosis {
  NoiseFloor floor;
  GapSize initial;   ///< the model as given
  GapSize refitted;  ///< its free parameters refitted
  GapSize final;
  std::vector<Cell> where;
  std::vector<Cell> remaining_where;
  std::vector<DiagnosedStep> steps;
  Verdict verdict = Verdict::unexplained;
  std::string advice;
  std::vector<ScoredFrom> scored_from;
  bool relative = false;  ///< frequency responses: rms of |H_model/H_measured − 1| parts, no unit
  SearchResult search;
  double compute_s = 0.0;
};

Diagnosis diagnose(const chain::Chain& base, const Study& study, const SearchOptions& options);

/// diagnosis.json without its header.
Json to_json(const Diagnosis& diagnosis);

/// report.html.
std::string report_page(const Diagnosis& diagnosis, const Study& study);

}  // namespace bodesmith::gap
