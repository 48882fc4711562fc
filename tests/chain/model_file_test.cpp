#include "chain/model_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "chain/kernel.hpp"
#include "chain/registry.hpp"
#include "hysteresis/model_type.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::chain {
namespace {

Chain parse(const std::string& text) {
  return model_from_node(parse_toml(text, "model.toml"));
}

std::string complaint(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

constexpr const char* kHead = "schema = \"bodesmith.model/1\"\n";

TEST(ModelFile, ReadsTheContractsExample) {
  const Chain chain = parse(std::string(kHead) + R"(
[[block]]                  # blocks in series, input first
type = "gain"
gain = 6.92
offset = 0.0
free = ["gain"]
)");
  ASSERT_EQ(chain.blocks.size(), 1u);
  EXPECT_EQ(chain.blocks[0].type_name(), "gain");
  EXPECT_EQ(chain.blocks[0].get("gain"), 6.92);
  EXPECT_TRUE(chain.blocks[0].parameters()[0].free);
  EXPECT_FALSE(chain.blocks[0].parameters()[1].free);
  EXPECT_EQ(chain.label(chain.blocks[0].parameters()[0]), "block 1 (gain) gain");
}

TEST(ModelFile, EveryBlockOfTheContractIsThere) {
  for (const char* name :
       {"gain", "lowpass", "pole_zero", "fractional_lead_lag", "resonator", "delay", "saturation",
        "slew_limit", "dead_zone", "backlash", "polynomial", "creep", "hum", "drift", "sample_hold"}) {
    EXPECT_NE(block_type_registry().find(name), nullptr) << name;
  }
  for (const hysteresis::ModelType* model : hysteresis::model_type_registry().all())
    EXPECT_NE(block_type_registry().find(model->name()), nullptr) << model->name();
}

TEST(ModelFile, WrittenTextReadsBackAsTheSameChain) {
  Chain chain;
  chain.blocks.push_back(make_block("gain").set("gain", 1.0 / 3.0).set("offset", -1e-12));
  chain.blocks.push_back(make_block("polynomial").set("coefficients", std::vector<double>{0.1, 1.0, -0.25}));
  chain.blocks.push_back(make_block("creep")
                             .set("gains", std::vector<double>{0.1, 0.2})
                             .set("time_constants_s", std::vector<double>{1.0, 30.0}));
  chain.blocks.push_back(make_block("sample_hold").set("clock_hz", 2000.0).set("half_cycle", 1.0));
  chain.blocks.push_back(make_block("saturation").set("lower", -3.0).set("upper", 3.0));
  EXPECT_TRUE(chain.blocks[1].free("coefficients[1]"));
  EXPECT_TRUE(chain.blocks[2].free("gains"));
  EXPECT_TRUE(chain.blocks[2].free("time_constants_s[0]"));
  EXPECT_FALSE(chain.blocks[2].free("time_constants_s[7]"));
  const std::string text = model_text(chain, "made by a test\nin two lines");
  EXPECT_NE(text.find("# made by a test\n# in two lines\n"), std::string::npos);
  EXPECT_NE(text.find("half_cycle = true"), std::string::npos);
  const Chain back = parse(text);
  ASSERT_EQ(back.blocks.size(), chain.blocks.size());
  for (size_t i = 0; i < chain.blocks.size(); ++i) {
    const auto& a = chain.blocks[i].parameters();
    const auto& b = back.blocks[i].parameters();
    ASSERT_EQ(a.size(), b.size());
    for (size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a[k].name(), b[k].name());
      EXPECT_EQ(a[k].value, b[k].value);
      EXPECT_EQ(a[k].free, b[k].free) << a[k].name();
    }
  }
  EXPECT_EQ(model_text(back), model_text(chain));
}

TEST(ModelFile, KeepsWhatTheRecordsShowed) {
  Chain chain;
  chain.blocks = {make_block("gain")};
  EXPECT_FALSE(model_from_node(parse_toml(model_text(chain), "model.toml")).trained.has_value());
  chain.trained = Trained{{-1.0, 2.0, 3.0, 4.0, 5.0}, -6.0, 7.0, 0.8, 0.9, {}, {}};
  const auto plain = model_from_node(parse_toml(model_text(chain), "model.toml")).trained;
  ASSERT_TRUE(plain.has_value());
  EXPECT_EQ(plain->input.lower, -1.0);
  EXPECT_EQ(plain->input.upper, 2.0);
  EXPECT_EQ(plain->input.max_rate_per_s, 3.0);
  EXPECT_EQ(plain->input.from_hz, 4.0);
  EXPECT_EQ(plain->input.to_hz, 5.0);
  EXPECT_EQ(plain->output_lower, -6.0);
  EXPECT_EQ(plain->output_upper, 7.0);
  EXPECT_EQ(plain->training_percent, 0.9);
  EXPECT_EQ(plain->rms(), 0.8);
  chain.trained->holdout_rms = 1.5;
  chain.trained->holdout_percent = 1.6;
  const auto held = model_from_node(parse_toml(model_text(chain), "model.toml")).trained;
  EXPECT_EQ(held->rms(), 1.5);
  EXPECT_EQ(held->holdout_percent, 1.6);
}

TEST(ModelFile, SaysHowTheModelStartsOrNothing) {
  const std::string block = "[[block]]\ntype = \"gain\"\ngain = 2.0\n";
  EXPECT_EQ(parse(kHead + block).start, std::nullopt);
  EXPECT_EQ(model_text(parse(kHead + block)).find("start"), std::string::npos);
  for (const Start start : {Start::zero, Start::equilibrium}) {
    const Chain chain = parse(kHead + ("start = \"" + std::string(to_string(start)) + "\"\n") + block);
    EXPECT_EQ(chain.start, start);
    EXPECT_EQ(parse(model_text(chain)).start, start);
  }
  EXPECT_EQ(complaint(kHead + ("start = \"warm\"\n" + block)).substr(0, 13), "model.toml:2:");
}

TEST(ModelFile, MistakesNameTheLineAndWhatWasExpected) {
  EXPECT_EQ(complaint("schema = \"bodesmith.sections/1\"\n").substr(0, 13), "model.toml:1:");
  const std::string unknown_type = complaint(std::string(kHead) + "[[block]]\ntype = \"lowpas\"\n");
  EXPECT_EQ(unknown_type.substr(0, 13), "model.toml:3:");
  EXPECT_NE(unknown_type.find("lowpass"), std::string::npos);
  const std::string unknown_key =
      complaint(std::string(kHead) + "[[block]]\ntype = \"lowpass\"\ncorner_hz = 3.0\ncornr = 2\n");
  EXPECT_EQ(unknown_key.substr(0, 13), "model.toml:5:");
  EXPECT_NE(unknown_key.find("corner_hz"), std::string::npos);
  EXPECT_NE(complaint(std::string(kHead) + "[[block]]\ntype = \"lowpass\"\n").find("corner_hz"),
            std::string::npos);
  const std::string bounds = complaint(std::string(kHead) + "[[block]]\ntype = \"lowpass\"\ncorner_hz = 0\n");
  EXPECT_EQ(bounds.substr(0, 13), "model.toml:4:");
  EXPECT_NE(bounds.find("above 0"), std::string::npos);
  const std::string free =
      complaint(std::string(kHead) + "[[block]]\ntype = \"lowpass\"\ncorner_hz = 1\nfree = [\"corner\"]\n");
  EXPECT_EQ(free.substr(0, 13), "model.toml:5:");
  EXPECT_NE(free.find("'corner'"), std::string::npos);
  EXPECT_NE(
      complaint(std::string(kHead) + "[[block]]\ntype = \"creep\"\ngains = [1, 2]\ntime_constants_s = [1]\n")
          .find("different lengths"),
      std::string::npos);
  EXPECT_NE(complaint(std::string(kHead) + "[[block]]\ntype = \"saturation\"\nlower = 2\nupper = 1\n")
                .find("lower"),
            std::string::npos);
  EXPECT_NE(complaint(std::string(kHead) + "[[block]]\ntype = \"gain\"\ngain = \"big\"\n"), "accepted");
  EXPECT_NE(complaint(std::string(kHead) + "extra = 1\n[[block]]\ntype = \"gain\"\n"), "accepted");
  EXPECT_NE(complaint(std::string(kHead) + "[[block]]\ngain = 1\n"), "accepted");
}

TEST(ModelFile, BrokenFilesNeverDoWorseThanAnInputError) {
  const std::string good =
      std::string(kHead) +
      "[[block]]\ntype = \"creep\"\ngains = [0.1, 2e-3]\ntime_constants_s = [1.5, 3.0]\nfree = [\"gains\"]\n"
      "[[block]]\ntype = \"sample_hold\"\nclock_hz = 2e3\nhalf_cycle = true\n";
  std::mt19937 random(7);
  const std::string letters = "[]{}\"=,.#\n -+eE0129abtypefree\\\x01\xff";
  for (int i = 0; i < 3000; ++i) {
    std::string text = good;
    for (unsigned k = 0, n = 1 + random() % 4; k < n; ++k) {
      const size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = letters[random() % letters.size()];
          break;
        case 1:
          text.erase(at, 1 + random() % 5);
          break;
        default:
          text.insert(at, 1, letters[random() % letters.size()]);
          break;
      }
    }
    try {
      const Chain chain = parse(text);
      for (const Block& block : chain.blocks) EXPECT_FALSE(block.validate().has_value());
    } catch (const InputError&) {
    }
  }
}

