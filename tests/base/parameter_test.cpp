#include "base/parameter.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace bodesmith {
namespace {

TEST(Parameters, LimitsAreLegalOrNotAsTheyAreStated) {
  struct Case {
    ParameterSpec spec;
    double value;
    const char* said;
  };
  for (const Case& one :
       {Case{any_number("a", "1", ""), -1e300, ""},
        Case{any_number("a", "1", ""), INFINITY, "is not a finite number"},
        Case{any_number("a", "1", ""), NAN, "is not a finite number"},
        Case{above_zero("a", "1", ""), 1e-300, ""},
        Case{above_zero("a", "1", ""), 0.0, "is 0, expected above 0"},
        Case{above_zero("a", "1", ""), -1.0, "is -1, expected above 0"},
        Case{above_zero("a", "1", ""), 1e-310, "is 1e-310, expected a number above 2.3e-308"},
        Case{not_negative("a", "1", ""), 0.0, ""}, Case{not_negative("a", "1", ""), 1e-310, ""},
        Case{not_negative("a", "1", ""), -1e-310, "is -1e-310, expected at least 0"},
        Case{at_least("a", "1", "", 2.0), 2.0, ""},
        Case{at_least("a", "1", "", 2.0), 1.5, "is 1.5, expected at least 2"},
        Case{between("a", "1", "", -1.0, 3.0), -1.0, ""}, Case{between("a", "1", "", -1.0, 3.0), 3.0, ""},
        Case{between("a", "1", "", -1.0, 3.0), 3.5, "is 3.5, expected at least -1 and at most 3"},
        Case{flag("a", ""), 2.0, "is 2, expected at least 0 and at most 1"}})
    EXPECT_EQ(one.spec.validate(one.value), one.said) << one.value;
}

TEST(Parameters, WhatMayBeLeftOut) {
  EXPECT_FALSE(above_zero("a", "Hz", "").optional());
  EXPECT_TRUE(above_zero("a", "Hz", "").is_frequency());
  EXPECT_EQ(any_number("a", "s", "").with_default(7.0).default_value->at(0), 7.0);
  EXPECT_EQ(flag("a", "").default_value->at(0), 0.0);
  EXPECT_FALSE(list_of(any_number("a", "1", "")).optional());
  EXPECT_TRUE(optional_list_of(any_number("a", "1", "")).optional());
  EXPECT_TRUE(optional_list_of(any_number("a", "1", "")).default_value->empty());
  const ParameterSpec word = one_word_of("kind", "", {"cubic", "sine"});
  EXPECT_TRUE(word.optional());
  EXPECT_EQ(word.validate("sine"), "");
  EXPECT_EQ(word.validate("sin"), "is 'sin' (did you mean 'sine'?), expected one of cubic, sine");
  const std::vector<ParameterSpec> all = {flag("one", ""), word};
  EXPECT_EQ(find_parameter(all, "kind"), &all[1]);
  EXPECT_EQ(find_parameter(all, "none"), nullptr);
  EXPECT_EQ(names_of(all), "one, kind");
}

}  // namespace
}  // namespace bodesmith
