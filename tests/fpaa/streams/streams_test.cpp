// Complete AN231 streams: facts an231, parts 1 to 5.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/error.hpp"
#include "fpaa/an231_streams.hpp"
#include "fpaa/device/circuit.hpp"
#include "fpaa/streams/board_networks.hpp"
#include "fpaa/streams/c_source.hpp"
#include "fpaa/streams/netlist.hpp"
#include "fpaa/streams/stream_file.hpp"

namespace bodesmith::fpaa::an231 {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

BoardCircuit board_of(const MemoryImage& memory) {
  BoardCircuit out;
  out.chips = {read_circuit(memory, 1)};
  return out;
}

Complex one_over_z(double hz, double clock) {
  return std::polar(1.0, -2.0 * M_PI * hz / clock);
}

/// From pin to pin of chip 1, as its switches make it.
Complex gain_between(const BoardCircuit& board, int from, int to, double hz) {
  return pin_networks(board, {1, from}, {1, to}).gain(Hertz{hz}.rad_s());
}

/// Stages of one clock in phase 1 (facts switches): h from the end of phase 1 to the end of phase 1, d1 and d2 what
/// follows the input at once in phase 1 and in phase 2.
Complex followed(Complex h, double d1, double d2, double hz, double clock) {
  const double turn = M_PI * hz / clock;
  const Complex a = (std::polar(1.0, turn) - 1.0) / Complex(0.0, 2.0 * turn);
  return h * std::sin(turn) / turn + 0.5 * (d1 + d2) - d1 * a - d2 * std::conj(a);
}

/// The chain of pole_zero_stages() by that form.
Complex pole_zero_chain(int stages, double hz) {
  const Complex d = 1.0 - one_over_z(hz, 250e3);
  Complex h = 1.0;
  double d1 = 1.0;
  double d2 = 1.0;
  for (int i = 0; i < stages; ++i) {
    const double ca = 3.0 + i, cb = 120.0 + 7 * i, cc = 2.0 + i, cd = 200.0 - 9 * i;
    h *= -(ca + cb * d) / (cc + cd * d);
    d1 *= -(ca + cb) / (cc + cd);
    d2 *= -cb / cd;
  }
  return followed(h, d1, d2, hz, 250e3);
}

std::string refusal_text(const Plan& plan, const PinCells& cells = {}) {
  const auto outcome = plan_streams(plan, cells);
  const Refusal* refusal = refusal_of(outcome);
  return refusal == nullptr ? "" : refusal->reason;
}

TEST(CSource, WordsSymbolsCommentsAndTheirLines) {
  const auto tokens = c_tokens("int a_1 = 0x1F; // end\n/* two\nlines */ \"x\\\"y\" b[2] = {3", "a.c");
  std::string all;
  for (const CToken& token : tokens) all += std::string(token.text) + "@" + std::to_string(token.line) + " ";
  EXPECT_EQ(all, "int@1 a_1@1 =@1 0x1F@1 ;@1 end@1 two\nlines@2 b@3 [@3 2@3 ]@3 =@3 {@3 3@3 ");
  EXPECT_EQ(tokens[5].kind, CToken::Kind::comment);
  EXPECT_EQ(c_integer(tokens[3], 31, "a.c"), 31);
  EXPECT_THROW(c_integer(tokens[3], 30, "a.c"), InputError);
  EXPECT_THROW(c_integer(tokens[0], 99, "a.c"), InputError);
  EXPECT_EQ(c_integer(tokens.back(), 3, "a.c"), 3);
  std::size_t at = 7;
  EXPECT_TRUE(opens_array(tokens, at));
  EXPECT_EQ(tokens[at].text, "3");
  at = 1;
  EXPECT_FALSE(opens_array(tokens, at));
  EXPECT_EQ(at, 1u);
  for (const char* broken : {"/* no end", "\"no end", "'no\nend'"})
    EXPECT_THROW(c_tokens(broken, "a.c"), InputError);
  EXPECT_EQ(c_tokens("// last", "a.c").front().text, "last");
}

TEST(An231Stream, WorkedExampleIsMadeByteForByte) {
  const BuiltChip chip =
      built(chain_of({cam_of("FilterBilinear", "Low Pass", {{"Cin", 12}, {"Cout", 12}, {"Cint", 185}})}));
  EXPECT_EQ(chip.pins.at("chip1.in1"), 1);
  EXPECT_EQ(chip.pins.at("chip1.out1"), 3);
  EXPECT_EQ(encode(primary_stream(chip.memory, 1, StreamForm::sparse)), worked_example());
  const Bytes whole = encode(primary_stream(chip.memory, 1, StreamForm::whole));
  EXPECT_EQ(whole.size(), 801u);
  MemoryImage back;
  back.lay_over(decode(whole, "x"), "x");
  EXPECT_EQ(back, chip.memory);
  EXPECT_TRUE(is_written_by(decode(whole, "x"), StreamForm::whole));
}

TEST(An231Stream, WorkedExampleIsReadBack) {
  MemoryImage memory;
  memory.lay_over(decode(worked_example(), "x"), "x");
  const BoardCircuit board = board_of(memory);
  const ChipCircuit& chip = board.chips[0];
  EXPECT_THAT(chip.problems, IsEmpty());
  EXPECT_THAT(chip.notes, IsEmpty());
  EXPECT_THAT(chip.unexplained, IsEmpty());
  EXPECT_EQ(chip.constants.size(), 8u);
  EXPECT_EQ(chip.clock(0, {16e6}).value, 250e3);
  const auto stages = stage_transfers(board);
  ASSERT_EQ(stages.size(), 1u);
  EXPECT_THAT(stages[0].denominator, ElementsAre(197, -185));
  EXPECT_THAT(stages[0].numerators[0], ElementsAre(-12));
  // The corner of the facts: 250 kHz/pi atan(12/382), where it is 3 dB down on the bilinear image's frequency.
  const double corner = 250e3 / M_PI * std::atan(12.0 / 382.0);
  EXPECT_NEAR(corner, 2499.0, 0.5);
  for (const double hz : {1.0, corner, 60e3}) {
    const Complex wanted = -12.0 / (12.0 + 185.0 * (1.0 - one_over_z(hz, 250e3)));
    EXPECT_LT(std::abs(gain_between(board, 1, 3, hz) - followed(wanted, -12.0 / 197.0, 0.0, hz, 250e3)),
              1e-12);
  }
}

TEST(An231Stream, BlocksOfCArrays) {
  MemoryImage memory;
  const auto blocks_of = [&](std::initializer_list<int> where) {
    memory = {};
    for (const int i : where) memory.set(i / 32, i % 32, 7);
    return sparse_blocks(memory);
  };
  EXPECT_EQ(blocks_of({10, 15}).size(), 1u);  // four zeros between
  EXPECT_EQ(blocks_of({10, 16}).size(), 2u);  // five
  EXPECT_EQ(blocks_of({31, 32})[0].data.size(), 2u);
  memory = {};
  for (int i = 0; i < 300; ++i) memory.set(i / 32, i % 32, 1);
  const auto blocks = sparse_blocks(memory);
  ASSERT_EQ(blocks.size(), 2u);
  EXPECT_EQ(blocks[0].data.size(), 256u);
  EXPECT_EQ(whole_blocks(memory).size(), 5u);
}

TEST(An231Stream, EightPoleZeroStagesAreTheProductOfTheirFractions) {
  const BuiltChip chip = built(chain_of(pole_zero_stages(8)));
  EXPECT_EQ(chip.memory.at(kIoBank, 0x01), 0x80);  // IO3 from op-amp 2 of CAB 4
  const BoardCircuit board = board_of(chip.memory);
  EXPECT_THAT(board.chips[0].problems, IsEmpty());
  EXPECT_THAT(board.chips[0].unexplained, IsEmpty());
  double worst = 0.0;
  for (double hz = 1.0; hz < 125e3; hz *= 1.7)
    worst = std::max(worst, std::abs(gain_between(board, 1, 3, hz) / pole_zero_chain(8, hz) - 1.0));
  EXPECT_LT(worst, 1e-12);
}

TEST(An231Stream, RecipesAsInTheFacts) {
  // Facts, part 2: two pole-zero stages in CAB 1 fill A 10-1F and B 0C-1F with these words.
  const BuiltChip chip = built(chain_of(pole_zero_stages(2)));
  const std::vector<int> a = {0x01, 0x12, 0x01, 0x82, 0x01, 0x13, 0x01, 0x82,
                              0x01, 0x13, 0x01, 0x81, 0x01, 0x19, 0x01, 0x81};
  const std::vector<int> b = {0x00, 0x20, 0x00, 0x20, 0x00, 0x30, 0x00, 0x20, 0x00, 0x05,
                              0x00, 0x30, 0x00, 0x10, 0x00, 0x05, 0x00, 0x90, 0x00, 0x10};
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(chip.memory.at(3, 0x10 + static_cast<int>(i)), a[i]);
  for (std::size_t i = 0; i < b.size(); ++i) EXPECT_EQ(chip.memory.at(4, 0x0C + static_cast<int>(i)), b[i]);
  // Cc Cd Ca Cb of the second, then of the first.
  const std::vector<int> units = {3, 191, 4, 127, 2, 200, 3, 120};
  for (std::size_t i = 0; i < units.size(); ++i) EXPECT_EQ(chip.memory.at(3, static_cast<int>(i)), units[i]);
}

TEST(An231Stream, HoldsDelayAndHalfPeriodOutputsAreSampled) {
  // Gain and hold in phase 1: the sample of a period before.
  const BuiltChip held =
      built(chain_of({cam_of("GainInv", "", {{"Cin", 3}, {"Cout", 2}}), cam_of("Hold", "", {})}));
  const std::vector<StageTransfer> made = stage_transfers(board_of(held.memory));
  ASSERT_EQ(made.size(), 2u);
  EXPECT_THAT(made[0].numerators[0], ElementsAre(-3));
  EXPECT_THAT(made[0].denominator, ElementsAre(2));
  EXPECT_THAT(made[1].numerators[0], ElementsAre(0, 1));
  EXPECT_THAT(made[1].denominator, ElementsAre(1));
  // Sampled at the end of phase 1, shown for a period from then on: the middle of it is half a period later.
  const double turn = M_PI * 5e3 / 250e3;
  const Complex wanted = -1.5 * std::sin(turn) / turn * std::polar(1.0, -turn);
  EXPECT_LT(std::abs(gain_between(board_of(held.memory), 1, held.pins.at("chip1.out1"), 5e3) - wanted),
            1e-12);

  const BuiltChip half = built(chain_of({cam_of("GainHalf", "", {{"Cin", 5}, {"Cout", 4}})}));
  const ChipCircuit chip = read_circuit(half.memory, 1);
  const IoCell& out = chip.cell(half.pins.at("chip1.out1"));
  EXPECT_EQ(out.mode, IoCell::Mode::sampled_output);
  EXPECT_EQ(out.sample_phase, 1);
  EXPECT_EQ(half.memory.at(kIoBank, 0x0C), 0x46);  // IO3 samples by Clock 0 in phase 1
  EXPECT_THAT(stage_transfers(board_of(half.memory)).at(0).numerators[0], ElementsAre(-5));
  // Followed in phase 1, kept in phase 2.
  EXPECT_LT(
      std::abs(gain_between(board_of(half.memory), 1, 3, 5e3) - followed(-1.25, -1.25, 0.0, 5e3, 250e3)),
      1e-12);

  // It never feeds a static branch.
  auto stages = pole_zero_stages(1);
  stages.insert(stages.begin(), cam_of("GainHalf", "", {{"Cin", 5}, {"Cout", 4}}));
  EXPECT_THAT(refusal_text(chain_of(stages)), HasSubstr("static branch"));
  // A hold that samples in the other phase reads zero.
  EXPECT_THAT(
      refusal_text(chain_of({cam_of("GainHalf", "", {{"Cin", 5}, {"Cout", 4}}), cam_of("Hold", "", {}, 2)})),
      HasSubstr("valid in phase 1"));
  // With a hold of its own phase all is well.
  const BuiltChip good = built(chain_of(
      {cam_of("GainHalf", "", {{"Cin", 5}, {"Cout", 4}}), cam_of("Hold", "", {}), pole_zero_stages(1)[0]}));
  EXPECT_THAT(read_circuit(good.memory, 1).problems, IsEmpty());
}

TEST(An231Stream, WhatCannotBePlacedIsRefused) {
  auto chip = chain_of(pole_zero_stages(3));
  chip.chips[0].cams[2].cab = 1;
  EXPECT_THAT(refusal_text(chip), HasSubstr("3 op-amps"));
  chip = chain_of({cam_of("FilterBilinear", "Low Pass", {{"Cin", 12}, {"Cout", 0}, {"Cint", 185}})});
  EXPECT_THAT(refusal_text(chip), HasSubstr("capacitor Cout of chip1.Stage1 is 0 units"));
  chip = chain_of(pole_zero_stages(2));
  EXPECT_THAT(refusal_text(chip, {{"chip1.in1", 3}, {"chip1.out1", 3}}), HasSubstr("no choice of I/O cells"));
  chip = chain_of(pole_zero_stages(4));
  chip.chips[0].cams[1].clock_index = 1;
  chip.chips[0].cams[1].clock_a = {500e3};
  EXPECT_EQ(refusal_text(chip), "");  // ClockB
}

TEST(An231Stream, EveryChoiceOfCellsThatIsMadeWorks) {
  for (int in = 1; in <= kIoCells; ++in) {
    for (int out = 1; out <= kIoCells; ++out) {
      if (in == out) continue;
      for (const int stages : {1, 3, 6, 8}) {
        const BuiltChip made =
            built(chain_of(pole_zero_stages(stages)), {{"chip1.in1", in}, {"chip1.out1", out}});
        const BoardCircuit board = board_of(made.memory);
        EXPECT_THAT(board.chips[0].problems, IsEmpty());
        EXPECT_THAT(board.chips[0].unexplained, IsEmpty());
        EXPECT_LT(std::abs(gain_between(board, in, out, 1e3) / pole_zero_chain(stages, 1e3) - 1.0), 1e-12);
      }
    }
  }
}

TEST(An231Stream, CollisionsInAStreamAreNamed) {
  const BuiltChip made = built(chain_of(pole_zero_stages(8)));
  const auto problems_after = [&](int bank, int byte, int value) {
    MemoryImage memory = made.memory;
    memory.set(bank, byte, value);
    std::string all;
    for (const std::string& p : read_circuit(memory, 1).problems) all += p + "\n";
    return all;
  };
  EXPECT_THAT(problems_after(4, 0x02, 0x03), HasSubstr("column line 1 (odd) has two drivers"));
  EXPECT_THAT(problems_after(2, 0x07, 0x11), IsEmpty());  // IO2 is off: a nibble without a cell
  EXPECT_THAT(problems_after(2, 0x03, 0xC0), HasSubstr("IO3 is an output with two drivers"));
  EXPECT_THAT(problems_after(2, 0x01, 0x00), HasSubstr("IO3 is an output that nothing drives"));
  EXPECT_THAT(problems_after(2, 0x07, 0x20), HasSubstr("reads a line that nothing drives"));
  EXPECT_THAT(problems_after(4, 0x1B, 0x00), HasSubstr("which is off"));
  EXPECT_THAT(problems_after(4, 0x00, 0x0D), HasSubstr("Clock 1, which is off"));
  EXPECT_THAT(problems_after(0, 0x0A, 0x04), HasSubstr("expected equal divisors"));
}

TEST(An231Stream, ASwitchedCapacitorWithoutUnitsIsNamedByEachOfItsBytes) {
  for (int cab = 1; cab <= kCabs; ++cab) {
    for (int c = 1; c <= kCapacitors; ++c) {
      const Address at = switches_at(cab, c);
      for (int k = 0; k < 4; ++k) {
        MemoryImage memory;
        memory.set(at.bank, at.byte + k, 0x01);
        std::string named;
        for (const std::string& p : read_circuit(memory, 1).problems) {
          if (p.find("zero units") != std::string::npos) named += p;
        }
        EXPECT_EQ(named,
                  "CAB " + std::to_string(cab) + " C" + std::to_string(c) + " is switched but has zero units")
            << k;
      }
    }
  }
}

TEST(An231Stream, ChangesOfOneBitAreNoticed) {
  // Facts, part 5: of the single-bit changes of an eight-stage stream all but those of unused clocks' divisors,
  // extra power bits, nibbles without a cell and equivalent routes are noticed.
  const BuiltChip made = built(chain_of(pole_zero_stages(8)));
  const Bytes bytes = encode(primary_stream(made.memory, 1, StreamForm::sparse));
  const auto response = [](const BoardCircuit& b) {
    std::vector<Complex> out;
    for (const double hz : {10.0, 1e3, 20e3}) out.push_back(gain_between(b, 1, 3, hz));
    return out;
  };
  const std::vector<Complex> wanted = response(board_of(made.memory));
  int unnoticed = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes changed = bytes;
      changed[i] = static_cast<std::uint8_t>(changed[i] ^ (1 << bit));
      try {
        const ConfigStream stream = decode(changed, "x");
        MemoryImage memory;
        memory.lay_over(stream, "x");
        const BoardCircuit board = board_of(memory);
        const ChipCircuit& chip = board.chips[0];
        if (!stream.primary || stream.address1 != 1 || stream.control != kPrimaryControl) continue;
        if (!chip.problems.empty() || !chip.notes.empty() || !chip.unexplained.empty()) continue;
        const auto got = response(board);
        bool same = true;
        for (std::size_t k = 0; k < got.size(); ++k) same = same && std::abs(got[k] / wanted[k] - 1.0) < 1e-9;
        if (same) ++unnoticed;
      } catch (const InputError&) {
      }
    }
  }
  EXPECT_LE(unnoticed, 40);
}

