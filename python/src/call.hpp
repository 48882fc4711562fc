#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "lti/frequency_grid.hpp"

/// What Python calls: one function a command, numbers in and out as they lie in numpy's arrays, everything else as one
/// JSON document. No file of this folder but module.cpp knows Python.
namespace bodesmith::python {

/// The name that values from Python have in error messages; module.cpp takes it off again.
inline constexpr const char* kNoFile = "<python>";

struct Call {
  Node options;  ///< an object
  /// Python's own memory, which stays as it is during the call.
  std::map<std::string, std::span<const double>, std::less<>> arrays;

  bool has_array(std::string_view name) const { return arrays.find(name) != arrays.end(); }
  /// Throws InputError when it was not given.
  std::span<const double> array(const std::string& name) const;
  std::vector<double> copy(const std::string& name) const;
};

struct Answer {
  Json result = Json::object();
  std::map<std::string, std::vector<double>> arrays;  ///< handed over without copying
  std::map<std::string, std::string> files;           ///< what the command writes alongside its main file
  std::vector<std::string> warnings;
};

struct Function {
  std::string_view name;
  Answer (*run)(const Call&);
};

// Small readers of options; errors name the option.
std::optional<double> maybe_number(const Node& options, std::string_view key);
std::optional<double> maybe_positive(const Node& options, std::string_view key);
double positive_or(const Node& options, std::string_view key, double default_value);
int integer_or(const Node& options, std::string_view key, int default_value, int min, int max);
std::uint64_t seed_of(const Node& options);
/// band_hz = [from, to], rising and above 0.
std::optional<Band> maybe_band(const Node& options, std::string_view key = "band_hz");

/// The enumerator whose to_string() is the option's word.
template <class Enum>
Enum choice(const Node& options, std::string_view key, std::initializer_list<Enum> all) {
  if (!options.has(key)) return *all.begin();
  const std::string word = options.at(key).string();
  std::string words;
  for (const Enum one : all) {
    const std::string name(to_string(one));
    if (name == word) return one;
    words += (words.empty() ? "" : ", ") + name;
  }
  options.at(key).fail("is '" + word + "', expected one of " + words);
}

/// A document as the program writes it: header, body, time.
Json document(std::string_view schema, const Json& body, double seconds);

}  // namespace bodesmith::python
