# A room is one folder of src/: one static library that links the rooms it USES, all of them built before it.
set(BODESMITH_ROOMS "" CACHE INTERNAL "")

configure_file(${CMAKE_CURRENT_SOURCE_DIR}/src/base/version.hpp.in
               ${CMAKE_BINARY_DIR}/generated/base/version.hpp @ONLY)

function(bodesmith_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                         -Woverloaded-virtual -Wimplicit-fallthrough)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")  # GCC 12 warns falsely (its bugs 105329, 108088)
    target_compile_options(${target} PRIVATE -Wno-restrict -Wno-free-nonheap-object)
    if(BODESMITH_SHARED_HEADERS)  # what it sees through of the library's headers it then no longer excuses
      target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
    endif()
  endif()
  # Rooms that still count with mixed signs; the list only shrinks.
  if(NOT target MATCHES "^(bodesmith|test|gap|bench)_(${BODESMITH_MIXED_SIGNS})")
    target_compile_options(${target} PRIVATE -Wsign-conversion)
  endif()
  if(BODESMITH_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# Files of a room share what they instantiate (Eigen, JSON, formatting) when they are compiled together. Names in anonymous
# namespaces are therefore unique within a room.
function(bodesmith_unity target most)
  string(REGEX REPLACE "^bodesmith_" "" name ${target})
  set(unity ${BODESMITH_UNITY})
  if(name IN_LIST BODESMITH_SINGLE)
    set(unity OFF)
  endif()
  if(BODESMITH_SHARED_HEADERS)
    math(EXPR most "9 * ${most} / 4")
  endif()
  # As few files as can be, all of a size: what each compiles anew takes about two seconds. One more may join, that is generated.
  get_target_property(files ${target} SOURCES)
  list(FILTER files INCLUDE REGEX "\\.cpp$")
  list(LENGTH files count)
  math(EXPR batches "(${count} + ${most} - 1) / ${most}")
  math(EXPR batch "(${count} + ${batches} - 1) / ${batches} + 1")
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${unity} UNITY_BUILD_BATCH_SIZE ${batch})
endfunction()

# Tests, rooms that read options and write pages: what they call is compiled for speed, in the other rooms; they themselves are
# compiled quickly (a tenth to a quarter less time than with -O1, on measured and report).
function(bodesmith_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release,RelWithDebInfo>:-Og>)
endfunction()

# How a room's files are compiled: COLD quickly, all others for speed.
function(bodesmith_compile target cold)
  bodesmith_warnings(${target})
  bodesmith_unity(${target} 18)
  if(cold)
    bodesmith_compile_quickly(${target})
    bodesmith_use_headers(${target} bodesmith_cold_headers)
  else()
    bodesmith_use_headers(${target} bodesmith_headers)
  endif()
endfunction()

# A program of few files that is not shipped, compiled quickly and, that it may share the headers of cold rooms, with the option of
# libraries (-fPIC; CMake then links it to fixed addresses).
function(bodesmith_small_program target)
  bodesmith_compile(${target} TRUE)
  if(BODESMITH_SHARED_HEADERS)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(${target} PRIVATE -fPIC)
  endif()
endfunction()

# COLD: the whole room is not where the time goes when the program runs; COLD_FOLDERS: these folders of it are not; HOT: all but
# these files and folders of it are not.
function(bodesmith_room name)
  cmake_parse_arguments(ROOM "COLD" "" "COLD_FOLDERS;HOT;USES;PUBLIC;PRIVATE" ${ARGN})
  set(target bodesmith_${name})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/${name}/*.cpp
                                              ${CMAKE_CURRENT_SOURCE_DIR}/src/${name}/*.hpp)
  set(cold_sources "")
  foreach(folder ${ROOM_COLD_FOLDERS})
    set(in_folder ${sources})
    list(FILTER in_folder INCLUDE REGEX "/src/${name}/${folder}/.*\\.cpp$")
    if(NOT in_folder)
      message(FATAL_ERROR "${name} has no folder ${folder}")
    endif()
    list(APPEND cold_sources ${in_folder})
  endforeach()
  if(ROOM_HOT)
    set(cold_sources ${sources})
    list(FILTER cold_sources INCLUDE REGEX "\\.cpp$")
    foreach(hot ${ROOM_HOT})
      list(LENGTH cold_sources before)
      list(FILTER cold_sources EXCLUDE REGEX "/src/${name}/${hot}(/|\\.cpp$)")
      list(LENGTH cold_sources after)
      if(before EQUAL after)
        message(FATAL_ERROR "${name} has no ${hot}")
      endif()
    endforeach()
  endif()
  list(REMOVE_ITEM sources ${cold_sources})
  add_library(${target} STATIC ${sources})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} LINKER_LANGUAGE CXX)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/src>
    $<BUILD_INTERFACE:${CMAKE_BINARY_DIR}/generated>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/bodesmith>)
  # Nearest room first: the linker then meets users before what they use.
  set(above ${ROOM_USES})
  foreach(room ${above})
    if(NOT room IN_LIST BODESMITH_ROOMS)
      message(FATAL_ERROR "${name} may not use ${room}: it stands below")
    endif()
  endforeach()
  list(REVERSE above)
  list(TRANSFORM above PREPEND bodesmith_)
  target_link_libraries(${target} PUBLIC ${above} ${ROOM_PUBLIC} PRIVATE ${ROOM_PRIVATE})
  bodesmith_compile(${target} ${ROOM_COLD})
  if(cold_sources)
    add_library(${target}_cold OBJECT ${cold_sources})
    target_include_directories(${target}_cold PRIVATE $<TARGET_PROPERTY:${target},INCLUDE_DIRECTORIES>)
    target_link_libraries(${target}_cold PRIVATE ${above} ${ROOM_PUBLIC} ${ROOM_PRIVATE})
    bodesmith_compile(${target}_cold TRUE)
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_cold>)
  endif()
  set(BODESMITH_ROOMS ${BODESMITH_ROOMS} ${name} CACHE INTERNAL "")
endfunction()

# One target for everything: bodesmith::bodesmith.
function(bodesmith_all_rooms target)
  set(rooms ${BODESMITH_ROOMS})
  list(TRANSFORM rooms PREPEND bodesmith_)
  set(BODESMITH_ROOM_TARGETS ${rooms} PARENT_SCOPE)
  list(REVERSE rooms)
  add_library(${target} INTERFACE)
  target_link_libraries(${target} INTERFACE ${rooms})
  add_library(bodesmith::${target} ALIAS ${target})
endfunction()
