#include "texts.hpp"

#include <map>
#include <ostream>
#include <regex>

#include "base/documents/json.hpp"

namespace bodesmith {
namespace {

const std::regex& compiled(const std::string& pattern) {
  static std::map<std::string, std::regex> all;  // one thread
  return all.try_emplace(pattern, pattern, std::regex::ECMAScript | std::regex::optimize).first->second;
}

}  // namespace

std::vector<std::vector<std::string>> matches(const std::string& text, const std::string& pattern) {
  std::vector<std::vector<std::string>> out;
  for (std::sregex_iterator at(text.begin(), text.end(), compiled(pattern)), end; at != end; ++at)
    out.emplace_back(at->begin(), at->end());
  return out;
}

bool has_match(const std::string& text, const std::string& pattern) {
  return std::regex_search(text, compiled(pattern));
}

std::string replaced(const std::string& text, const std::string& pattern, const std::string& with) {
  return std::regex_replace(text, compiled(pattern), with);
}

Json parsed(const std::string& text) {
  return Json::parse(text);
}

}  // namespace bodesmith

namespace nlohmann {
void PrintTo(const bodesmith::Json& value, std::ostream* out) {
  *out << value.dump();
}
}  // namespace nlohmann
