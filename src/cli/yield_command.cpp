#include "base/error.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {

int run_yield(const std::vector<std::string>&) { throw InputError("yield is not built yet"); }

}  // namespace bodesmith::cli
