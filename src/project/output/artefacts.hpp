#pragma once

#include <string>
#include <string_view>

#include "base/documents/json_fwd.hpp"
#include "base/files.hpp"
#include "base/provenance.hpp"
#include "fpaa/plan/plan.hpp"

namespace bodesmith::project {

// Files that a run writes with and without a disturbance.

/// One of its JSON files: header, body, and how long the design took.
std::string artefact_json(std::string_view schema, const Provenance& from, const Json& body,
                          double compute_s);

/// Plan, picture and build sheets under fpaa/; `plan_json` is the plan as its file holds it.
void add_board_files(const fpaa::Plan& plan, std::string plan_json, OutputSet& out);

}  // namespace bodesmith::project
