// The controller whose every stage is publicly known, as bytes: read back, and its gains as updates.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/files.hpp"
#include "fpaa/cams/transfer_function.hpp"
#include "fpaa/controller/branches.hpp"
#include "fpaa/controller/gains.hpp"
#include "fpaa/controller/io.hpp"
#include "fpaa/controller/netlist.hpp"
#include "fpaa/streams/board_networks.hpp"
#include "fpaa/streams/plan_stream.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::fpaa {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Disturbance rated_disturbance() {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  d.rate.frequency = {{1}, {10}, {20}, {60}, {100}};
  d.rate.ascending = {1, 1, 1, 1, 1};
  d.rate.descending = {1, 1.06, 1.1, 1.04, 1.17};
  return d;
}

const ControllerVariant& loop_of(const Controller& controller, PolynomialBy by) {
  for (const ControllerVariant& v : controller.variants) {
    if (v.by == by && v.structure == ControllerStructure::loop) return v;
  }
  throw std::logic_error("no such variant");
}

TEST(ControllerWeights, UnitsAreTheBestThereAre) {
  // Every Cout and every whole number next to what is wanted, tried one by one.
  const Controller controller = value_or_throw(make_controller(rated_disturbance(), {}, {}));
  ControllerCam cam = *loop_of(controller, PolynomialBy::outside).find("AscendingSum");
  for (const std::vector<double>& weights :
       {std::vector<double>{1.0, 0.377, -0.61}, {1.0, 200.0, 7.0}, {1.0, -0.02, 0.0}}) {
    cam.weights = weights;
    set_weights_first_exact(cam);
    double least = 1e9;
    for (int out = 1; out <= 255; ++out) {
      double sum = 0.0;
      for (std::size_t i = 1; i < 3; ++i) {
        double best = weights[i] == 0.0 ? 0.0 : 1e9;
        for (int in = 1; in <= 255 && weights[i] != 0.0; ++in)
          best = std::min(best, std::abs(in / static_cast<double>(out) - std::abs(weights[i])));
        sum += best * best;
      }
      least = std::min(least, sum);
    }
    double got = 0.0;
    for (std::size_t i = 1; i < 3; ++i)
      got += std::pow(cam.realised.required_number("gain_" + std::to_string(i + 1)) - weights[i], 2);
    EXPECT_NEAR(got, least, 1e-12) << weights[1];
    EXPECT_DOUBLE_EQ(cam.realised.required_number("gain_1"), 1.0);
  }
}

TEST(ControllerStreams, BytesMakeTheWeights) {
  const Controller controller = value_or_throw(make_controller(rated_disturbance(), {}, {}));
  const ControllerVariant& v = loop_of(controller, PolynomialBy::outside);
  const Plan plan = controller_plan(v);
  const an231::PlanStreams streams = value_or_throw(an231::plan_streams(plan));
  ASSERT_EQ(streams.chips.size(), 1u);
  const an231::BoardCircuit board = an231::read_back(plan, streams);
  const auto& pins = streams.cells;
  const auto cell = [&](const std::string& signal) -> int {
    for (const auto& [pin, name] : pin_signals(v)) {
      if (name == signal) return pins.at(pin);
    }
    return 0;
  };
  const auto gain = [&](const std::string& from, const std::string& to) {
    const auto path = an231::pin_networks(board, {1, cell(from)}, {1, cell(to)});
    return path.gain(Hertz{1e-3}.rad_s()).real();
  };
  const ControllerCam& up = *v.find("AscendingSum");
  const ControllerCam& down = *v.find("DescendingSum");
  EXPECT_NEAR(gain("x2", "AscendingSumHold"), up.realised.required_number("gain_2"), 1e-9);
  EXPECT_NEAR(gain("x3", "AscendingSumHold"), up.realised.required_number("gain_3"), 1e-9);
  EXPECT_NEAR(gain("x2", "DescendingSumHold"), down.realised.required_number("gain_2"), 1e-9);
  EXPECT_NEAR(gain("x3", "DescendingSumHold"), down.realised.required_number("gain_3"), 1e-9);
  EXPECT_NEAR(gain("r", "v"), 1.0, 1e-9);
  EXPECT_NEAR(gain("Branch", "v"), v.find("Output")->realised.required_number("gain_2"), 1e-9);
  // From the drive, which never leaves the chip, to the branch.
  EXPECT_NEAR(gain("r", "DescendingSumHold"), down.realised.required_number("gain_1"), 1e-9);
}