TEST(An231Stream, FilesOfEveryFormAreFound) {
  const Bytes& bytes = worked_example();
  std::string source = "const unsigned char other[] = { 1, 2, 3 };\nconst x_Byte a[85] = { /* synch */ ";
  for (const std::uint8_t b : bytes) source += std::to_string(b) + ", ";
  source += "};\nint names[2] = { FPAA1, FPAA2 };\n";
  for (const std::string& content :
       {to_ahf(bytes), source, to_packet(bytes, true), std::string(bytes.begin(), bytes.end())}) {
    const auto found = find_streams(content, "x");
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].bytes, bytes);
  }
  EXPECT_THROW(find_streams("", "x"), InputError);
  EXPECT_THROW(find_streams("int main() { return 0; }", "x"), InputError);
  EXPECT_THROW(find_streams(std::string("\0\0\0", 3), "x"), InputError);
  // An update goes over its primary, a second primary is another board.
  auto streams = find_streams(to_ahf(bytes), "a");
  streams.push_back(find_streams(to_ahf({0xD5, 0x01, 0x80, 0x85, 0x03, 0x01, 0xC8, 0x2A}), "b")[0]);
  const auto boards = load_boards(streams);
  ASSERT_EQ(boards.size(), 1u);
  EXPECT_EQ(boards[0].chips[0].memory.at(3, 5), 0xC8);
  streams.push_back(streams[0]);
  EXPECT_EQ(load_boards(streams).size(), 2u);
}

