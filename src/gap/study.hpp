#pragma once

#include <filesystem>
#include <vector>

#include "base/provenance.hpp"
#include "chain/chain.hpp"
#include "gap/records/experiment.hpp"

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
  static Study of(std::vector<FrequencyRecord> data, std::vector<FrequencyRecord> holdout,
                  const chain::Chain& base);

  const Experiments& train() const { return train_; }
  const Experiments& holdout() const { return holdout_; }
  bool frequency_responses() const;
  /// There are responses among them whose points are weighted by their coherence.
  bool weighted() const;
  /// Nothing was held out, so a part of each training record is.
  bool split() const { return split_; }
  /// Of all time records (TimeExperiment::set_holds).
  void set_holds(std::size_t holds);

 private:
  Experiments train_;
  Experiments holdout_;
  bool split_ = false;
};

}  // namespace bodesmith::gap
