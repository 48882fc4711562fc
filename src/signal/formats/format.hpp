#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/registry.hpp"
#include "signal/formats/text_encoding.hpp"

namespace bodesmith::formats {

/// The bytes of a file, what the user chose in it (FILE:CHOICE), and what is wanted.
struct Source {
  std::string file;  ///< as messages name it
  std::string_view bytes;
  std::string_view text;  ///< the same as UTF-8 without byte order mark
  std::string choice;     ///< "s11", "v(out)", "v(in),v(out)", "gain", …; empty: the format's own default
  Content wanted = Content::any;
  std::optional<double> sample_hz;  ///< of records without times, as the user says
};

/// A foreign file in this program's columns: `frequency_hz,magnitude_db[,phase_deg]` or `time_s,u[,y]`.
struct Foreign {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  std::vector<int> lines;  ///< of each row; empty for binary files
  std::string read_as;     ///< the format, what was chosen in it, what was converted
};

/// One format of a vendor's or program's files. `recognises` looks at the content alone, never at a name, and throws
/// nothing; `read` throws InputError that names line or byte of what is broken.
class Format {
 public:
  virtual ~Format() = default;
  virtual std::string_view name() const = 0;
  virtual bool recognises(const Source& source) const = 0;
  virtual Foreign read(const Source& source) const = 0;
};

/// In the order in which they are asked: the sharpest marks first, a bare table of numbers last.
Registry<Format>& formats();
/// The first that recognises the source; null when none does.
const Format* format_of(const Source& source);

}  // namespace bodesmith::formats
