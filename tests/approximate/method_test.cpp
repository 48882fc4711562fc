// A method that only this folder knows: registered with one line, it does everything the others do.
#include <gtest/gtest.h>

#include <cmath>

#include "approximate/approximate.hpp"
#include "base/documents/json.hpp"
#include "base/error.hpp"

namespace bodesmith {
namespace {

/// All poles at one place and all zeros at another, about the centre of the band; no order above 12.
class Heap final : public Method {
 public:
  std::string_view name() const override { return "heap"; }
  Outcome<NormalisedApproximation> approximate(const ApproximationTask& task) const override {
    if (task.order > 12) return Refusal{"heap stops at an order of 12"};
    const double spread = std::pow(task.kappa, task.beta / (2.0 * task.order));
    NormalisedApproximation out;
    out.gain = std::pow(task.kappa, task.beta);
    out.zeros.assign(static_cast<std::size_t>(task.order), -1.0 / spread);
    out.poles.assign(static_cast<std::size_t>(task.order), -spread);
    return out;
  }
};

const Heap& registered_heap() {
  static const Heap heap;
  if (method_registry().find("heap") == nullptr) method_registry().add(heap);
  return heap;
}

Cascade two_terms() {
  Cascade out;
  out.gain = 3.0;
  out.terms = {{0.1, 0.05, 0.4}, {0.01, 0.2, -1.3}};
  return out;
}

TEST(DummyMethod, ApproximatesACascade) {
  EXPECT_EQ(&method_registry().get(registered_heap().name()), &registered_heap());
  const auto made = approximate_cascade(two_terms(), {.method = "heap", .order = 3});
  EXPECT_EQ(made.report_json()["method"], "heap");
  EXPECT_EQ(made.sections.pole_count(), 6);
  // Exact at 0 and at infinity by its gain.
  EXPECT_NEAR(made.sections.dc_gain(), 3.0, 1e-12);
  const double far = std::abs(made.sections.response(RadPerSecond{1e9}));
  EXPECT_NEAR(far, 3.0 * std::pow(0.05, -0.4) * std::pow(0.2, 1.3), 1e-6);
  // The whole power of the second term was split off: one pole at its corner.
  const TermApproximation& lag = made.terms[1];
  EXPECT_NEAR(lag.sections.front().poles.front().real(), -lag.term.low_corner().value, 1e-9);
  EXPECT_GT(made.error.everywhere_db, 0.0);
  EXPECT_GE(made.terms[0].error.everywhere_db, made.terms[0].limit_law_db);
}

TEST(DummyMethod, IsSearchedForTheFewestPoles) {
  ApproximationOptions options;
  options.method = registered_heap().name();
  options.max_error_db = 2.0;
  const auto made = approximate_cascade(two_terms(), options);
  EXPECT_EQ(made.limit_met(), made.error.everywhere_db <= 2.0);
  EXPECT_EQ(made.report_json()["max_error_db"], 2.0);
}

TEST(DummyMethod, ItsRefusalIsTheErrorsReason) {
  ApproximationOptions options;
  options.method = registered_heap().name();
  const auto outcome = try_approximate_term({1.0, 0.1, 0.5}, options, 13);
  ASSERT_TRUE(std::holds_alternative<Refusal>(outcome));
  EXPECT_EQ(std::get<Refusal>(outcome).reason, "heap stops at an order of 12");
  try {
    (void)approximate_cascade(two_terms(), {.method = "heap", .order = 14});
    FAIL();
  } catch (const DesignError& error) {
    EXPECT_STREQ(error.what(), "heap stops at an order of 12");
  }
}

TEST(DummyMethod, CannotTakeAKnownName) {
  EXPECT_THROW(method_registry().add(registered_heap()), std::logic_error);
}

}  // namespace
}  // namespace bodesmith
