#pragma once

#include <memory>
#include <optional>
#include <string>

#include "base/files.hpp"
#include "base/json_fwd.hpp"
#include "cli/command_line.hpp"
#include "fpaa/plan/plan.hpp"

namespace bodesmith::cli {

/// --stream and --pin.
void add_stream_options(CommandLine& line);

struct StreamArtefacts {
  OutputSet files;                   ///< of the folder stream/
  std::shared_ptr<const Json> json;  ///< of plan.json
  std::string text;                  ///< of the summary: how to power on for the first time
};

/// Nothing without --stream. The plan learns which I/O cell is which pin. Throws DesignError when no stream can
/// be made of it.
std::optional<StreamArtefacts> make_streams(fpaa::Plan& plan, const CommandLine& line);

}  // namespace bodesmith::cli
