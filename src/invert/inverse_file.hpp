#pragma once

#include <filesystem>
#include <string>

#include "base/provenance.hpp"
#include "chain/chain.hpp"
#include "invert/compensation.hpp"

namespace bodesmith::invert {

/// inverse.toml (`bodesmith.inverse/1`): a model to invert and how, for any reference that comes.
///   schema = "bodesmith.inverse/1"
///   model = "model.toml"     # relative to this file
///   start = "equilibrium"    # or "zero"; absent: as the model says, equilibrium where it does not
///   preview = true           # delays are made good by looking ahead
///   lower = 0.0              # limits of the drive; absent: none
///   upper = 1.2
///   max_rate_per_s = 500.0
///   bandwidth_hz = 1e3
struct InverseFile {
  chain::Chain model;
  Options options;

  /// Errors name file and line.
  static InverseFile read(const std::filesystem::path& path, Provenance& from);
  /// Its text; `model` as it is to stand there.
  static std::string text(const std::string& model, const Options& options);
};

}  // namespace bodesmith::invert
