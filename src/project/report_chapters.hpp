#pragma once

#include "project/run.hpp"
#include "report/page.hpp"

/// The chapters of report.html behind the summary, in order. Each is a function in a file of its own in
/// project/chapters/; one that has nothing to show (no board, no circuit) adds nothing.
#define BODESMITH_REPORT_CHAPTERS(CHAPTER) \
  CHAPTER(target_chapter)                  \
  CHAPTER(fit_chapter)                     \
  CHAPTER(sections_chapter)                \
  CHAPTER(budget_chapter)                  \
  CHAPTER(tracking_chapter)                \
  CHAPTER(fpaa_chapter)                    \
  CHAPTER(circuit_chapter)                 \
  CHAPTER(layout_chapter)                  \
  CHAPTER(inputs_chapter)

namespace bodesmith::project {

#define BODESMITH_DECLARE_CHAPTER(name) void name(report::Page& page, const ProjectRun& run);
BODESMITH_REPORT_CHAPTERS(BODESMITH_DECLARE_CHAPTER)
#undef BODESMITH_DECLARE_CHAPTER

}  // namespace bodesmith::project
