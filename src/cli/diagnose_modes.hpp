#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gap/search_options.hpp"

namespace bodesmith::cli {

// `bodesmith diagnose` has three modes: a model and records (diagnose_command.cpp), a built board (--circuit, --plan) and
// the course of hidden effects (--course).

int run_diagnose_board(const std::vector<std::string>& arguments);
int run_diagnose_course(const std::vector<std::string>& arguments);

/// Diagnoses one record with one held out into a folder, as `diagnose` does.
void diagnose_into(const std::filesystem::path& folder, const std::filesystem::path& model,
                   const std::filesystem::path& data, const std::filesystem::path& holdout,
                   const gap::SearchOptions& options);

}  // namespace bodesmith::cli