TEST(ControllerStreams, UpdatesAreCapacitorsOnly) {
  const Disturbance d = rated_disturbance();
  const Controller controller = value_or_throw(make_controller(d, {}, {}));
  ControllerStreams made = value_or_throw(controller_streams(loop_of(controller, PolynomialBy::outside), d));
  EXPECT_GT(made.sets, 40u);
  const TemporaryFolder folder;
  OutputSet out(folder.path());
  out.include("stream", made.files);
  out.commit();
  const std::string primary = read_file(folder / "stream/chip1.ahf");
  MemoryImage memory;
  memory.lay_over(decode(from_ahf(primary, "chip1.ahf"), "chip1.ahf"), "chip1.ahf");
  const MemoryImage before = memory;
  const ConfigStream update =
      decode(from_ahf(read_file(folder / "stream/updates/set010_address1.ahf"), "set"), "set");
  EXPECT_FALSE(update.primary);
  memory.lay_over(update, "set");
  int changed = 0;
  for (int bank = 0; bank < MemoryImage::kBanks; ++bank) {
    for (int byte = 0; byte < MemoryImage::kBankBytes; ++byte) {
      if (memory.at(bank, byte) == before.at(bank, byte)) continue;
      ++changed;
      EXPECT_TRUE(bank >= 3 && bank % 2 == 1 && byte < 8) << bank << ":" << byte << " is no capacitor";
    }
  }
  EXPECT_GT(changed, 1);
  EXPECT_LE(changed, 8);
  EXPECT_THAT(read_file(folder / "stream/first_power_on.md"), HasSubstr("not tried on silicon"));
}

/// With the branch switch beside the board the look-up variant is bytes too: the vendor's, as public streams have
/// them in CAB 4 (artecs-group/FPAA-NNs, five primaries), around our table, Cout, clocks and source.
TEST(ControllerStreams, LookupTablesAreThePublicStreamsBytes) {
  const Disturbance d = rated_disturbance();
  ControllerOptions options;
  options.outside_switch = true;
  const Controller controller = value_or_throw(make_controller(d, {}, options));
  const ControllerVariant& v = loop_of(controller, PolynomialBy::lookup);
  EXPECT_EQ(v.find("Slope"), nullptr);
  const Plan plan = controller_plan(v);
  const an231::PlanStreams streams = value_or_throw(an231::plan_streams(plan));
  ASSERT_EQ(streams.chips.size(), 2u);
  struct Byte {
    int bank, byte, value;
  };
  const std::vector<Byte> vendor = {{9, 0x00, 0x80},  {9, 0x01, 0xAA},  {9, 0x06, 0xFF},  {9, 0x07, 0x80},
                                    {9, 0x0F, 0xA8},  {9, 0x10, 0x05},  {9, 0x11, 0x14},  {9, 0x12, 0x2D},
                                    {9, 0x13, 0x48},  {9, 0x1C, 0x02},  {9, 0x1D, 0x14},  {9, 0x1E, 0x00},
                                    {9, 0x1F, 0x10},  {10, 0x00, 0xFE}, {10, 0x09, 0x1B}, {10, 0x0B, 0x03},
                                    {10, 0x0C, 0x01}, {10, 0x0E, 0x01}, {10, 0x0F, 0x48}, {10, 0x16, 0x02},
                                    {10, 0x17, 0x13}, {10, 0x18, 0x00}, {10, 0x19, 0x10}, {10, 0x1A, 0x82},
                                    {10, 0x1B, 0x05}, {10, 0x1C, 0x02}, {10, 0x1D, 0x15}, {10, 0x1E, 0x00},
                                    {10, 0x1F, 0x10}, {1, 0x05, 0x02},  {1, 0x10, 0x09},  {1, 0x11, 0x86},
                                    {1, 0x12, 0xC0},  {1, 0x13, 0x30},  {1, 0x15, 0x02},  {0, 0x08, 0x31}};
  for (std::size_t c = 0; c < 2; ++c) {
    const MemoryImage& memory = streams.chips[c].memory;
    for (const Byte& b : vendor) EXPECT_EQ(memory.at(b.bank, b.byte), b.value) << b.bank << ":" << b.byte;
    const ControllerCam& cam = *v.find(c == 0 ? "AscendingTable" : "DescendingTable");
    const LookupTable table = LookupTable::from(cam.requested);
    EXPECT_EQ(memory.at(9, 0x05), table.cout);
    for (int i = 0; i < 256; ++i) {
      ASSERT_EQ(memory.at(16 + i / 32, i % 32), table.bytes[static_cast<std::size_t>(i)]) << i;
    }
    EXPECT_EQ(an231::read_circuit(memory, 1).lookup_table.at(7), table.bytes[7]);
    // 250 kHz for all CAMs by Clock 3, 4 MHz for the converter by Clock 2.
    EXPECT_EQ(memory.at(0, 0x04), 32);
    EXPECT_EQ(memory.at(0, 0x05), 2);
    EXPECT_EQ(memory.at(10, 0x0D) >> 4, 1);  // the converter's input is let go in phase 2
  }
  EXPECT_THAT(streams.warnings, ::testing::Contains(HasSubstr("copied from what all public streams")));
  const auto made = controller_streams(v, d);
  EXPECT_EQ(refusal_of(made), nullptr);
  const auto& files = std::get<ControllerStreams>(made);
  EXPECT_GT(files.sets, 40u);
  const TemporaryFolder folder;
  OutputSet out(folder.path());
  out.include("stream", files.files);
  out.commit();
  const std::string text = read_file(folder / "stream/first_power_on.md");
  EXPECT_THAT(text, HasSubstr("| chip1 IO1 | wired to chip2 IO"));  // the drive
  EXPECT_THAT(text, Not(HasSubstr("AD835")));
}

