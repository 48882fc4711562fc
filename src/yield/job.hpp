#pragma once

#include <string>

#include "base/provenance.hpp"
#include "yield/yield.hpp"

namespace bodesmith::yield {

/// Everything that the counts depend on besides samples and seed: identifies a checkpoint (Options::job).
std::string job_text(const Options& options, const Provenance& from);

}  // namespace bodesmith::yield
