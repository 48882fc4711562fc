// One libFuzzer program a reader: BODESMITH_READER names it.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bodesmith::fuzz;
  for (const Reader& reader : readers()) {
    if (std::strcmp(reader.name, BODESMITH_READER) == 0)
      run(reader, {reinterpret_cast<const char*>(data), size});
  }
  return 0;
}
