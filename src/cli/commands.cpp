#include "cli/commands.hpp"

namespace bodesmith::cli {

int run_run(const std::vector<std::string>& arguments);
int run_fit(const std::vector<std::string>& arguments);
int run_approximate(const std::vector<std::string>& arguments);
int run_fpaa(const std::vector<std::string>& arguments);
int run_spice(const std::vector<std::string>& arguments);
int run_layout(const std::vector<std::string>& arguments);
int run_bode(const std::vector<std::string>& arguments);
int run_simulate(const std::vector<std::string>& arguments);
int run_identify(const std::vector<std::string>& arguments);
int run_compensate(const std::vector<std::string>& arguments);
int run_diagnose(const std::vector<std::string>& arguments);
int run_yield(const std::vector<std::string>& arguments);

const std::vector<Command>& commands() {
  static const std::vector<Command> all = {
      {"run", "the whole way: a project file to checked hardware and a report", run_run},
      {"fit", "Bode points to a fractional cascade, or straight to sections", run_fit},
      {"approximate", "a fractional cascade to integer pole-zero sections", run_approximate},
      {"fpaa", "sections to FPAA filter blocks on a board", run_fpaa},
      {"spice", "sections to op-amp circuits, netlists and parts", run_spice},
      {"layout", "a disturbance generator to multipliers and a switch", run_layout},
      {"bode", "frequency responses of any of the files, in one table", run_bode},
      {"simulate", "a model's output for an input record", run_simulate},
      {"identify", "measured records to a model", run_identify},
      {"compensate", "a model's inverse: the drive for a wanted output", run_compensate},
      {"diagnose", "names what a model is missing", run_diagnose},
      {"yield", "tolerance and mismatch statistics of a realised design", run_yield},
  };
  return all;
}

}  // namespace bodesmith::cli
