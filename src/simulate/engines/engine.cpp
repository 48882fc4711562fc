#include "simulate/engines/engine.hpp"

#include <stdexcept>

namespace bodesmith::simulate {

const ChainEngine& chain_engine(Engine which) {
  for (const ChainEngine* engine :
       {&record_engine(), &exact_engine(), &cvode_engine(), &grunwald_letnikov_engine()}) {
    if (engine->which() == which) return *engine;
  }
  throw std::logic_error("the automatic choice is no engine of its own");
}

}  // namespace bodesmith::simulate
