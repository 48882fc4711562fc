#include "base/error.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {

int run_diagnose(const std::vector<std::string>&) { throw InputError("diagnose is not built yet"); }

}  // namespace bodesmith::cli
