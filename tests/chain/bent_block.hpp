#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "chain/block.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {

/// y = u + amount u|u|/2: a type of block that the program does not have.
class BentType final : public BlockType {
 public:
  explicit BentType(std::string name)
      : BlockType(std::move(name), "bends the input",
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

}  // namespace bodesmith::chain
