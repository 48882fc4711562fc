// From the bytes of a stream to the waveform at the pin, by nothing but the memory map: a decoder and a solver of
// charges in this file, which share no code with the plan or with the library's solver.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <sstream>

#include "fpaa/plan/switched_board.hpp"
#include "fpaa/seed_sections.hpp"
#include "fpaa/streams/plan_stream.hpp"
#include "fpaa/streams/stream_file.hpp"
#include "fpaa/streams/stream_output.hpp"

namespace bodesmith::fpaa {
namespace {

/// 24 banks of 32 bytes out of an AHF text.
class OracleMemory {
 public:
  explicit OracleMemory(const std::string& ahf) {
    std::vector<int> bytes;
    std::istringstream in(ahf);
    for (std::string word; in >> word;) bytes.push_back(std::stoi(word, nullptr, 16));
    std::size_t at = 0;
    while (bytes[at] != 0xD5) ++at;
    at += 7;  // synch, device id, Address1, control
    for (bool more = true; more;) {
      const int head = bytes[at];
      more = (head & 0x40) != 0;
      const std::size_t address = static_cast<std::size_t>(32 * bytes[at + 1] + (head & 0x1F));
      const std::size_t count = bytes[at + 2] == 0 ? 256 : static_cast<std::size_t>(bytes[at + 2]);
      for (std::size_t i = 0; i < count; ++i) memory_[address + i] = bytes[at + 3 + i];
      at += 4 + count;
    }
  }
  int at(int bank, int byte) const { return memory_[static_cast<std::size_t>(32 * bank + byte)]; }

 private:
  std::array<int, 24 * 32> memory_{};
};

constexpr int kOracleInput = 100;
constexpr int kOracleGround = -1;
constexpr int kOracleOpen = -2;

/// What a plate is joined to: op-amp 2(cab - 1) + n - 1, the input, ground, nothing.
int near_node(const OracleMemory& m, int cab, int selector) {
  const auto amp = [](int of_cab, int n) { return 2 * (of_cab - 1) + n - 1; };
  const int a = 2 * cab + 2;
  switch (selector) {
    case 0:
      return kOracleOpen;
    case 1:
      return kOracleGround;
    case 2:
    case 3:
      return amp(cab, selector == 3 ? 1 : 2);
    case 6:
    case 7: {
      const int line = m.at(a, selector == 7 ? 5 : 4);
      for (int other = cab % 2 == 1 ? 1 : 2; other <= 4; other += 2) {
        const int drives = m.at(2 * other + 2, 2);
        if ((drives & (line == 1 ? 0x01 : 0x08)) != 0) return amp(other, 1);
        if ((drives & (line == 1 ? 0x02 : 0x10)) != 0) return amp(other, 2);
      }
      return kOracleInput;
    }
    default:
      break;
  }
  // Pairs 9/8, B/A, D/C, F/E: the odd one is op-amp 1 (or the direct line 1); 0: a direct line.
  static const int from[4][4] = {{0, 3, 4, 2}, {0, 1, 3, 4}, {2, 1, 0, 4}, {2, 1, 3, 0}};
  const int other = from[cab - 1][(selector - 8) / 2];
  return other == 0 ? kOracleInput : amp(other, selector % 2 == 1 ? 1 : 2);
}

struct OracleCapacitor {
  double units = 0.0;
  std::array<int, 2> near{}, far{};  ///< by phase; far: an op-amp's inverting input
  double volts = 0.0;
};

std::vector<OracleCapacitor> capacitors_of(const OracleMemory& m) {
  // Switch words of C1 to C8: bank A (0) or B (1), first byte.
  static const int place[8][2] = {{1, 0x1C}, {0, 0x1C}, {1, 0x16}, {0, 0x18},
                                  {1, 0x10}, {0, 0x14}, {1, 0x0C}, {0, 0x10}};
  std::vector<OracleCapacitor> out;
  for (int cab = 1; cab <= 4; ++cab) {
    for (int c = 0; c < 8; ++c) {
      OracleCapacitor made;
      made.units = m.at(2 * cab + 1, 7 - c);
      if (made.units == 0.0) continue;
      const int bank = 2 * cab + 1 + place[c][0];
      const int byte = place[c][1];
      for (int phase = 0; phase < 2; ++phase) {
        const auto nibble = [&](int word) {
          const int nodes = m.at(bank, byte + 2 * word + 1);
          const bool clocked = m.at(bank, byte + 2 * word) != 0;
          return clocked && phase == 0 ? nodes & 15 : nodes >> 4;
        };
        const auto p = static_cast<std::size_t>(phase);
        made.near[p] = near_node(m, cab, nibble(0));
        const int far = nibble(1);
        made.far[p] = far == 8 ? kOracleGround : far == 0 ? kOracleOpen : 2 * (cab - 1) + far - 1;
      }
      out.push_back(made);
    }
  }
  return out;
}

/// The op-amp that drives IO3.
int oracle_output(const OracleMemory& m) {
  for (const auto& [byte, cab] : {std::pair{3, 3}, std::pair{1, 4}}) {
    const int nibble = m.at(2, byte) >> 4;
    if (nibble == 0xC || nibble == 0x8) return 2 * (cab - 1) + (nibble == 0xC ? 0 : 1);
    if (nibble != 5 && nibble != 6) continue;
    for (int other = cab % 2 == 1 ? 1 : 2; other <= 4; other += 2) {
      const int drives = m.at(2 * other + 2, 2);
      if ((drives & (nibble == 5 ? 0x01 : 0x08)) != 0) return 2 * (other - 1);
      if ((drives & (nibble == 5 ? 0x02 : 0x10)) != 0) return 2 * (other - 1) + 1;
    }
  }
  return -1;
}

/// Every op-amp's voltage while the switches stand in a phase: sum C V(near) = sum C V(carried) at each.
class OraclePhase {
 public:
  OraclePhase(const std::vector<OracleCapacitor>& all, std::size_t phase) : phase_(phase) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(8, 8);
    for (int k = 0; k < 8; ++k) {
      bool fed = false;
      for (const OracleCapacitor& c : all) {
        if (c.far[phase] != k || c.near[phase] == kOracleOpen) continue;
        fed = true;
        if (c.near[phase] >= 0 && c.near[phase] < 8) a(k, c.near[phase]) += c.units;
      }
      if (!fed) a(k, k) = 1.0;
    }
    lu_ = a.partialPivLu();
  }
  Eigen::VectorXd volts(const std::vector<OracleCapacitor>& all, double input) const {
    Eigen::VectorXd right = Eigen::VectorXd::Zero(8);
    for (const OracleCapacitor& c : all) {
      if (c.far[phase_] < 0 || c.near[phase_] == kOracleOpen) continue;
      right(c.far[phase_]) += c.units * c.volts;
      if (c.near[phase_] == kOracleInput) right(c.far[phase_]) -= c.units * input;
    }
    return lu_.solve(right);
  }
  void end(std::vector<OracleCapacitor>& all, double input) const {
    const Eigen::VectorXd v = volts(all, input);
    for (OracleCapacitor& c : all) {
      const int near = c.near[phase_];
      if (near == kOracleOpen || c.far[phase_] == kOracleOpen) continue;
      c.volts = near == kOracleInput ? input : near == kOracleGround ? 0.0 : v(near);
    }
  }

