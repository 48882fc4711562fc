#include "base/error.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {

int run_simulate(const std::vector<std::string>&) { throw InputError("simulate is not built yet"); }

}  // namespace bodesmith::cli
