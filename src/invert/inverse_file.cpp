#include "invert/inverse_file.hpp"

#include <fmt/format.h>

#include "base/document.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"

namespace bodesmith::invert {

InverseFile InverseFile::read(const std::filesystem::path& path, Provenance& from) {
  const Node node = read_document(path, from);
  node.expect_schema("inverse");
  node.allow_only(
      {"schema", "model", "start", "preview", "lower", "upper", "max_rate_per_s", "bandwidth_hz"});
  const Node file = node.at("model");
  const std::filesystem::path target = path.parent_path() / file.string();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(target, ignored))
    file.fail(fmt::format("names {}, which is not there", target.string()));
  InverseFile out{chain::read_model(target, from), {}};
  out.options.start = out.model.start.value_or(out.options.start);
  if (node.has("start"))
    out.options.start = one_of(node.at("start"), chain::Start::equilibrium, chain::Start::zero);
  out.options.preview = node.boolean_or("preview", true);
  if (node.has("lower")) out.options.limits.lower = node.at("lower").number();
  if (node.has("upper")) out.options.limits.upper = node.at("upper").number();
  if (out.options.limits.lower && out.options.limits.upper &&
      !(*out.options.limits.lower < *out.options.limits.upper))
    node.at("upper").fail("is not above lower");
  if (node.has("max_rate_per_s")) out.options.limits.max_rate_per_s = node.at("max_rate_per_s").positive();
  if (node.has("bandwidth_hz")) out.options.bandwidth = Hertz{node.at("bandwidth_hz").positive()};
  return out;
}

std::string InverseFile::text(const std::string& model, const Options& options) {
  std::string out = fmt::format(
      "# The inverse of a model, for any reference: feedforward of a controller.toml, or bodesmith compensate.\n"
      "schema = \"bodesmith.inverse/1\"\nmodel = \"{}\"\nstart = \"{}\"\npreview = {}\n",
      model, simulate::to_string(options.start), options.preview);
  const auto number = [&out](const char* key, const std::optional<double>& value) {
    if (value) out += fmt::format("{} = {}\n", key, number_text(*value));
  };
  number("lower", options.limits.lower);
  number("upper", options.limits.upper);
  number("max_rate_per_s", options.limits.max_rate_per_s);
  if (options.bandwidth) number("bandwidth_hz", options.bandwidth->value);
  return out;
}

}  // namespace bodesmith::invert
