#pragma once

#include <complex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "signal/formats/format.hpp"

namespace bodesmith::formats {

/// A response over the frequencies of its file; `phase_deg` and `coherence` (gamma squared) empty where the file has
/// none.
struct ResponseTrace {
  std::string name;
  std::vector<double> magnitude_db;
  std::vector<double> phase_deg;
  std::vector<double> coherence;
};
ResponseTrace to_trace(std::string name, const std::vector<std::complex<double>>& response);

/// A signal over the times of its file.
struct SignalTrace {
  std::string name;
  std::vector<double> values;
};

/// What is said of a file besides its columns.
struct Words {
  std::string format;
  std::vector<std::string> notes;
  std::string text() const;
};

/// `frequency_hz,magnitude_db[,phase_deg][,coherence]`. Rows at 0 Hz and rows without magnitude are left out, a falling sweep is
/// turned round; both are said. InputError for frequencies below 0 and for what is not finite.
Foreign response_columns(const Source& source, Words words, std::vector<double> frequency_hz,
                         ResponseTrace trace, std::vector<int> lines);

enum class Steps { as_they_are, made_even };
/// `time_s,u[,y]` of one or two signals. Simulators choose their own steps: with Steps::made_even uneven ones become
/// even by linear interpolation, finely enough to stay within 0.1 % of range where memory allows; the largest
/// departure is said.
Foreign record_columns(const Source& source, Words words, std::vector<double> time_s,
                       std::vector<SignalTrace> signals, std::vector<int> lines, Steps steps);

/// Which of the names is meant: the same but for case and blanks, or within V(…), or the only one that contains it.
/// Nothing when none or several are, also where two have the very same name.
std::optional<std::size_t> find_name(const std::vector<std::string>& names, std::string_view wanted);
/// The same; InputError that lists the names.
std::size_t require_name(const Source& source, const std::vector<std::string>& names,
                         std::string_view wanted);

/// "a", "a/b" or "a,b" of the user's choice, by the first '/' or ',' outside brackets.
struct Choice {
  std::string first;
  std::string second;
  char between = 0;  ///< '/', ',' or 0
};
Choice split_choice(std::string_view choice);

/// Complex responses by name: the chosen one or quotient; without a choice the only one, or the one called out.
ResponseTrace choose_response(const Source& source, const std::vector<std::string>& names,
                              const std::vector<std::vector<std::complex<double>>>& values);
/// Input and output by name, as places among the names: the chosen ones; without a choice all when there are at most
/// two, else those called in and out.
std::vector<std::size_t> choose_signals(const Source& source, const std::vector<std::string>& names);
std::vector<SignalTrace> choose_signals(const Source& source, std::vector<SignalTrace> signals);

}  // namespace bodesmith::formats
