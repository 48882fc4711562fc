#include "simulate/segments.hpp"

#include "simulate/cvode_engine.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Kernel;
using chain::LinearKernel;
using chain::MemoryKernel;
using chain::OdeKernel;
using chain::SampledKernel;

template <class T>
bool is(const Kernel& kernel) {
  return std::holds_alternative<T>(kernel);
}

std::string by_samples(const Kernel& kernel) {
  if (is<LinearKernel>(kernel)) return "matrix exponential on each hold";
  if (is<std::unique_ptr<OdeKernel>>(kernel)) return "collocation on each hold";
  if (is<std::unique_ptr<MemoryKernel>>(kernel)) return "memory, node by node";
  if (is<std::unique_ptr<SampledKernel>>(kernel)) return "edge by edge";
  return "value by value";
}

std::string by_events(const Kernel& kernel) {
  if (can_stand_in_ode(kernel)) return "one ODE with events";
  if (is<LinearKernel>(kernel)) return "delay, shifted";
  if (is<std::unique_ptr<SampledKernel>>(kernel)) return "edge by edge";
  return "memory, eight steps a sample";
}

}  // namespace

std::vector<Segment> segments_of(const chain::Chain& chain, const std::string& name) {
  std::vector<Segment> out;
  for (std::size_t i = 1; i <= chain.blocks.size(); ++i) {
    const Kernel kernel = chain.blocks[i - 1].kernel();
    const std::string method = name == "exact"   ? "closed form between corners"
                               : name == "cvode" ? by_events(kernel)
                                                 : by_samples(kernel);
    if (!out.empty() && out.back().method == method) {
      out.back().last = i;
    } else {
      out.push_back({i, i, method});
    }
  }
  return out;
}

}  // namespace bodesmith::simulate
