#include "fpaa/plan/plan.hpp"
#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_plan_bytes(std::string_view bytes) {
  require_finite(fpaa::Plan::from_node(parse_json(bytes, "plan.json")).to_json());
}
const Registered plan_reader{"plan", read_plan_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
