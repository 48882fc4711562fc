// A new block type is one object and one registration: read from model.toml, it simulates in every engine.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Block;
using chain::BlockType;
using chain::CurveKernel;
using chain::Kernel;

/// y = u + amount u|u|/2: known to nobody but this file.
class BentType final : public BlockType {
 public:
  BentType()
      : BlockType("bent_in_simulate_test", "bends the input",
                  {above_zero("amount", "1/u", "how much").with_default(0.5)}) {}
  Kernel kernel(const Block& block) const override { return std::make_unique<Curve>(block.get("amount")); }

 private:
  class Curve final : public CurveKernel {
   public:
    explicit Curve(double amount) : amount_(amount) {}
    double value(double u) const override { return u + 0.5 * amount_ * u * std::abs(u); }
    double slope(double u) const override { return 1.0 + amount_ * std::abs(u); }

   private:
    double amount_;
  };
};

const BentType& bent_block() {
  static const BentType type;
  return type;
}

TEST(NewBlock, SimulatesBetweenOthers) {
  chain::block_type_registry().add(bent_block());
  const chain::Chain chain = chain::model_from_node(
      parse_toml("schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 2.0\n[[block]]\n"
                 "type = \"bent_in_simulate_test\"\namount = 0.5\n",
                 "model.toml"));
  TimeRecord in;
  in.step_s = 1e-3;
  for (int i = 0; i < 200; ++i) in.u.push_back(std::sin(0.1 * i));
  for (const Engine engine : {Engine::record, Engine::cvode}) {
    Options options;
    options.engine = engine;
    const auto y = simulate(chain, in, options).y;
    ASSERT_EQ(y.size(), in.u.size());
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double u = 2.0 * in.u[i];
      EXPECT_NEAR(y[i], u + 0.25 * u * std::abs(u), 1e-7) << i;
    }
  }
}

}  // namespace
}  // namespace bodesmith::simulate
