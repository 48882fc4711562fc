#pragma once

#include <vector>

#include "synthesis/generator/layout.hpp"

/// The steps of make_layout(), for its own files only.
namespace bodesmith::generator {

constexpr std::size_t kMostBranches = 64;

/// Powers, sums, chains, gains, output amplifier and slope detector for this group size.
Layout build(const Input& input, const Options& options, int group);
void add_nodes(Layout& layout);
/// Every group size from 1 to the degree; marks the one to build.
std::vector<Candidate> compare_schemes(const Input& input, const Options& options);

}  // namespace bodesmith::generator
