#include "simulate/segments.hpp"

#include "simulate/engines/engine.hpp"

namespace bodesmith::simulate {

std::vector<Segment> segments_of(const chain::Chain& chain, Engine engine) {
  std::vector<Segment> out;
  for (std::size_t i = 1; i <= chain.blocks.size(); ++i) {
    const std::string_view method = chain_engine(engine).method(chain.blocks[i - 1].kernel());
    if (!out.empty() && out.back().method == method) {
      out.back().last = i;
    } else {
      out.push_back({i, i, method});
    }
  }
  return out;
}

}  // namespace bodesmith::simulate
