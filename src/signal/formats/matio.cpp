#include "signal/formats/matio.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include "base/error.hpp"

namespace bodesmith::formats {
namespace {

Matio load() {
  void* library = ::dlopen(BODESMITH_MATIO, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw InputError(
        fmt::format("a MATLAB file needs {}, which is not installed ({})", BODESMITH_MATIO, ::dlerror()));
  Matio out{};
  const auto get = [library]<typename Function>(Function& function, const char* name) {
    function = reinterpret_cast<Function>(::dlsym(library, name));
    if (function == nullptr)
      throw InputError(
          fmt::format("{} lacks {}, expected the one that bodesmith was built for", BODESMITH_MATIO, name));
  };
  get(out.open, "Mat_Open");
  get(out.create, "Mat_CreateVer");
  get(out.close, "Mat_Close");
  get(out.log, "Mat_LogInitFunc");
  get(out.read_next_info, "Mat_VarReadNextInfo");
  get(out.read_data, "Mat_VarReadDataAll");
  get(out.number_of_fields, "Mat_VarGetNumberOfFields");
  get(out.variable, "Mat_VarCreate");
  get(out.write, "Mat_VarWrite");
  get(out.free, "Mat_VarFree");
  return out;
}

}  // namespace

const Matio& matio() {
  static const Matio loaded = load();
  return loaded;
}

}  // namespace bodesmith::formats
