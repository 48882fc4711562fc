#include "project/filter_project.hpp"
#include "project/source.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_filter_bytes(std::string_view bytes) {
  as_file("frequency_hz,gain\n1,1\n10,1.06\n20,1.1\n", "gains.csv");
  auto source = project::ProjectSource::read(as_file(bytes, "filter.toml"));
  const auto project = project::FilterProject::from_document(source.document, source.file, source.from);
  require_finite(project.band.from.value + project.band.to.value);
}
const Registered filter_reader{"filter_project", read_filter_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
