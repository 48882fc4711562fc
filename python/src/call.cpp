#include "call.hpp"

#include "base/documents/json.hpp"
#include "base/error.hpp"

namespace bodesmith::python {

std::span<const double> Call::array(const std::string& name) const {
  const auto found = arrays.find(name);
  if (found == arrays.end()) throw InputError(name + " is missing");
  return found->second;
}

std::vector<double> Call::copy(const std::string& name) const {
  const auto values = array(name);
  return {values.begin(), values.end()};
}

std::optional<double> maybe_number(const Node& options, std::string_view key) {
  if (!options.has(key)) return std::nullopt;
  return options.at(key).number();
}

std::optional<double> maybe_positive(const Node& options, std::string_view key) {
  if (!options.has(key)) return std::nullopt;
  return options.at(key).positive();
}

double positive_or(const Node& options, std::string_view key, double default_value) {
  return maybe_positive(options, key).value_or(default_value);
}

int integer_or(const Node& options, std::string_view key, int default_value, int min, int max) {
  return options.has(key) ? static_cast<int>(options.at(key).integer(min, max)) : default_value;
}

std::uint64_t seed_of(const Node& options) {
  if (!options.has("seed")) return 1;
  return static_cast<std::uint64_t>(options.at("seed").integer(0, std::int64_t{1} << 53));
}

std::optional<Band> maybe_band(const Node& options, std::string_view key) {
  if (!options.has(key)) return std::nullopt;
  const Node node = options.at(key);
  if (node.size() != 2) node.fail("has not two frequencies, expected (from, to)");
  const Band band{Hertz{node[0].positive()}, Hertz{node[1].positive()}};
  if (!(band.from < band.to)) node.fail("does not rise, expected (from, to)");
  return band;
}

Json document(std::string_view schema, const Json& body, double seconds) {
  return timed_json(schema, {}, body, seconds);
}

}  // namespace bodesmith::python
