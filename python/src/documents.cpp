// Files of the contract: read and checked by the program's own readers, written whole or not at all.
#include "approximate/approximate.hpp"
#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "filters/family.hpp"
#include "fpaa/plan/plan.hpp"
#include "functions.hpp"
#include "hysteresis/model_type.hpp"
#include "lti/cascade.hpp"
#include "records.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::python {
namespace {

/// Throws at the file and line that its reader does not accept. A model answers its text: TOML has one form of it.
void check(const Node& node, const std::string& schema, Answer& out) {
  node.expect_schema(schema);
  if (schema == "cascade") {
    Cascade::from_node(node);
  } else if (schema == "sections") {
    Sections::from_node(node);
  } else if (schema == "disturbance") {
    // With branches of its own the file has another shape, which layout reads.
    if (!node.has("branches")) Disturbance::from_node(node);
  } else if (schema == "fpaa_plan") {
    fpaa::Plan::from_node(node);
  } else if (schema == "model") {
    out.result["text"] = chain::model_text(chain::model_from_node(node));
  }
}

Json inputs_json(const Provenance& from) {
  return json_header("none", from)["inputs"];
}

std::vector<double> hertz(const std::vector<Hertz>& all) {
  std::vector<double> out;
  for (const Hertz f : all) out.push_back(f.value);
  return out;
}

}  // namespace

Answer read_document_file(const Call& call) {
  Answer out;
  Provenance from;
  const std::string path = call.options.at("path").string();
  check(read_document(path, from), call.options.at("schema").string(), out);
  return out;
}

Answer check_document(const Call& call) {
  Answer out;
  check(call.options.at("document"), call.options.at("schema").string(), out);
  return out;
}

Answer write_document(const Call& call) {
  write_file(call.options.at("path").string(), to_text(Json::parse(call.options.at("text").text())));
  return {};
}

Answer write_files(const Call& call) {
  OutputSet out(call.options.at("folder").string());
  for (const auto& [path, content] : call.options.at("files").members()) out.add(path, content.text());
  out.commit();
  return {};
}

Answer read_points(const Call& call) {
  Provenance from;
  const BodePoints points = BodePoints::read_csv(call.options.at("path").string(), from);
  Answer out;
  auto& f = out.arrays["frequency_hz"];
  auto& gain = out.arrays["gain"];
  auto& weight = out.arrays["weight"];
  std::vector<double> phase;
  for (const BodePoint& point : points.points) {
    f.push_back(point.frequency.value);
    gain.push_back(point.gain);
    weight.push_back(point.weight);
    if (point.phase_deg) phase.push_back(*point.phase_deg);
  }
  if (!phase.empty() && phase.size() == f.size()) out.arrays["phase_deg"] = std::move(phase);
  out.result["inputs"] = inputs_json(from);
  return out;
}

Answer read_response(const Call& call) {
  Provenance from;
  const FrequencyRecord record = FrequencyRecord::read_csv(call.options.at("path").string(), from);
  Answer out;
  out.arrays["frequency_hz"] = hertz(record.frequency);
  out.arrays["response"] = interleaved(record.response);
  if (!record.coherence.empty()) out.arrays["coherence"] = record.coherence;
  out.result["inputs"] = inputs_json(from);
  return out;
}

Answer read_record(const Call& call) {
  Provenance from;
  const std::string path = call.options.at("path").string();
  TimeRecord record = TimeRecord::read_csv_column(path, from, call.options.string_or("column", "u"));
  Answer out;
  out.result = {{"name", record.file},
                {"start_s", record.start_s},
                {"step_s", record.step_s},
                {"inputs", inputs_json(from)}};
  out.arrays["u"] = std::move(record.u);
  if (!record.y.empty()) out.arrays["y"] = std::move(record.y);
  return out;
}

Answer names(const Call&) {
  const auto list = [](const auto& registry) {
    Json out = Json::array();
    for (const auto* one : registry.all()) out.push_back(one->name());
    return out;
  };
  Answer out;
  out.result = {{"methods", list(method_registry())},
                {"families", list(filters::family_registry())},
                {"models", list(hysteresis::model_type_registry())}};
  return out;
}

}  // namespace bodesmith::python
