# What `bodesmith --version --json` says of the build: generated/cli/build_facts.cpp.
set(BODESMITH_COMMIT "")
set(BODESMITH_DATE "")
find_package(Git QUIET)
if(GIT_FOUND AND EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/.git)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${CMAKE_CURRENT_SOURCE_DIR} describe --always --dirty --abbrev=12 --exclude=*
    OUTPUT_VARIABLE BODESMITH_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${CMAKE_CURRENT_SOURCE_DIR} log -1 --format=%cs
    OUTPUT_VARIABLE BODESMITH_DATE OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  # A new commit configures anew.
  foreach(file .git/HEAD .git/logs/HEAD)
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${file})
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${file})
    endif()
  endforeach()
endif()

if(NOT BODESMITH_DATE)
  string(TIMESTAMP BODESMITH_DATE "%Y-%m-%d" UTC)  # SOURCE_DATE_EPOCH's, where that is set
endif()

string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}}" BODESMITH_FLAGS)

set(BODESMITH_OPTIONS "")
foreach(option UNITY WERROR HARDEN BUILD_TESTS BUILD_PYTHON BUILD_EXAMPLES)
  string(TOLOWER ${option} name)
  if(BODESMITH_${option})
    list(APPEND BODESMITH_OPTIONS "${name}=ON")
  else()
    list(APPEND BODESMITH_OPTIONS "${name}=OFF")
  endif()
endforeach()
if(MPI_CXX_FOUND)
  list(APPEND BODESMITH_OPTIONS "mpi=ON")
else()
  list(APPEND BODESMITH_OPTIONS "mpi=OFF")
endif()
list(JOIN BODESMITH_OPTIONS " " BODESMITH_OPTIONS)

# The numbers of a header's version macros, joined by dots.
function(bodesmith_version_in header macros out)
  file(STRINGS ${header} lines REGEX "define ${macros} ")
  string(REGEX REPLACE "[^0-9;]" "" numbers "${lines}")
  list(JOIN numbers "." version)
  set(${out} ${version} PARENT_SCOPE)
endfunction()

set(matio_version "")
foreach(header matio_pubconf.h matio.h)
  if(EXISTS ${MATIO_INCLUDE_DIR}/${header} AND NOT matio_version)
    bodesmith_version_in(${MATIO_INCLUDE_DIR}/${header} "MATIO_(MAJOR|MINOR|RELEASE_LEVEL)(_VERSION)?" matio_version)
  endif()
endforeach()
bodesmith_version_in(${KLU_INCLUDE_DIR}/suitesparse/klu.h "KLU_(MAIN|SUB|SUBSUB)_VERSION" klu_version)
set(BODESMITH_LIBRARIES "eigen=${Eigen3_VERSION} sundials=${BODESMITH_SUNDIALS} boost=${Boost_VERSION_STRING} nlohmann_json=${nlohmann_json_VERSION} tomlplusplus=${tomlplusplus_VERSION} fmt=${fmt_VERSION} openssl=${OPENSSL_VERSION} matio=${matio_version} klu=${klu_version} mpi=${MPI_CXX_VERSION} musl=${BODESMITH_MUSL}")

set(BODESMITH_BUILD_FACTS ${CMAKE_BINARY_DIR}/generated/cli/build_facts.cpp)
configure_file(${CMAKE_CURRENT_SOURCE_DIR}/src/cli/build_facts.cpp.in ${BODESMITH_BUILD_FACTS} @ONLY)
set_source_files_properties(${BODESMITH_BUILD_FACTS} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
