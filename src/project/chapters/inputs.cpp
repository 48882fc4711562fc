#include "project/report_tables.hpp"
#include "project/run.hpp"
#include "report/page.hpp"

namespace bodesmith::project {

void inputs_chapter(report::Page& page, const ProjectRun& run) {
  page.chapter("Inputs");
  page.table(inputs_table(run.from));
}

}  // namespace bodesmith::project
