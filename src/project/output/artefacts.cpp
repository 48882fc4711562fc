#include "project/output/artefacts.hpp"

#include <utility>

#include "base/documents/json.hpp"
#include "fpaa/sheets/board_picture.hpp"
#include "fpaa/sheets/build_sheet.hpp"

namespace bodesmith::project {

std::string artefact_json(std::string_view schema, const Provenance& from, const Json& body,
                          double compute_s) {
  return to_text(timed_json(schema, from, body, compute_s));
}

void add_board_files(const fpaa::Plan& plan, std::string plan_json, OutputSet& out) {
  out.add("fpaa/plan.json", std::move(plan_json));
  out.add("fpaa/board.svg", fpaa::board_picture_svg(plan));
  out.add("fpaa/build_sheet.md", fpaa::build_sheet_markdown(plan));
  out.add("fpaa/build_sheet.html", fpaa::build_sheet_html(plan));
}

}  // namespace bodesmith::project
