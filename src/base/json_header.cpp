#include "base/json_header.hpp"

#include <fmt/format.h>

#include "base/json.hpp"
#include "base/version.hpp"

namespace bodesmith {

Json json_header(std::string_view name, const Provenance& from) {
  Json header = {{"schema", fmt::format("bodesmith.{}/1", name)},
                 {"program", fmt::format("bodesmith {}", kVersion)},
                 {"inputs", Json::array()}};
  for (const InputFile& input : from.inputs) {
    Json entry = {{"path", input.path}, {"sha256", input.sha256}};
    if (!input.read_as.empty()) entry["read_as"] = input.read_as;
    header["inputs"].push_back(std::move(entry));
  }
  return header;
}

Json timed_json(std::string_view name, const Provenance& from, const Json& body, double seconds) {
  Json out = json_header(name, from);
  out.update(body);
  out["timing_s"] = {{"compute", seconds}};
  return out;
}

}  // namespace bodesmith