TEST(An231Stream, WrongStreamsAreRefusedWithTheByte) {
  const auto message = [](const Bytes& bytes) -> std::string {
    try {
      find_streams(to_ahf(bytes), "x.ahf");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  Bytes bad = worked_example();
  bad[1] = 0xB6;  // another chip's device id
  EXPECT_THAT(message(bad), HasSubstr("x.ahf: byte 1: is B6, expected B7 (the AN231 device id)"));
  bad = worked_example();
  bad[24] = 0x2B;
  EXPECT_THAT(message(bad), HasSubstr("byte 24: is 2B, expected 2A"));
  bad = worked_example();
  bad.resize(40);
  EXPECT_THAT(message(bad), HasSubstr("byte 40: the stream ends"));
  bad = worked_example();
  bad[8] = 0x17;  // the first block beyond the last bank
  EXPECT_EQ(message(bad), "");
  MemoryImage memory;
  bad[8] = 0x18;
  try {
    memory.lay_over(decode(bad, "x"), "x");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("x: byte 7: the block runs from bank 24"));
  }
}

TEST(An231Stream, MutatedStreamsNeverCrash) {
  const std::vector<Bytes> seeds = {
      worked_example(),
      encode(primary_stream(built(chain_of(pole_zero_stages(8))).memory, 1, StreamForm::sparse))};
  std::mt19937 random(20261122);
  int answered = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes bytes = seeds[random() % 8 == 0 ? 1 : 0];
    const int changes = 1 + static_cast<int>(random() % 3);
    for (int k = 0; k < changes; ++k) {
      const std::size_t at = random() % bytes.size();
      switch (random() % 4) {
        case 0:
          bytes[at] = static_cast<std::uint8_t>(random());
          break;
        case 1:
          bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1U << random() % 8));
          break;
        case 2:
          if (random() % 8 == 0) bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at));
          break;
        default:
          if (random() % 8 == 0) bytes.resize(at + 1);
      }
    }
    try {
      const ConfigStream stream = decode(bytes, "x");
      EXPECT_EQ(encode(stream), bytes);
      MemoryImage memory;
      memory.lay_over(stream, "x");
      const BoardCircuit board = board_of(memory);
      if (trial % 4 == 0) {
        try {
          for (const double hz : {1.0, 1e3}) {
            const Complex value = gain_between(board, 1, 3, hz);
            ++answered;
            EXPECT_TRUE(std::isfinite(value.real()) && std::isfinite(value.imag()));
          }
        } catch (const DesignError&) {  // no way, or a voltage left open
        }
      }
      if (trial % 10 == 0) {
        for (const StageTransfer& stage : stage_transfers(board)) {
          for (const double c : stage.denominator) EXPECT_TRUE(std::isfinite(c));
        }
      }
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("x: byte "));
    }
  }
  EXPECT_GT(answered, 1000);
}

TEST(An231Stream, MutatedFilesNeverCrash) {
  const Bytes& bytes = worked_example();
  std::string source = "const unsigned char a[85] = { ";
  for (const std::uint8_t b : bytes) source += std::to_string(b) + ", ";
  source += "};\n";
  const std::vector<std::string> seeds = {to_ahf(bytes), source, to_packet(bytes, true),
                                          std::string(bytes.begin(), bytes.end())};
  std::mt19937 random(14);
  for (int trial = 0; trial < 8000; ++trial) {
    std::string text = seeds[random() % seeds.size()];
    for (int k = 0; k < 2; ++k) text[random() % text.size()] = static_cast<char>(random());
    if (random() % 8 == 0) text.resize(random() % text.size());
    try {
      for (const FoundStream& found : find_streams(text, "x")) EXPECT_EQ(encode(found.stream), found.bytes);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace bodesmith::fpaa::an231
