#include "chain/chain.hpp"

#include <fmt/format.h>

namespace bodesmith::chain {

std::optional<std::complex<double>> Chain::response(RadPerSecond w) const {
  std::complex<double> h = 1.0;
  for (const Block& block : blocks) {
    const auto factor = block.response(w);
    if (!factor) return std::nullopt;
    h *= *factor;
  }
  return h;
}

std::vector<Parameter*> Chain::free_parameters() {
  std::vector<Parameter*> out;
  for (Block& block : blocks) {
    for (Parameter& p : block.parameters()) {
      if (p.free) out.push_back(&p);
    }
  }
  return out;
}

std::string Chain::label(const Parameter& parameter) const {
  for (size_t i = 0; i < blocks.size(); ++i) {
    for (const Parameter& p : blocks[i].parameters()) {
      if (&p != &parameter) continue;
      const std::string& part = blocks[i].part;
      return fmt::format("block {} ({}{}{}) {}", i + 1, blocks[i].type_name(), part.empty() ? "" : ", ", part,
                         p.name());
    }
  }
  return parameter.name();
}

}  // namespace bodesmith::chain
