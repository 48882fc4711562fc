#pragma once

#include <complex>
#include <filesystem>
#include <string>

namespace bodesmith::ngspice {

/// A user's deck made ready for a small-signal run: without its analyses, outputs and .control section, with
/// absolute paths in .include and .lib.
struct UserDeck {
  std::string text;             ///< without .end
  std::string node;             ///< where the response is taken
  std::complex<double> source;  ///< AC value of its one source
};

/// Throws InputError with file and line: no source or more than one with an AC value, no output node, an
/// unended .control.
UserDeck read_user_deck(const std::filesystem::path& path, const std::string& node);

}  // namespace bodesmith::ngspice
