#include <gtest/gtest.h>

#include "../circuit/seed_sections.hpp"
#include "base/error.hpp"
#include "circuit/realise.hpp"
#include "circuit/response.hpp"
#include "spice/check.hpp"
#include "spice/emit.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith {
namespace {

TEST(Compensator, NgspiceAgreesWithTheNetworkAndTheSections) {
  if (!ngspice_available()) GTEST_SKIP() << "ngspice is not installed";
  const Realised made = realise(seed_sections());
  const SpiceCheck check = check_with_ngspice(made.circuit, seed_sections());
  std::printf("%g %g\n", check.against_network.max_magnitude_db, check.against_sections.max_magnitude_db);
  EXPECT_LT(check.against_network.max_complex_percent, 1e-5);
  EXPECT_LT(check.against_sections.max_magnitude_db, 0.02);
  std::puts(compensator_library(made.circuit, "seed").c_str());
}

}  // namespace
}  // namespace bodesmith
