// The program as it is shipped: what a linker and a compiler can do against a memory error is done.
#include <gtest/gtest.h>

#include "run_program.hpp"

namespace bodesmith {
namespace {

TEST(Hardening, AddressesAreDrawnReadOnlyAndBoundAtTheStartAndBuffersChecked) {
#ifndef BODESMITH_HARDENED
  GTEST_SKIP() << "built without BODESMITH_HARDEN";
#endif
  if (run_shell("readelf --version").status != 0) GTEST_SKIP() << "readelf is not installed";
  const auto says = [](const std::string& option) {
    return run_shell("readelf -W " + option + " " + BODESMITH_PROGRAM).out;
  };
  EXPECT_NE(says("-h").find("DYN (Position-Independent"), std::string::npos);
  const std::string segments = says("-l");
  EXPECT_NE(segments.find("GNU_RELRO"), std::string::npos);
  const std::size_t stack = segments.find("GNU_STACK");
  ASSERT_NE(stack, std::string::npos);
  EXPECT_EQ(segments.substr(stack, segments.find('\n', stack) - stack).find("RWE"), std::string::npos);
  const std::string dynamic = says("-d");
  EXPECT_TRUE(dynamic.find("BIND_NOW") != std::string::npos ||
              dynamic.find("Flags: NOW") != std::string::npos);
  const std::string symbols = says("--dyn-syms");
  EXPECT_NE(symbols.find("__stack_chk_fail"), std::string::npos);
  EXPECT_NE(symbols.find("_chk@"), std::string::npos);
}

}  // namespace
}  // namespace bodesmith
