#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/provenance.hpp"

namespace bodesmith::gap {

/// A hidden effect to find, and its name sealed: SHA-256 of "salt:name", so that nobody reads it by accident.
struct CourseCase {
  std::string name;   ///< "03"
  std::string story;  ///< what it claims to be
  std::filesystem::path model;
  std::filesystem::path data;
  std::filesystem::path holdout;
  std::string salt;
  std::string sealed_sha256;

  /// The name behind the seal: that of an effect in the registry, or "nothing_missing"; nothing when it is none of them.
  std::optional<std::string> opened() const;
};

/// course.json (`bodesmith.course/1`) of a folder; paths as the folder has them. Errors with file and line.
std::vector<CourseCase> read_course(const std::filesystem::path& folder, Provenance& from);

/// How a diagnosis.json answers a case.
struct CourseAnswer {
  enum class Grade { right, tied, among_others, wrong };
  Grade grade = Grade::wrong;
  std::vector<std::string> named;  ///< what the diagnosis names
  std::string hidden;
};
/// "right", "a tie with the right one in it", …
const char* to_string(CourseAnswer::Grade grade);
CourseAnswer course_answer(const CourseCase& one, const std::filesystem::path& diagnosis, Provenance& from);

}  // namespace bodesmith::gap
