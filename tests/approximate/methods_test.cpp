#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

#include "approximate/approximate.hpp"
#include "base/error.hpp"

namespace bodesmith {
namespace {

using Exact = boost::multiprecision::cpp_bin_float_100;

TermApproximation make(const std::string& method, double kappa, double beta, int order) {
  ApproximationOptions options;
  options.method = method;
  return value_or_throw(try_approximate_term({1.0, 1.0 / kappa, beta}, options, order));
}

double error_db(const std::string& method, double kappa, double beta, int order) {
  return make(method, kappa, beta, order).error.everywhere_db;
}

TEST(ApproximationMethods, PublishedFiguresForTheSquareRoot) {
  EXPECT_NEAR(error_db("oustaloup", 10, 0.5, 2), 0.096, 0.0006);
  EXPECT_NEAR(error_db("oustaloup", 10, 0.5, 4), 0.022, 0.0006);
  EXPECT_NEAR(error_db("oustaloup", 10, 0.5, 8), 0.0054, 0.0001);
  EXPECT_NEAR(error_db("oustaloup", 1e3, 0.5, 2), 1.26, 0.01);
  EXPECT_NEAR(error_db("oustaloup", 1e4, 0.5, 8), 0.099, 0.002);
  EXPECT_NEAR(error_db("pade", 10, 0.5, 2), 0.030, 0.0005);
  // Interpolation from corner to corner comes close to the minimax (whose figures are
  // .0217, 1.02e-4, 2.27e-9).
  EXPECT_LT(error_db("matsuda", 10, 0.5, 2), 1.3 * error_db("minimax", 10, 0.5, 2));
  EXPECT_LT(error_db("matsuda", 10, 0.5, 8), 1.3 * error_db("minimax", 10, 0.5, 8));
}

TEST(ApproximationMethods, NoneBeatsTheMinimax) {
  for (const Method* method : method_registry().all()) {
    for (const double kappa : {1.5, 10.0, 500.0}) {
      for (const double beta : {0.2, 0.5, 0.8, 1.6}) {
        for (const int order : {3, 5}) {
          try {
            EXPECT_GE(error_db(std::string(method->name()), kappa, beta, order),
                      0.999 * error_db("minimax", kappa, beta, order) - 1e-12)
                << method->name() << " " << kappa << " " << beta << " " << order;
          } catch (const DesignError&) {
            EXPECT_TRUE(method->name() == "carlson" || method->name() == "refined-oustaloup")
                << method->name();
          }
        }
      }
    }
  }
}

// Thiele's continued fraction in 100 digits is the definition of Matsuda's method.
TEST(Matsuda, EqualsThielesFractionInHighPrecision) {
  for (const double kappa : {1.5, 3.0, 100.0}) {
    for (const int order : {2, 5, 9, 12}) {
      const double beta = 0.37;
      const auto count = static_cast<std::size_t>(2 * order + 1);
      std::vector<Exact> node;
      std::vector<Exact> value;
      for (std::size_t i = 0; i < count; ++i) {
        const Exact s = pow(Exact(kappa), Exact(i) / (count - 1));
        node.push_back(s);
        value.push_back(pow((1 + s) / (1 + s / Exact(kappa)), Exact(beta)));
      }
      std::vector<Exact> a;
      std::vector<Exact> v = value;
      for (std::size_t k = 0; k < count; ++k) {
        a.push_back(v[k]);
        for (std::size_t j = k + 1; j < count; ++j) v[j] = (node[j] - node[k]) / (v[j] - a.back());
      }
      const auto thiele = [&](const Exact& s) {
        Exact f = a.back();
        for (std::size_t k = count - 1; k-- > 0;) f = a[k] + (s - node[k]) / f;
        return static_cast<double>(f);
      };
      const auto made = make("matsuda", kappa, beta, order);
      for (const double s : {0.01, 0.3, 1.0, 1.7, 40.0, 1e4}) {
        std::complex<double> h = 1.0;
        for (const Section& section : made.sections) h *= section.response(std::complex<double>(s, 0.0));
        EXPECT_NEAR(h.real() / thiele(Exact(s)), 1.0, 2e-12) << kappa << " " << order << " " << s;
      }
    }
  }
}

// The diagonal Pade approximant agrees with the function to order 2n at the centre of the band.
TEST(Pade, MeetsAllDerivativesAtTheCentre) {
  const double kappa = 50.0;
  const auto made = make("pade", kappa, 0.3, 2);
  const auto log_ratio = [&](double s) {
    double h = 0.0;
    for (const Section& section : made.sections)
      h += std::log(section.response(std::complex<double>(s, 0.0)).real());
    return h - 0.3 * std::log((1.0 + s) / (1.0 + s / kappa));
  };
  // The difference starts with the 5th power of the distance in log s.
  const double r = std::sqrt(kappa);
  const double near = log_ratio(r * std::exp(0.4));
  const double far = log_ratio(r * std::exp(0.8));
  EXPECT_NEAR(std::log2(far / near), 5.0, 0.25);
}

TEST(Carlson, IsNewtonsIteration) {
  const double kappa = 10.0;
  const auto made = make("carlson", kappa, 0.5, 4);
  for (const double s : {0.1, 1.0, 3.0, 30.0}) {
    const double p = (1.0 + s) / (1.0 + s / kappa) / std::sqrt(kappa);
    double h = 1.0;
    for (int i = 0; i < 2; ++i) h *= (h * h + 3.0 * p) / (3.0 * h * h + p);
    std::complex<double> got = 1.0;
    for (const Section& section : made.sections) got *= section.response(std::complex<double>(s, 0.0));
    EXPECT_NEAR(got.real(), h * std::pow(kappa, 0.25), 1e-12);
  }
  EXPECT_THROW(make("carlson", 10, 0.5, 3), DesignError);
  EXPECT_THROW(make("carlson", 10, 0.3, 4), DesignError);
  EXPECT_NO_THROW(make("carlson", 10, 1.5, 5));
}

TEST(Charef, SingularitiesAreOustaloupsOnceTheirNumberIsFixed) {
  EXPECT_NEAR(error_db("charef", 200, 0.3, 5), error_db("oustaloup", 200, 0.3, 5), 1e-12);
}

TEST(RefinedOustaloup, RefusesWhatItCannotDo) {
  EXPECT_THROW(make("refined-oustaloup", 10, 0.5, 2), DesignError);
  try {
    make("refined-oustaloup", 10, 2.5, 4);
    FAIL() << "an order of 4 for two whole powers and a correction of order 2";
  } catch (const DesignError& error) {
    EXPECT_NE(std::string(error.what()).find("3 plus whole powers"), std::string::npos) << error.what();
  }
  EXPECT_LT(error_db("refined-oustaloup", 1e3, 0.5, 7), 0.5);
}

TEST(ApproximationMethods, EveryOrderIsRightOrRefused) {
  for (const Method* method : method_registry().all()) {
    for (const double kappa : {1.05, 10.0, 1e5}) {
      for (const double beta : {-3.4, -1.0, 0.01, 0.5, 0.99, 2.0}) {
        for (const int order : {1, 2, 3, 4, 7, 12}) {
          try {
            const auto made = make(std::string(method->name()), kappa, beta, order);
            int poles = 0;
            for (const Section& section : made.sections) {
              poles += static_cast<int>(section.poles.size());
              ASSERT_TRUE(section.is_stable()) << method->name();
            }
            // Of fewer poles than |beta| minimax makes its best.
            EXPECT_EQ(poles,
                      beta == std::round(beta) ? std::min(order, static_cast<int>(std::abs(beta))) : order);
            // No method may be worse than leaving the term's fraction away altogether.
            EXPECT_LT(made.error.everywhere_db, 20.0 * std::abs(beta) * std::log10(kappa) + 1e-9)
                << method->name() << " " << kappa << " " << beta << " " << order;
          } catch (const DesignError& refused) {
            EXPECT_GT(std::string(refused.what()).size(), 20u);
          }
        }
      }
    }
  }
}

TEST(ApproximationMethods, UnknownNamesAreRefusedWithTheList) {
  try {
    (void)method_registry().get("remez");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("matsuda"), std::string::npos);
  }
}

}  // namespace
}  // namespace bodesmith
