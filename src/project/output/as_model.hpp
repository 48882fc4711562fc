#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "chain/chain.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::project {

struct ModelRequest {
  /// At which a stage's rate gains are taken; none: the lowest of its table.
  std::optional<Hertz> operating;
  /// Share of the stroke that a stiff load leaves a stage (Disturbance::at_load).
  std::optional<double> load_stroke;
  bool used = false;  ///< some file was a disturbance, which asks for them
  /// How near a board's sections are to it, of every plan (plan_model.hpp).
  struct Board {
    Band band;
    double worst_percent = 0.0;
  };
  std::vector<Board> boards;
};

/// What was designed, built or identified as named blocks: sections, a cascade, a circuit as its parts make it, a board's chain
/// of CAMs, a disturbance, a model, or the model of a folder that `run` wrote. InputError for any other file.
chain::Chain as_model(const std::filesystem::path& path, ModelRequest& asked, Provenance& from);

}  // namespace bodesmith::project
