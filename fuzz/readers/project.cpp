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
  const auto project = project::ProjectSource::read(as_file(bytes, "project.toml")).project(from);
  if (!project.plant) return;
  require_finite(project.target.base.value + project.plant->stroke_m + project.plant->damping_ratio);
  for (const double amplitude : project.track.amplitudes) require_finite(amplitude);
  for (const Hertz f : project.track.frequency) require_finite(f.value);
  if (const auto& damping = project.plant->damping_compensator) {
    for (const auto& zero : damping->zeros) require_finite(zero.real() + zero.imag());
    for (const auto& pole : damping->poles) require_finite(pole.real() + pole.imag());
  }
}
const Registered project_reader{"project", read_project_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
