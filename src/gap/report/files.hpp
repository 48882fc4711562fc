#pragma once

#include <string>

#include "base/documents/json_fwd.hpp"
#include "base/files.hpp"
#include "base/provenance.hpp"
#include "gap/diagnosis.hpp"

namespace bodesmith::gap {

/// What was found, with the base model's [trained]: where it was fitted, and the errors that are left now.
chain::Chain found_model(const Diagnosis& diagnosis, const chain::Chain& base);

/// diagnosis.json, model.toml, base_refitted.toml, report.html and, where there is one, experiment.csv; returns diagnosis.json.
Json add_diagnosis_files(const Diagnosis& diagnosis, const Study& study, const chain::Chain& base,
                         const Provenance& from, OutputSet& files);

/// report.html.
std::string report_page(const Diagnosis& diagnosis, const Study& study);

/// diagnosis.json without its header.
Json to_json(const Diagnosis& diagnosis);

}  // namespace bodesmith::gap
