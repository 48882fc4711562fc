#pragma once

#include <string>
#include <vector>

namespace bodesmith::cli {

/// `--version`: one line; with --json how the program was built: compiler, flags, options, versions of the libraries, commit.
int print_version(const std::vector<std::string>& arguments);

}  // namespace bodesmith::cli
