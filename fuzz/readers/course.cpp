#include "gap/course.hpp"

#include <stdexcept>

#include "base/error.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

/// As a course's list of cases, and as an answer to its first case.
void read_course_bytes(std::string_view bytes) {
  Provenance from;
  static const gap::CourseCase question{
      "01", "", "", "", "", "salt", sha256_hex(std::string("salt:nothing_missing"))};
  const auto file = as_file(bytes, "course.json");
  try {
    gap::course_answer(question, file, from);
  } catch (const InputError&) {
    for (const auto& one : gap::read_course(file.parent_path(), from)) {
      if (!one.opened()) throw std::logic_error("a case without an answer");
    }
  }
}
const Registered course_reader{"course", read_course_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
