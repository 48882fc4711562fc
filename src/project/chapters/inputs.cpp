#include "project/run.hpp"
#include "report/page.hpp"

namespace bodesmith::project {

void inputs_chapter(report::Page& page, const ProjectRun& run) {
  page.chapter("Inputs");
  report::Table table{{"input", "SHA-256"}, {}, {}};
  for (const InputFile& file : run.from.inputs) table.rows.push_back({file.path, file.sha256});
  page.table(table);
}

}  // namespace bodesmith::project
