#include "gap/cases/case.hpp"

#include <fmt/format.h>

namespace hidden {

std::string Specification::what_text() const {
  std::string text;
  for (const auto& w : what) text += (text.empty() ? "" : "+") + w;
  return text;
}

std::string Specification::key() const {
  return fmt::format("{}:{}:{}:{}:{}:{}{}", to_string(world), to_string(kind), base, what_text(), ratio, seed,
                     rows > 0 ? fmt::format(":{}", rows) : "");
}

std::uint64_t Specification::salt() const {
  std::uint64_t hash = 14695981039346656037ULL + seed;  // FNV-1a
  for (const char c : base + "/" + what_text())
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

const char* to_string(World world) {
  switch (world) {
    case World::formulas:
      return "formulas";
    case World::responses:
      return "responses";
    case World::ngspice:
      break;
  }
  return "ngspice";
}

const char* to_string(Kind kind) {
  switch (kind) {
    case Kind::effect:
      return "effect";
    case Kind::pair:
      return "pair";
    case Kind::control:
      return "control";
    case Kind::outside:
      break;
  }
  return "outside";
}

}  // namespace hidden
