#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/files.hpp"
#include "cli/dialect.hpp"
#include "temporary_folder.hpp"

namespace bodesmith {
namespace {

using testing::IsEmpty;
using testing::Not;

// The forms that lie or are rejected, each alone in a library that is otherwise good.
TEST(Dialect, FormsThatLieAreSeen) {
  const TemporaryFolder folder;
  const auto errors = [&](const std::string& line) {
    write_file(folder / "a.sub",
               ".subckt a in out\nRin in 0 1e3\n" + line + "\nRout out 0 1e3\nRm m 0 1\n.ends a\n");
    return library_errors(folder / "a.sub");
  };
  EXPECT_THAT(errors("E1 out m VALUE={ v(in)*v(in)*(1+2e-3*tanh(v(in)))-max(v(in),0)/3 }"), IsEmpty());
  for (const char* bad : {"E1 out m VALUE={ v(in)^3 }",
                          "E1 out m VALUE={ v(in)**3 }",
                          "E1 out m VALUE={ pow(v(in),3) }",
                          "E1 out m VALUE={ LIMIT(v(in),0,1) }",
                          "E1 out m VALUE={ IF(v(in)>0,1,2) }",
                          "E1 out m LAPLACE={v(in)} {1/s}",
                          "E1 out m TABLE {v(in)}=(0,0) (1,1)",
                          "S1 out m in 0 switch",
                          "R1 out m 4k7",
                          "R1 out m 1M",
                          "C1 out m 1F",
                          "R1 out m 0.0.1",
                          "V1 out m PULSE(0 1 0 1e-6 1e-6 0 1e-3)",
                          "V1 out m PWL(0 0 1 1) REPEAT FOREVER",
                          "V1 out m PWL(0 0 1)",
                          ".meas ac x max vm(out)",
                          ".control",
                          ".ac dec 1 1 1",
                          "X1 out m nothing",
                          "R1 out floating 1",
                          "E1 out m VALUE={ v(elsewhere) }",
                          "Rin out m 1",
                          "R1 out m {mc(1,0.1)}",
                          "D1 out m nothing",
                          "E1 out m 1 0 5",
                          "B1 out m V=v(in)"})
    EXPECT_THAT(errors(bad), Not(IsEmpty())) << bad;
}

TEST(Dialect, DecksKeepToTheirProgram) {
  const TemporaryFolder folder;
  write_file(folder / "a.sub", ".subckt a in out\nR1 in out 1e3\nC1 out 0 1e-9\n.ends a\n");
  const std::string begin = "title\n.include a.sub\nVin in 0 AC 1\nXc in out a\nRload out 0 1e12\n",
                    end = "\n.end\n";
  const auto count = [&](const std::string& text, Dialect dialect) {
    write_file(folder / "deck.cir", text);
    return dialect_errors(folder / "deck.cir", dialect).size();
  };
  const std::string ac = ".ac dec 50 1 1e3", control = ".control\nac dec 1 1 1\n.endc",
                    step = ".step param run 1 9 1\n";
  for (const Dialect dialect : {Dialect::ngspice, Dialect::ltspice, Dialect::xyce})
    EXPECT_EQ(count(begin + ac + end, dialect), 0U);
  EXPECT_EQ(count(begin + control + end, Dialect::ngspice), 0U);
  EXPECT_GT(count(begin + control + end, Dialect::ltspice), 0U);
  EXPECT_EQ(count(begin + step + ac + end, Dialect::ltspice), 0U);
  EXPECT_GT(count(begin + step + ac + end, Dialect::xyce), 0U);
  EXPECT_GT(count(begin + ac + "\n" + ac + end, Dialect::xyce), 0U);
  EXPECT_GT(count(begin + ac, Dialect::xyce), 0U);
  EXPECT_GT(count(".include a.sub\n" + begin + ac + end, Dialect::xyce), 0U);
}

}  // namespace
}  // namespace bodesmith
