#pragma once

#include <string>
#include <utility>
#include <variant>

#include "base/error.hpp"

namespace bodesmith {

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