TEST(Blocks, KernelsOfLinearBlocksHaveTheBlocksExactResponse) {
  const std::vector<Block> blocks = {
      make_block("gain").set("gain", -2.5),
      make_block("lowpass").set("corner_hz", 12.0),
      make_block("pole_zero").set("gain", 0.7).set("zero_hz", 3.0).set("pole_hz", 40.0),
      make_block("resonator").set("gain", 1.3).set("natural_frequency_hz", 33.0).set("damping_ratio", 0.03),
      make_block("delay").set("delay_s", 0.004),
      make_block("creep")
          .set("gains", std::vector<double>{0.3, -0.1})
          .set("time_constants_s", std::vector<double>{0.02, 1.0})};
  for (const Block& block : blocks) {
    const Kernel kernel = block.kernel();
    const auto& linear = std::get<LinearKernel>(kernel);
    for (const double f : {0.01, 1.0, 10.0, 33.0, 1000.0}) {
      const RadPerSecond w = Hertz{f}.rad_s();
      const auto exact = *block.response(w);
      EXPECT_LT(std::abs(response(linear, {0.0, w.value}) - exact), 1e-12 * std::max(1.0, std::abs(exact)))
          << block.type_name() << f;
    }
  }
}

TEST(Blocks, FractionalKernelStaysWithinItsStatedErrorAndComesNearIt) {
  for (const double beta : {-0.0428, 1.0245, -1.2113, 2.2908, 0.5, 0.97}) {
    for (const double x : {1e-4, 0.1, 0.5, 3.0, 1e4}) {
      const Block block =
          make_block("fractional_lead_lag").set("lambda_s", 0.01).set("x", x).set("beta", beta);
      const Kernel kernel = block.kernel();
      const auto& linear = std::get<LinearKernel>(kernel);
      double largest = 0.0;
      for (double f = 1e-9; f < 1e12; f *= 1.3) {
        const RadPerSecond w = Hertz{f}.rad_s();
        largest = std::max(largest, std::abs(response(linear, {0.0, w.value}) / *block.response(w) - 1.0));
      }
      // At rest a state space is the difference of what it passes at once and what its states take away.
      const double rounding = 1e-11 + 1e-14 * std::pow(x, -beta);
      EXPECT_LT(largest, linear.approximation_error * (1.0 + 1e-6) + rounding) << beta << " " << x;
      EXPECT_GT(largest, 0.98 * linear.approximation_error - rounding) << beta << " " << x;
      if (x >= 0.1 && x < 1e3) {
        EXPECT_LT(linear.approximation_error, 2.4e-6);  // 2e-5 dB
      }
    }
  }
}

TEST(ModelSchema, WhatABlockNeedsIsWhatItsReaderAsksFor) {
  const Json schema = model_schema();
  ASSERT_GT(schema["$defs"]["block"]["oneOf"].size(), 20u);
  for (const Json& block : schema["$defs"]["block"]["oneOf"]) {
    const std::string type = block["properties"]["type"]["const"];
    const std::string said =
        complaint("schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"" + type + "\"\n");
    const Json& required = block["required"];
    if (required.size() == 1) {
      EXPECT_EQ(said.find("is missing"), std::string::npos) << said;
    } else {
      bool one = false;
      for (std::size_t k = 1; k < required.size(); ++k)
        one = one || said.find(required[k].get<std::string>()) != std::string::npos;
      EXPECT_TRUE(one) << type << ": " << said;
    }
  }
}

}  // namespace
}  // namespace bodesmith::chain
