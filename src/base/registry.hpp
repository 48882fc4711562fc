#pragma once

#include <boost/preprocessor/seq/for_each.hpp>
#include <boost/preprocessor/variadic/to_seq.hpp>

#include <algorithm>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith {

/// The known kinds of one thing (blocks, hysteresis models, effects, CAMs, approximation methods, SPICE dialects), in
/// the order of the documentation. Each kind is an object of a class derived from T in a file of its own, with
/// `name()`; the table in its room's registry.cpp has one line for it, which is the only other place that knows it.
/// add() registers one from outside (a program that uses the library, a test). Entries are not owned: they live as
/// long as the program. Not thread-safe: register before threads start.
template <class T>
class Registry {
 public:
  /// `kind` stands in messages: "effect", "block type", …
  Registry(std::string kind, std::initializer_list<const T*> entries)
      : kind_(std::move(kind)), entries_(entries) {}

  const std::vector<const T*>& all() const { return entries_; }

  /// Null when there is none of that name.
  const T* find(std::string_view name) const {
    const auto found = std::ranges::find_if(entries_, [&](const T* entry) { return entry->name() == name; });
    return found == entries_.end() ? nullptr : *found;
  }

  /// Throws InputError that lists the names there are.
  const T& get(std::string_view name) const {
    if (const T* found = find(name)) return *found;
    throw InputError("there is no " + kind_ + " '" + std::string(name) + "'" +
                     did_you_mean(name, name_list()) + ", expected one of " + names());
  }

  std::vector<std::string> name_list() const {
    std::vector<std::string> out;
    for (const T* entry : entries_) out.emplace_back(entry->name());
    return out;
  }

  /// "a, b, c".
  std::string names() const { return join(name_list(), ", "); }

  /// Throws std::logic_error when the name is taken.
  void add(const T& entry) {
    if (find(entry.name()) != nullptr) {
      throw std::logic_error(kind_ + " '" + std::string(entry.name()) + "' is registered twice");
    }
    entries_.push_back(&entry);
  }

 private:
  std::string kind_;
  std::vector<const T*> entries_;
};

}  // namespace bodesmith

/// Defines `const T& entry()`: the one object of the class that a registry's table names.
#define BODESMITH_ENTRY(T, entry, Class) \
  const T& entry() {                     \
    static const Class one;              \
    return one;                          \
  }

#define BODESMITH_DECLARE_ENTRY(r, T, entry) const T& entry();
#define BODESMITH_ENTRY_ADDRESS(r, T, entry) &entry(),

/// Defines `Registry<T>& registry()`. Its table: a name an entry, whose function stands in a file of its own.
#define BODESMITH_REGISTRY(T, registry, kind, ...)                                                         \
  BOOST_PP_SEQ_FOR_EACH(BODESMITH_DECLARE_ENTRY, T, BOOST_PP_VARIADIC_TO_SEQ(__VA_ARGS__))                 \
  Registry<T>& registry() {                                                                                \
    static Registry<T> all(                                                                                \
        kind, {BOOST_PP_SEQ_FOR_EACH(BODESMITH_ENTRY_ADDRESS, T, BOOST_PP_VARIADIC_TO_SEQ(__VA_ARGS__))}); \
    return all;                                                                                            \
  }