 private:
  std::size_t phase_;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
};

TEST(StreamOracle, BytesOfAChainMakeTheWaveformThatThePlanStates) {
  const Plan& plan = seed_plan();
  const an231::PlanStreams streams = value_or_throw(an231::plan_streams(plan));
  ASSERT_EQ(streams.chips.size(), 1U);
  ASSERT_EQ(streams.chips[0].built.pins.at("out1"), 3);
  const OutputSet files = an231::configuration_files(streams, "plan.json");
  const OracleMemory memory(*files.content("chip1.ahf"));
  std::vector<OracleCapacitor> all = capacitors_of(memory);
  ASSERT_GT(all.size(), 16U);
  const int output = oracle_output(memory);
  ASSERT_GE(output, 0);
  // Clock of CAB 1: behind sys1.
  const auto divisor = [](int byte) { return byte == 0 ? 1 : 2 * byte; };
  const int clock = memory.at(4, 0) & 15;
  ASSERT_GE(clock, 0xC);
  const double period = divisor(memory.at(0, 9)) * divisor(memory.at(0, 7 - (clock - 0xC))) / 16e6;
  EXPECT_NEAR(period, 1.0 / 2000.0, 1e-12);

  const OraclePhase phases[] = {{all, 0}, {all, 1}};
  constexpr int kTurn = 25;       // periods of a sine of 80 Hz
  constexpr int kSettle = 20000;  // the slowest pole, 14 rad/s, has a time constant of 143 periods
  const double w = 2.0 * std::numbers::pi / (kTurn * period);
  // Gauss and Legendre's five points: a phase is a constant and a 50th of a sine.
  static const double node[] = {0.0, 0.5384693101056831, 0.9061798459386640};
  static const double weight[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  std::complex<double> got = 0.0;
  for (int n = 0; n < kSettle + kTurn; ++n) {
    for (int phase = 0; phase < 2; ++phase) {
      const double middle = (n + 0.25 + 0.5 * phase) * period;
      for (int i = -2; i <= 2 && n >= kSettle; ++i) {
        const int k = std::abs(i);
        const double t = middle + 0.25 * period * std::copysign(node[k], i);
        const double v = phases[phase].volts(all, std::cos(w * t))(output);
        got += 2.0 * v * std::polar(0.25 * weight[k] / kTurn, -w * t);
      }
      phases[phase].end(all, std::cos(w * (middle + 0.25 * period)));
    }
  }
  const std::complex<double> wanted = SwitchedBoard(plan).gain({w});
  EXPECT_LT(std::abs(got - wanted), 1e-8 * std::abs(wanted)) << got << " " << wanted;
}

}  // namespace
}  // namespace bodesmith::fpaa
