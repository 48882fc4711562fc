#include "project/project.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

/// The files that it names are not there: all that stands before them is read.
void read_project_bytes(std::string_view bytes) {
  as_file("frequency_hz,gain\n1,1\n10,1.06\n20,1.1\n", "gains.csv");
  as_file(
      R"({"schema":"bodesmith.disturbance/1","ascending":[0.35,-0.64,0.29],"descending":[-0.24,0.08,0.16]})",
      "disturbance.json");
  Provenance from;
  project::Project::read(as_file(bytes, "project.toml"), from);
}
const Registered project_reader{"project", read_project_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
