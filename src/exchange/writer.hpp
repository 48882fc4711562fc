#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/registry.hpp"
#include "exchange/discretise.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"
#include "lti/state_space.hpp"
#include "schematic/netlist.hpp"
#include "signal/bode_points.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::exchange {

/// A linear block of a model, y = c x + d u of x' = A x + b u, then delayed.
struct ChainBlock {
  std::string name;
  StateSpace system;
  double delay_s = 0.0;
};

/// What can be written for other programs: whatever the source has of these.
struct Exportable {
  std::string source;  ///< the file, as messages and comments name it
  std::string name;    ///< of variables and functions: letters, digits and underscores
  std::optional<Sections> sections;
  std::vector<ChainBlock> chain;              ///< of a linear model, or of a board as one
  std::optional<schematic::Netlist> circuit;  ///< of a circuit.json, driven at node "in"
  Band circuit_band;                          ///< to be looked at
  std::optional<FrequencyRecord> response;
  std::optional<TimeRecord> record;
};

struct ExportOptions {
  DiscretiseOptions discretise;
  int bits = 18;               ///< of a fixed-point coefficient
  int multipliers = 1;         ///< of an FPGA,
  double clock_hz = 40e6;      ///< each a product a clock
  bool output_signal = false;  ///< of a record where one signal is written: y instead of u
};

struct Written {
  std::string content;
  std::vector<std::string> said;  ///< conventions, errors, what was left out
};

/// One format that other programs read.
class Writer {
 public:
  /// Endings of file names, with their points: ".s2p .ts".
  Writer(std::string_view name, std::string_view endings, std::string_view what)
      : name_(name), endings_(endings), what_(what) {}
  virtual ~Writer() = default;
  std::string_view name() const { return name_; }
  std::string_view endings() const { return endings_; }
  std::string_view what() const { return what_; }
  /// Whether Exportable::chain is of use to it.
  virtual bool rebuilds_chains() const { return false; }
  /// InputError when the source lacks what the format holds.
  virtual Written write(const Exportable& from, const ExportOptions& options) const = 0;

 private:
  std::string_view name_, endings_, what_;
};

Registry<Writer>& writers();
/// By the ending of a file name; InputError that lists them.
const Writer& writer_for(std::string_view file_name);

/// The part of the source that a writer needs, or an InputError that says what the format is of.
const Sections& need_sections(const Exportable& from, const Writer& writer);
const schematic::Netlist& need_circuit(const Exportable& from, const Writer& writer);
const FrequencyRecord& need_response(const Exportable& from, const Writer& writer);
const TimeRecord& need_record(const Exportable& from, const Writer& writer);

/// Letters, digits and underscores of a text; begins with a letter.
std::string identifier(std::string_view text);

}  // namespace bodesmith::exchange
