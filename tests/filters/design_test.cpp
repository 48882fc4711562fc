// Frequency transformations, masks and equalisers.
#include "filters/design.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "base/units.hpp"
#include "filters/equalisers.hpp"

namespace bodesmith::filters {
namespace {

double level_db(const Sections& sections, double hz) {
  return to_decibel(std::abs(sections.response(Hertz{hz}.rad_s())));
}

TEST(Place, EveryKindIsThePrototypeAtTheTransformedFrequency) {
  for (const Family* family : family_registry().all()) {
    const Prototype p = make_prototype(*family, {6, 1.0, 50.0});
    const Sections low = place(p, {Kind::lowpass, {Hertz{300.0}, {}}});
    const Sections high = place(p, {Kind::highpass, {Hertz{300.0}, {}}});
    const Sections pass = place(p, {Kind::bandpass, {Hertz{300.0}, Hertz{330.0}}});
    const Sections stop = place(p, {Kind::bandstop, {Hertz{300.0}, Hertz{1330.0}}});
    EXPECT_EQ(pass.pole_count(), 12);
    for (const double f : {3.0, 150.0, 299.0, 317.0, 401.0, 5000.0}) {
      const double in_pass = std::abs(f * f - 300.0 * 330.0) / (30.0 * f);
      const double in_stop = 1030.0 * f / std::abs(f * f - 300.0 * 1330.0);
      const std::string where = std::string(family->name()) + " at " + std::to_string(f);
      EXPECT_NEAR(level_db(low, f), -p.attenuation_db(f / 300.0), 1e-6) << where;
      EXPECT_NEAR(level_db(high, f), -p.attenuation_db(300.0 / f), 1e-6) << where;
      EXPECT_NEAR(level_db(pass, f), -p.attenuation_db(in_pass), 1e-6) << where;
      EXPECT_NEAR(level_db(stop, f), -p.attenuation_db(in_stop), 1e-6) << where;
    }
  }
}

TEST(Place, NarrowBandsKeepTheirWidth) {
  const Prototype p = make_prototype(family_registry().get("butterworth"), {5});
  const Sections narrow = place(p, {Kind::bandpass, {Hertz{999.999}, Hertz{1000.001}}});
  EXPECT_NEAR(level_db(narrow, 999.999), -3.0103, 1e-3);
  EXPECT_NEAR(level_db(narrow, 1000.0), 0.0, 1e-4);
}

TEST(Place, RefusesCornersThatMakeNoSense) {
  const Prototype p = make_prototype(family_registry().get("butterworth"), {2});
  EXPECT_THROW(place(p, {Kind::lowpass, {Hertz{0.0}, {}}}), InputError);
  EXPECT_THROW(place(p, {Kind::bandpass, {Hertz{20.0}, Hertz{10.0}}}), InputError);
  EXPECT_THROW(place(p, {Kind::highpass, {Hertz{NAN}, {}}}), InputError);
}

TEST(LeastOrder, KeepsTheMaskAndOneLessDoesNot) {
  for (const Family* family : family_registry().all()) {
    if (family->name() == "gaussian" || family->name() == "bessel") continue;  // too soft for this mask
    const Mask mask{Kind::bandpass, {Hertz{900.0}, Hertz{1100.0}}, {Hertz{600.0}, Hertz{1500.0}}, 1.0, 40.0};
    const MaskedDesign design = least_order(*family, mask);
    const Sections sections = place(design.prototype, design.placing);
    for (const double f : {900.0, 1100.0}) EXPECT_GE(level_db(sections, f), -1.0 - 1e-6) << family->name();
    for (const double f : {600.0, 1500.0, 100.0, 1e4})
      EXPECT_LE(level_db(sections, f), -40.0 + 1e-6) << family->name();
  }
  // Butterworth's order by its formula: log((10^4 - 1)/(10^.1 - 1))/(2 log 2).
  const MaskedDesign low = least_order(family_registry().get("butterworth"),
                                       {Kind::lowpass, {Hertz{1e3}, {}}, {Hertz{2e3}, {}}, 1.0, 40.0});
  EXPECT_EQ(low.order, 8);
  EXPECT_NEAR(level_db(place(low.prototype, low.placing), 1e3), -1.0, 1e-9);
}

// What lies mirrored in log f has the same prototype: selectivities are ratios of the edges, either way round.
TEST(LeastOrder, OfAHighPassIsThatOfItsMirrorImage) {
  for (const Family* family : family_registry().all()) {
    if (family->name() == "gaussian" || family->name() == "bessel") continue;
    const MaskedDesign low =
        least_order(*family, {Kind::lowpass, {Hertz{1e3}, {}}, {Hertz{2e3}, {}}, 1.0, 40.0});
    const MaskedDesign high =
        least_order(*family, {Kind::highpass, {Hertz{1e3}, {}}, {Hertz{500.0}, {}}, 1.0, 40.0});
    EXPECT_EQ(high.order, low.order) << family->name();
    const Sections a = place(low.prototype, low.placing), b = place(high.prototype, high.placing);
    for (const double ratio : {0.3, 1.0, 1.7, 2.0, 5.0})
      EXPECT_NEAR(level_db(a, 1e3 * ratio), level_db(b, 1e3 / ratio), 1e-6) << family->name() << " " << ratio;
  }
}

// The stop edges of a band stop are where a band pass of the same edges passes: the nearer one decides in both.
TEST(LeastOrder, OfABandStopIsThatOfTheBandPassOfItsStopBand) {
  for (const Family* family : family_registry().all()) {
    if (family->name() == "gaussian" || family->name() == "bessel") continue;
    // About 1 kHz: selectivity is the ratio of the widths, 600 by 200 Hz at the edge that is nearer.
    const Band inner{Hertz{905.0}, Hertz{1105.0}}, outer{Hertz{700.0}, Hertz{1500.0}};
    const MaskedDesign stop = least_order(*family, {Kind::bandstop, outer, inner, 1.0, 40.0});
    const Sections sections = place(stop.prototype, stop.placing);
    for (const double f : {905.0, 1000.0, 1105.0})
      EXPECT_LE(level_db(sections, f), -40.0 + 1e-6) << family->name();
    for (const double f : {700.0, 1500.0, 10.0, 1e5})
      EXPECT_GE(level_db(sections, f), -1.0 - 1e-6) << family->name();
  }
}

TEST(LeastOrder, MasksThatMakeNoSenseAreSaid) {
  const auto said = [](const Mask& mask) -> std::string {
    try {
      least_order(family_registry().get("butterworth"), mask);
    } catch (const InputError& error) {
      return error.what();
    }
    return "taken";
  };
  const Band low{Hertz{1e3}, {}}, high{Hertz{2e3}, {}}, inner{Hertz{900.0}, Hertz{1100.0}},
      outer{Hertz{600.0}, Hertz{1500.0}};
  EXPECT_EQ(said({Kind::lowpass, low, high, 1.0, 40.0}), "taken");
  EXPECT_NE(said({Kind::highpass, low, high, 1.0, 40.0}).find("stop band below the pass band"),
            std::string::npos);
  EXPECT_NE(said({Kind::bandpass, outer, inner, 1.0, 40.0}).find("pass band inside the stop edges"),
            std::string::npos);
  EXPECT_NE(said({Kind::bandstop, inner, outer, 1.0, 40.0}).find("stop band inside the pass edges"),
            std::string::npos);
  EXPECT_NE(said({Kind::lowpass, low, high, 0.0, 40.0}), "taken");
  EXPECT_NE(said({Kind::lowpass, low, high, 3.0, 3.0}).find("the second larger"), std::string::npos);
}

TEST(LeastOrder, SaysWhenNoOrderDoes) {
  const Mask steep{Kind::lowpass, {Hertz{1e3}, {}}, {Hertz{1.001e3}, {}}, 0.1, 80.0};
  EXPECT_THROW(least_order(family_registry().get("butterworth"), steep), DesignError);
  const Mask reversed{Kind::lowpass, {Hertz{2e3}, {}}, {Hertz{1e3}, {}}, 0.1, 80.0};
  EXPECT_THROW(least_order(family_registry().get("butterworth"), reversed), InputError);
}

TEST(Equalisers, HaveTheGainsTheyAreAskedFor) {
  EXPECT_NEAR(level_db(peaking(Hertz{1e3}, 6.0, 2.0), 1e3), 6.0, 1e-12);
  EXPECT_NEAR(level_db(peaking(Hertz{1e3}, -6.0, 0.1), 1e3), -6.0, 1e-12);
  EXPECT_NEAR(level_db(low_shelf(Hertz{100.0}, 9.0), 1e-3), 9.0, 1e-6);
  EXPECT_NEAR(level_db(low_shelf(Hertz{100.0}, 9.0), 100.0), 4.5, 1e-12);
  EXPECT_NEAR(level_db(high_shelf(Hertz{100.0}, -9.0), 1e8), -9.0, 1e-6);
  EXPECT_NEAR(level_db(high_shelf(Hertz{100.0}, -9.0), 1e-3), 0.0, 1e-6);
  for (const double gain_db : {200.0, -200.0}) EXPECT_NO_THROW(low_shelf(Hertz{100.0}, gain_db));
  EXPECT_THROW(low_shelf(Hertz{100.0}, 200.1), InputError);
  EXPECT_THROW(high_shelf(Hertz{2e12}, 1.0), InputError);
  EXPECT_THROW(high_shelf(Hertz{9e-10}, 1.0), InputError);
  EXPECT_THROW(peaking(Hertz{100.0}, 1.0, 1.1e6), InputError);
  EXPECT_THROW(peaking(Hertz{100.0}, 1.0, 0.9e-6), InputError);
  EXPECT_THROW(delay_allpass(0.0, 2), InputError);
  EXPECT_THROW(delay_allpass(1e-3, 0), InputError);
  EXPECT_THROW(delay_allpass(1e-3, 21), InputError);
}

TEST(Equalisers, AllPassDelaysAsThePadeApproximantDoes) {
  for (const int order : {1, 2, 5, 8}) {
    const Sections allpass = delay_allpass(1e-3, order);
    for (const double f : {1.0, 50.0, 100.0}) {
      const std::complex<double> h = allpass.response(Hertz{f}.rad_s());
      EXPECT_NEAR(std::abs(h), 1.0, 1e-12);
      const double off = std::abs(h - std::polar(1.0, -Hertz{f}.rad_s().value * 1e-3));
      EXPECT_LT(off, order == 1 ? 0.03 : order == 2 ? 4e-4 : 1e-9) << order << " " << f;
    }
  }
}

}  // namespace
}  // namespace bodesmith::filters
