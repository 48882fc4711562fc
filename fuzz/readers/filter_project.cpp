#include "project/project.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_filter_bytes(std::string_view bytes) {
  as_file("frequency_hz,gain\n1,1\n10,1.06\n20,1.1\n", "gains.csv");
  Provenance from;
  const auto project = project::ProjectSource::read(as_file(bytes, "filter.toml")).project(from);
  require_finite(project.target.band.from.value + project.target.band.to.value);
}
const Registered filter_reader{"filter_project", read_filter_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
