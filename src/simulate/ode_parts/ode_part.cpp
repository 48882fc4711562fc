#include "simulate/ode_parts/ode_part.hpp"

#include <stdexcept>

namespace bodesmith::simulate {
namespace {

using chain::CurveKernel;
using chain::LinearKernel;
using chain::MemoryKernel;
using chain::OdeKernel;
using chain::SampledKernel;
using chain::SourceKernel;

struct CanStand {
  bool operator()(const LinearKernel& linear) const { return linear.delay_s == 0.0; }
  bool operator()(const std::unique_ptr<MemoryKernel>& memory) const {
    return memory->rate_independent() || memory->has_branches() || memory->slew_rate() > 0.0;
  }
  bool operator()(const std::unique_ptr<SampledKernel>&) const { return false; }
  template <class T>
  bool operator()(const std::unique_ptr<T>&) const {
    return true;
  }
};

struct MakePart {
  using Part = std::unique_ptr<OdePart>;
  Part operator()(const LinearKernel& linear) const { return make_dynamics_part(linear, nullptr); }
  Part operator()(const std::unique_ptr<CurveKernel>& curve) const { return make_curve_part(*curve); }
  Part operator()(const std::unique_ptr<SourceKernel>& source) const { return make_source_part(*source); }
  Part operator()(const std::unique_ptr<OdeKernel>& system) const {
    return make_dynamics_part(system->linear(), system.get());
  }
  Part operator()(const std::unique_ptr<MemoryKernel>& memory) const {
    if (memory->has_branches()) return make_branch_part(*memory);
    return memory->slew_rate() > 0.0 ? make_slew_part(*memory) : make_memory_part(*memory);
  }
  Part operator()(const std::unique_ptr<SampledKernel>&) const {
    throw std::logic_error("a clocked block is no part of an ODE");
  }
};

}  // namespace

bool can_stand_in_ode(const chain::Kernel& kernel) {
  return std::visit(CanStand{}, kernel);
}

std::unique_ptr<OdePart> make_ode_part(const chain::Kernel& kernel) {
  return std::visit(MakePart{}, kernel);
}

}  // namespace bodesmith::simulate
