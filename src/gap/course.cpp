#include "gap/course.hpp"

#include <algorithm>
#include <array>

#include "base/documents/document.hpp"
#include "base/text.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

constexpr const char* kNothingMissing = "nothing_missing";

}  // namespace

std::optional<std::string> CourseCase::opened() const {
  const auto fits = [&](std::string_view answer) {
    return sha256_hex(salt + ":" + std::string(answer)) == sealed_sha256;
  };
  if (fits(kNothingMissing)) return kNothingMissing;
  for (const Effect* effect : effect_registry().all()) {
    if (fits(effect->name())) return std::string(effect->name());
  }
  return std::nullopt;
}

std::vector<CourseCase> read_course(const std::filesystem::path& folder, Provenance& from) {
  const Node node = read_document(folder / "course.json", from);
  node.expect_schema("course");
  std::vector<CourseCase> out;
  for (const Node& item : node.at("cases").items()) {
    CourseCase one;
    one.name = item.at("case").string();
    one.story = item.string_or("story", "");
    one.model = folder / item.at("model").string();
    one.data = folder / item.at("data").string();
    one.holdout = folder / item.at("holdout").string();
    one.salt = item.at("salt").string();
    one.sealed_sha256 = item.at("sealed_sha256").string();
    const bool plain = std::ranges::all_of(
        one.name, [](char c) { return is_digit(c) || (c >= 'a' && c <= 'z') || c == '_'; });
    if (one.name.empty() || !plain) item.at("case").fail("expected digits and small letters");
    if (!one.opened()) item.at("sealed_sha256").fail("seals the name of no effect");
    out.push_back(std::move(one));
  }
  if (out.empty()) node.at("cases").fail("is empty, expected at least one case");
  return out;
}

const char* to_string(CourseAnswer::Grade grade) {
  constexpr std::array kWords = {"right", "a tie with the right one in it",
                                 "right, and something else with it", "wrong"};
  return kWords.at(static_cast<std::size_t>(grade));
}

CourseAnswer course_answer(const CourseCase& one, const std::filesystem::path& diagnosis, Provenance& from) {
  const Node node = read_document(diagnosis, from);
  node.expect_schema("diagnosis");
  CourseAnswer out;
  out.hidden = one.opened().value_or("");
  bool named = false;
  bool tied = false;
  for (const Node& step : node.at("steps").items()) {
    out.named.push_back(step.at("effect").string());
    named = named || out.named.back() == out.hidden;
    for (const Node& rival : step.at("tied_with").items()) tied = tied || rival.string() == out.hidden;
  }
  using Grade = CourseAnswer::Grade;
  if (out.named.empty()) {
    out.grade = out.hidden == kNothingMissing && node.at("verdict").string() == kNothingMissing
                    ? Grade::right
                    : Grade::wrong;
  } else if (named) {
    out.grade = out.named.size() == 1 ? Grade::right : Grade::among_others;
  } else if (tied) {
    out.grade = Grade::tied;
  }
  return out;
}

}  // namespace bodesmith::gap
