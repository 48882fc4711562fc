// nlohmann/json.hpp without its other JSON, `nlohmann::json`, which nobody here uses: the library's literals ("…"_json) would
// have its parser instantiated in every file, a third of a second each.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

template <>
class nlohmann::basic_json<> {
 public:
  using json_pointer = nlohmann::json_pointer<std::string>;
  static basic_json parse(const char* begin, const char* end);  // the literals call it
};

#include <nlohmann/json.hpp>
