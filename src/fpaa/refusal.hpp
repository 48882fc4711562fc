#pragma once

#include <string>
#include <utility>
#include <variant>

#include "base/error.hpp"

namespace bodesmith::fpaa {

/// Why a design cannot be made, and what would make it fit.
struct Refusal {
  std::string reason;
};

/// A design, or why there is none. Inside the library a design that cannot be made is a value like any other
/// (a search tries the next one); or_throw() is for the edge, where a person is told.
template <class T>
using Outcome = std::variant<T, Refusal>;

template <class T>
const Refusal* refusal_of(const Outcome<T>& outcome) {
  return std::get_if<Refusal>(&outcome);
}

/// The design, or DesignError with the reason.
template <class T>
T or_throw(Outcome<T> outcome) {
  if (const Refusal* refusal = refusal_of(outcome)) throw DesignError(refusal->reason);
  return std::get<T>(std::move(outcome));
}

}  // namespace bodesmith::fpaa
