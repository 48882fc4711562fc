#include "base/error.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {

int run_spice(const std::vector<std::string>&) { throw InputError("spice is not built yet"); }

}  // namespace bodesmith::cli
