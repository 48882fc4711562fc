// run: a project file to everything.
#include "project/run.hpp"

#include "base/documents/json.hpp"
#include "functions.hpp"

namespace bodesmith::python {

Answer run_project(const Call& call) {
  const auto run = project::run_project(project::ProjectSource::read(call.options.at("path").string()),
                                        call.options.at("folder").string());
  Answer out;
  out.result = json_header("run", run.from);
  out.result.update(run.json());
  out.result["limits_met"] = run.limits_met();
  return out;
}

}  // namespace bodesmith::python
