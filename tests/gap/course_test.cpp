// How answers to a course are graded, and what a course's file must say.
#include "gap/course.hpp"

#include <gtest/gtest.h>

#include <string>

#include "base/error.hpp"
#include "base/files.hpp"
#include "temporary_folder.hpp"

namespace course_of {
namespace {

using namespace bodesmith;
using Grade = gap::CourseAnswer::Grade;

gap::CourseCase sealed(const std::string& answer) {
  gap::CourseCase out;
  out.name = "01";
  out.salt = "salt";
  out.sealed_sha256 = sha256_hex("salt:" + answer);
  return out;
}

Grade grade(const std::string& hidden, const std::string& verdict, const std::string& steps) {
  const TemporaryFolder folder;
  write_file(folder / "diagnosis.json", "{\"schema\": \"bodesmith.diagnosis/1\", \"verdict\": \"" + verdict +
                                            "\", \"steps\": [" + steps + "]}\n");
  Provenance from;
  const auto answer = gap::course_answer(sealed(hidden), folder / "diagnosis.json", from);
  EXPECT_EQ(answer.hidden, hidden);
  return answer.grade;
}

const std::string kDrift = "{\"effect\": \"drift\", \"tied_with\": []}";
const std::string kTie = "{\"effect\": \"offset\", \"tied_with\": [\"backlash\", \"drift\"]}";

TEST(Course, IsGradedByWhatIsNamed) {
  EXPECT_EQ(grade("drift", "explained", kDrift), Grade::right);
  EXPECT_EQ(grade("drift", "explained", kDrift + "," + kTie), Grade::among_others);
  EXPECT_EQ(grade("drift", "explained", kTie + "," + kDrift), Grade::among_others);
  EXPECT_EQ(grade("drift", "explained", kTie), Grade::tied);
  EXPECT_EQ(grade("backlash", "explained", kTie), Grade::tied);
  EXPECT_EQ(grade("saturation", "explained", kTie + "," + kDrift), Grade::wrong);
  EXPECT_EQ(grade("drift", "nothing_missing", ""), Grade::wrong);
  EXPECT_EQ(grade("nothing_missing", "nothing_missing", ""), Grade::right);
  EXPECT_EQ(grade("nothing_missing", "unexplained", ""), Grade::wrong);
  EXPECT_EQ(grade("nothing_missing", "explained", kDrift), Grade::wrong);
}

TEST(Course, ReadsCasesWhoseSealsAreOfEffects) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& name, const std::string& hidden) {
    write_file(folder / "course.json",
               "{\"schema\": \"bodesmith.course/1\", \"cases\": [{\"case\": \"" + name +
                   "\", \"model\": \"m.toml\", \"data\": \"d.csv\", \"holdout\": \"h.csv\", "
                   "\"salt\": \"salt\", \"sealed_sha256\": \"" +
                   sha256_hex("salt:" + hidden) + "\"}]}\n");
    Provenance from;
    return gap::read_course(folder.path(), from);
  };
  const auto cases = read("az_09", "time_delay");
  ASSERT_EQ(cases.size(), 1U);
  EXPECT_EQ(cases[0].opened(), "time_delay");
  EXPECT_EQ(cases[0].model, folder / "m.toml");
  for (const std::string wrong : {"", "A", "a/b", "a.b", "`", "{", "/", ":"})
    EXPECT_THROW(read(wrong, "time_delay"), InputError) << wrong;
  EXPECT_THROW(read("01", "time_delays"), InputError);
  write_file(folder / "course.json", "{\"schema\": \"bodesmith.course/1\", \"cases\": []}\n");
  Provenance from;
  EXPECT_THROW(gap::read_course(folder.path(), from), InputError);
}

}  // namespace
}  // namespace course_of
