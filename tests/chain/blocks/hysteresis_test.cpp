#include "chain/blocks/hysteresis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <variant>
#include <vector>

#include "base/error.hpp"
#include "chain/inverse.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "hysteresis/model_type.hpp"

namespace bodesmith::chain {
namespace {

using hysteresis::Model;
using hysteresis::Parameters;

std::vector<Model> models() {
  std::vector<double> w;
  for (int i = 0; i < 30 * 31 / 2; ++i) w.push_back(i % 5 == 0 ? 0.0 : 1.0 / (300.0 + i));
  return {
      hysteresis::make_model("preisach", Parameters().set("u_min", 0.0).set("u_max", 1.0).set("w", w)),
      hysteresis::make_model("krasnoselskii_pokrovskii",
                             Parameters().set("u_min", 0.0).set("u_max", 1.0).set("mu", w)),
      hysteresis::make_model("prandtl_ishlinskii", Parameters()
                                                       .set("r", {0.0, 0.05, 0.15, 0.3})
                                                       .set("w", {0.6, 0.1, 0.2, 0.3})
                                                       .set("s", {0.3, 0.7})
                                                       .set("v", {0.1, -0.2})),
      hysteresis::make_model("exponential_operator",
                             Parameters().set("k", {0.8, 0.3}).set("tau", {30.0, 2.0})),
      hysteresis::make_model("polynomial_hysteresis", Parameters()
                                                          .set("ascending", {-0.3546, 0.6433, -0.2887})
                                                          .set("descending", {0.2398, -0.0838, -0.156})
                                                          .set("minor", "nested")),
      hysteresis::make_model(
          "sine_hysteresis",
          Parameters().set("A_ascending", -0.08).set("A_descending", 0.1).set("minor", "nested")),
  };
}

TEST(HysteresisBlock, ReadsBackWhatItWrites) {
  for (const Model& model : models()) {
    SCOPED_TRACE(model.type->name());
    const Chain chain{{hysteresis_block(model)}};
    const std::string text = model_text(chain);
    const Chain back = model_from_node(parse_toml(text, "model.toml"));
    EXPECT_EQ(model_text(back), text);
    const auto a = make_operator(model);
    const auto b = make_operator(hysteresis_model_of(back.blocks[0]));
    a->reset(0.0);
    b->reset(0.0);
    for (const double u : {0.7, 0.2, 0.5, 0.1, 0.9}) EXPECT_EQ(a->step(u, 1.0), b->step(u, 1.0));
  }
}

TEST(HysteresisBlock, RelationsBetweenParametersAreRefusedAtTheLine) {
  const std::string head =
      "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"bouc_wen\"\nk = 1\nA = 1\nbeta = 1\n";
  for (const auto& [line, said] : {std::pair("gamma = 2\n", "is outside [-beta, beta]"),
                                   {"delta = -0.6\ngamma = 0.5\n", "is outside [|gamma| - beta"}}) {
    try {
      model_from_node(parse_toml(head + line, "model.toml"));
      FAIL() << "accepted";
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).substr(0, 13), "model.toml:7:");
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
    }
  }
}

/// The block's kernel makes of the found input what was wanted, but for the samples that are told to be out of reach.
TEST(HysteresisBlock, TheInputFoundGivesWhatWasWanted) {
  std::size_t reached = 0, beyond = 0;
  for (const Model& model : models()) {
    const Block block = hysteresis_block(model);
    const auto forward = [&](const std::vector<double>& u) {
      const Kernel kernel = block.kernel();
      MemoryKernel& memory = *std::get<std::unique_ptr<MemoryKernel>>(kernel);
      std::vector<double> y;
      for (std::size_t i = 0; i < u.size(); ++i)
        y.push_back(i == 0 ? memory.reset(u[0], false) : memory.step(u[i], 0.01));
      return y;
    };
    std::vector<double> wanted = forward({0.1, 0.5, 0.9, 0.6, 0.3, 0.35, 0.8, 0.2});
    wanted.push_back(1e3);
    const auto found = block.inverse({0.0, 0.01, wanted});
    if (!found) continue;
    ASSERT_EQ(found->values.size(), wanted.size()) << model.type->name();
    const std::vector<double> got = forward(found->values);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const bool told =
          std::find(found->out_of_reach.begin(), found->out_of_reach.end(), i) != found->out_of_reach.end();
      EXPECT_EQ(told, std::abs(got[i] - wanted[i]) > 2e-3)
          << model.type->name() << " at " << i << ": " << got[i] - wanted[i];
      ++(told ? beyond : reached);
    }
  }
  EXPECT_GT(reached, 20u);
  EXPECT_GT(beyond, 0u);
}

TEST(HysteresisBlock, SaysWhichPolynomialsItHas) {
  const Block block = hysteresis_block(models()[4]);
  ASSERT_EQ(block.polynomials().size(), 2u);
  EXPECT_EQ(block.polynomials()[0].key, "ascending");
  EXPECT_TRUE(hysteresis_block(models()[5]).polynomials().empty());
  EXPECT_EQ(make_block("gain").hysteresis_model(), nullptr);
}

}  // namespace
}  // namespace bodesmith::chain
