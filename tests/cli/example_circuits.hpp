#pragma once

#include <string>
#include <vector>

#include "run_program.hpp"

namespace bodesmith {

/// How the sections of every example that a circuit can be made of come about, in the words of its README.
struct ExampleCircuit {
  std::string name;
  std::string command;  ///< without -o
  std::string limits;   ///< what `spice` has to be told beside it
};

inline std::vector<ExampleCircuit> example_circuits() {
  const std::string examples = std::string(BODESMITH_SOURCE_DIR) + "/examples/";
  return {
      {"nanopositioner", "fit " + examples + "nanopositioner/gains.csv --direct --order 4 --real", ""},
      {"riaa", "fit " + examples + "riaa/points.csv --direct --max-error-db 0.001", ""},
      {"a_weighting", "fit " + examples + "a_weighting/points.csv --direct --order 4", ""},
      {"pink_noise", "fit " + examples + "pink_noise/points.csv --direct --order 6", ""},
      {"constant_phase_element", "approximate " + examples + "constant_phase_element/cascade.json --order 6",
       ""},
      {"element",
       "approximate " + examples + "constant_phase_element/element.toml --from-hz 1 --to-hz 10000 --order 6",
       " --max-ohm 1e7"},
      {"fractional_pid",
       "approximate " + examples + "fractional_pid/pid.toml --from-hz 0.1 --to-hz 1000 --order 6",
       " --max-ohm 1e7 --max-f 4.7e-6"},
  };
}

/// sections.json of an example in `folder`; its path.
inline std::string example_sections(const ExampleCircuit& example, const TemporaryFolder& folder) {
  const std::string path = (folder / (example.name + ".json")).string();
  const ProgramResult run = run_bodesmith(example.command + " -o " + path);
  if (run.status != 0) throw std::runtime_error(example.name + ": " + run.err);
  return path;
}

}  // namespace bodesmith