TEST(ControllerStreams, UnknownSwitchesAreNamed) {
  const Disturbance d = rated_disturbance();
  const Controller controller = value_or_throw(make_controller(d, {}, {}));
  const auto outcome = controller_streams(loop_of(controller, PolynomialBy::lookup), d);
  const Refusal* refusal = refusal_of(outcome);
  ASSERT_NE(refusal, nullptr);
  EXPECT_THAT(refusal->reason, HasSubstr("not publicly known"));
  // Its gains are in the table of sets all the same.
  EXPECT_THAT(gain_sets_csv(loop_of(controller, PolynomialBy::lookup), d),
              HasSubstr("DescendingGain_Cin_units"));
}

TEST(ControllerStreams, SetsAreNearEnough) {
  const Disturbance d = rated_disturbance();
  const std::vector<Hertz> sets = gain_set_frequencies(d);
  for (double f = 1.0; f < 100.0; f *= 1.07) {
    const Hertz served = serving_frequency(sets, {f});
    for (const auto branch : {Disturbance::Branch::ascending, Disturbance::Branch::descending}) {
      EXPECT_NEAR(d.rate_gain(branch, served) / d.rate_gain(branch, {f}), 1.0, 0.0027) << f;
    }
  }
  EXPECT_EQ(serving_frequency({}, {7.0}).value, 7.0);
}

/// What stands off the board, by its voltages.
TEST(ControllerNetlist, PartsOffTheBoardAreExpressions) {
  using enum OutsidePart::Kind;
  ControllerVariant variant;
  variant.scale = {2.5, 0.75};
  variant.outside = {{reference, "r", {}, 0.0},
                     {constant, "c", {}, 1.5},
                     {multiplier, "m", {"r", "c"}, 0.25},
                     {switched, "s", {"m", "c"}, 0.0}};
  variant.drive = "s";
  const std::string text = controller_netlist(variant, {}, "title");
  for (const char* volts : {"2.5*(V(r)-0.75)", "=1.5\n", "0.25*V(o_r)*V(o_c)",
                            "V(rising)*V(o_m)+(1-V(rising))*V(o_c)", "V(o_s)/2.5+0.75"})
    EXPECT_THAT(text, HasSubstr(volts)) << text;
}

}  // namespace
}  // namespace bodesmith::fpaa
