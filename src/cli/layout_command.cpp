#include "base/error.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {

int run_layout(const std::vector<std::string>&) { throw InputError("layout is not built yet"); }

}  // namespace bodesmith::cli
