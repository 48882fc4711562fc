#include "project/sweep/variants.hpp"

#include <algorithm>
#include <stdexcept>

#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

constexpr const char* kProject = R"(schema = "bodesmith.project/1"
name = "a curve"
[target]
points = "curve.csv"
[fit]
max_error_db = 0.5
[hardware.circuit]
resistors = "E96"
[hardware.fpaa]
board = "an231k04-quad4"
[tolerances]
capacitor_percent = 5
[limits]
points_db = 0.5
fpaa_percent = 20
)";

/// Designs that the table makes of a project are put together: the first fifty.
void read_variants_bytes(std::string_view bytes) {
  static const project::ProjectSource base =
      project::ProjectSource::read(as_file(kProject, "varied_project.toml"));
  Provenance from;
  const auto variants = project::read_variants(as_file(bytes, "variants.toml"), from);
  for (std::size_t i = 0; i < std::min<std::size_t>(variants.size(), 50); ++i) {
    const project::Variant& variant = variants[i];
    if (variant.name.empty() || variant.name.find('/') != std::string::npos)
      throw std::logic_error("a variant's name is no folder's");
    project::with_variant(base, variant);
  }
}
const Registered variants_reader{"variants", read_variants_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
