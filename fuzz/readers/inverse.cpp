#include "invert/compensation.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

/// The model that it names stands beside it.
void read_inverse_bytes(std::string_view bytes) {
  static const std::filesystem::path model =
      as_file("schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 2.0\n", "model.toml");
  Provenance from;
  const auto inverse = invert::InverseFile::read(as_file(bytes, "inverse.toml"), from);
  const auto& limits = inverse.options.limits;
  for (const auto& value : {limits.lower, limits.upper, limits.max_rate_per_s})
    require_finite(value.value_or(0.0));
  if (inverse.options.bandwidth) require_finite(inverse.options.bandwidth->value);
}
const Registered inverse_reader{"inverse", read_inverse_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
