#include "base/json_header.hpp"

#include <fmt/format.h>

#include "base/json.hpp"
#include "base/version.hpp"

namespace bodesmith {

Json json_header(std::string_view name, const Provenance& from) {
  Json header;
  header["schema"] = fmt::format("bodesmith.{}/1", name);
  header["program"] = fmt::format("bodesmith {}", kVersion);
  header["inputs"] = Json::array();
  for (const InputFile& input : from.inputs) {
    header["inputs"].push_back({{"path", input.path}, {"sha256", input.sha256}});
  }
  return header;
}

}  // namespace bodesmith
