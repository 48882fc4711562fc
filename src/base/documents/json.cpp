#include "base/documents/json.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/version.hpp"

namespace bodesmith {
namespace {

bool is_flat(const Json& value, int depth = 0) {
  if (!value.is_structured()) return true;
  if (depth >= 2) return false;
  for (const auto& item : value) {
    if (!is_flat(item, depth + 1)) return false;
  }
  return true;
}

void write(const Json& value, int indent, bool inline_mode, std::string& out, const std::string& path) {
  const auto new_line = [&](int depth) {
    out += "\n" + std::string(static_cast<std::size_t>(2 * depth), ' ');
  };
  if (value.is_number_float()) {
    if (!std::isfinite(value.get<double>())) {
      throw InputError("the result at " + path +
                       " is not a finite number: inputs whose numbers double precision cannot hold");
    }
    out += number_text(value.get<double>());
  } else if (value.is_object() || value.is_array()) {
    const char open = value.is_object() ? '{' : '[';
    const char close = value.is_object() ? '}' : ']';
    out += open;
    // An array of numbers, or a small object without deep nesting, reads best on one line.
    std::string one_line;
    bool as_line = inline_mode;
    if (!as_line && indent > 0 && is_flat(value)) {
      for (const auto& [key, item] : value.items()) {
        if (!one_line.empty()) one_line += ", ";
        if (value.is_object()) one_line += Json(key).dump() + ": ";
        write(item, indent, true, one_line, path + "/" + key);
      }
      if (one_line.size() + static_cast<std::size_t>(2 * indent) <= 110) {
        out += one_line;
        out += close;
        return;
      }
    }
    bool first = true;
    for (const auto& [key, item] : value.items()) {
      if (!first) out += as_line ? ", " : ",";
      first = false;
      if (!as_line) new_line(indent + 1);
      if (value.is_object()) out += Json(key).dump() + ": ";
      write(item, indent + 1, as_line, out, path + "/" + key);
    }
    if (!as_line && !value.empty()) new_line(indent);
    out += close;
  } else {
    out += value.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
}

}  // namespace

std::string to_text(const Json& value) {
  std::string out;
  write(value, 0, false, out, "");
  out += "\n";
  return out;
}

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
