#include "base/error.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {

int run_approximate(const std::vector<std::string>&) { throw InputError("approximate is not built yet"); }

}  // namespace bodesmith::cli
