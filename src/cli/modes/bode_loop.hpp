#pragma once

#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "base/files.hpp"
#include "cli/command_line.hpp"
#include "cli/response_source.hpp"

namespace bodesmith::cli {

/// A response of `bode` with its columns on the grid.
struct BodeResponse {
  const ResponseSource& source;
  const LevelAndPhase& columns;
};

struct ExtraColumn {
  std::string name;
  std::vector<double> values;  ///< one a frequency, NaN: none
};

/// --series, --margins, --group-delay, --nyquist, --nichols, their pictures and --time-response.
void add_loop_options(CommandLine& line);

/// All of them one after the other.
ResponseSource series_of(const std::vector<ResponseSource>& sources);

/// Columns that were asked for in addition to magnitude and phase.
std::vector<ExtraColumn> extra_columns(const CommandLine& line, const std::vector<Hertz>& grid,
                                       const BodeResponse& response);

/// With --margins: what they are, as text and into `summary`.
std::string margins_text(const CommandLine& line, const std::vector<Hertz>& grid,
                         const BodeResponse& response, Json& summary);

/// Pictures and time responses that were asked for.
void add_loop_files(const CommandLine& line, const std::vector<BodeResponse>& responses, OutputSet& out);

}  // namespace bodesmith::cli
