# What most files read, parsed once: like BODESMITH_UNITY for quick cold builds alone (a file includes what it uses all the
# same; the develop preset sees to that).
set(BODESMITH_HEADER_LIST
  <Eigen/Core> <algorithm> <array> <cmath> <complex> <filesystem> <fmt/format.h> <functional> <limits> <map> <memory>
  ${CMAKE_CURRENT_LIST_DIR}/shared_json.hpp <numbers> <numeric> <optional> <set> <span> <string> <string_view> <utility>
  <variant> <vector>)

# bodesmith_shared_headers(NAME [MORE HEADERS…] [LINK LIBRARIES…]): parses them as the target NAME.
function(bodesmith_shared_headers name)
  if(NOT BODESMITH_SHARED_HEADERS)
    return()
  endif()
  cmake_parse_arguments(SHARED "" "" "MORE;LINK" ${ARGN})
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp.new "")
  file(COPY_FILE ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp.new ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp ONLY_IF_DIFFERENT)
  add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_link_libraries(${name} PRIVATE fmt::fmt nlohmann_json::nlohmann_json Eigen3::Eigen ${SHARED_LINK})
  bodesmith_warnings(${name})  # some of them define macros
  target_precompile_headers(${name} PRIVATE ${BODESMITH_HEADER_LIST} ${SHARED_MORE})
endfunction()

# The target's files begin with what `name` has parsed; both are compiled with the same options.
function(bodesmith_use_headers target name)
  if(TARGET ${name})
    target_precompile_headers(${target} REUSE_FROM ${name})
  endif()
endfunction()
