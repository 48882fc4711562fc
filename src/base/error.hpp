#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace bodesmith {

/// What a person gave is wrong: a file, a value, an option. The program prints what() as one line
/// `FILE:LINE: what is wrong, what was expected` and exits with 2. Numerical outcomes (limit reached,
/// ill-conditioned) are never exceptions; they are fields of a report.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message);
  /// `line` counts from 1; 0 means that no single line is to blame.
  InputError(std::string_view file, int line, std::string_view message);

  /// The file to blame, as what() begins with it; empty where none is.
  const std::string& file() const { return file_; }
  int line() const { return line_; }

 private:
  std::string file_;
  int line_ = 0;
};

/// A design that cannot be made or does not fit (too many sections for the board, no legal clock).
/// Says what would make it fit. Exit status 2, as for bad input.
class DesignError : public InputError {
 public:
  using InputError::InputError;
};

/// Thrown at a safe point after the user pressed Ctrl-C; what was finished until then is kept.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// Why a design cannot be made, and what could be asked for instead; one line for a person.
struct Refusal {
  std::string reason;
};

/// A design, or why there is none. Inside the library a design that cannot be made is a value like any other
/// (a search tries the next one).
template <class T>
using Outcome = std::variant<T, Refusal>;

template <class T>
const Refusal* refusal_of(const Outcome<T>& outcome) {
  return std::get_if<Refusal>(&outcome);
}

/// For the edge of the library: a refusal becomes a DesignError.
template <class T>
T value_or_throw(Outcome<T> outcome) {
  if (const Refusal* refusal = refusal_of(outcome)) throw DesignError(refusal->reason);
  return std::get<T>(std::move(outcome));
}

}  // namespace bodesmith
