#pragma once

#include <complex>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/files.hpp"
#include "base/json_fwd.hpp"
#include "base/provenance.hpp"
#include "base/units.hpp"
#include "fpaa/plan/plan.hpp"
#include "signal/csv.hpp"

namespace bodesmith::project {

// Files that a run writes with and without a disturbance.

/// One of its JSON files: header, body, and how long the design took.
std::string artefact_json(std::string_view schema, const Provenance& from, const Json& body,
                          double compute_s);

/// bode.csv: a column of decibels and one of degrees for each response.
class ResponseTable {
 public:
  explicit ResponseTable(std::vector<Hertz> grid);
  void add(std::string name, const std::function<std::complex<double>(RadPerSecond)>& response);
  std::string text() const { return csv_.text(); }

 private:
  std::vector<Hertz> grid_;
  CsvWriter csv_;
};

/// Plan, picture and build sheets under fpaa/; `plan_json` is the plan as its file holds it.
void add_board_files(const fpaa::Plan& plan, std::string plan_json, OutputSet& out);

}  // namespace bodesmith::project
