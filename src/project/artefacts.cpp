#include "project/artefacts.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/json.hpp"
#include "base/json_header.hpp"
#include "fpaa/sheets/board_picture.hpp"
#include "fpaa/sheets/build_sheet.hpp"
#include "signal/columns.hpp"

namespace bodesmith::project {

std::string artefact_json(std::string_view schema, const Provenance& from, const Json& body,
                          double compute_s) {
  Json json = json_header(schema, from);
  json.update(body);
  json["timing_s"] = {{"compute", compute_s}};
  return to_text(json);
}

ResponseTable::ResponseTable(std::vector<Hertz> grid) : grid_(std::move(grid)) {
  std::vector<double> hertz;
  for (const Hertz f : grid_) hertz.push_back(f.value);
  csv_.add(column::frequency_hz, hertz);
}

void ResponseTable::add(std::string name, const std::function<std::complex<double>(RadPerSecond)>& response) {
  std::vector<double> db;
  std::vector<double> degrees;
  for (const Hertz f : grid_) {
    const std::complex<double> h = response(f.rad_s());
    db.push_back(to_decibel(std::abs(h)));
    degrees.push_back(to_degrees(std::arg(h)));
  }
  for (char& c : name) {
    if (c == ' ' || c == '-') c = '_';
  }
  csv_.add(fmt::format("{}_{}", name, column::magnitude_db), db);
  csv_.add(fmt::format("{}_{}", name, column::phase_deg), degrees);
}

void add_board_files(const fpaa::Plan& plan, std::string plan_json, OutputSet& out) {
  out.add("fpaa/plan.json", std::move(plan_json));
  out.add("fpaa/board.svg", fpaa::board_picture_svg(plan));
  out.add("fpaa/build_sheet.md", fpaa::build_sheet_markdown(plan));
  out.add("fpaa/build_sheet.html", fpaa::build_sheet_html(plan));
}

}  // namespace bodesmith::project
