#include "base/error.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {

int run_run(const std::vector<std::string>&) { throw InputError("run is not built yet"); }

}  // namespace bodesmith::cli
