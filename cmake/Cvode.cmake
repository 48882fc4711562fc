# Of SUNDIALS CVODE alone, with its own vectors, dense and banded solvers: libsundials_cvode.a holds all of it. Its CMake package asks
# for the libraries of every component (PETSc, hypre, MPI). ./run and ./test unpack the archive and its headers into build/packages
# where libsundials-dev is not installed. Linked in: its pow is then this program's own as well (Elementary).
set(unpacked ${CMAKE_CURRENT_SOURCE_DIR}/build/packages/usr)
find_path(CVODE_INCLUDE_DIR cvode/cvode.h HINTS ${unpacked}/include)
find_library(CVODE_ARCHIVE libsundials_cvode.a HINTS ${unpacked}/lib/${CMAKE_LIBRARY_ARCHITECTURE} ${unpacked}/lib)
if(NOT CVODE_INCLUDE_DIR OR NOT CVODE_ARCHIVE)
  message(FATAL_ERROR "CVODE of SUNDIALS 6 is not there (Debian: libsundials-dev, or its files alone by ./run)")
endif()
file(STRINGS ${CVODE_INCLUDE_DIR}/sundials/sundials_config.h version REGEX "define SUNDIALS_VERSION ")
string(REGEX MATCH "[0-9.]+" BODESMITH_SUNDIALS "${version}")
if(NOT BODESMITH_SUNDIALS VERSION_GREATER_EQUAL 6 OR NOT BODESMITH_SUNDIALS VERSION_LESS 7)
  message(FATAL_ERROR "${CVODE_INCLUDE_DIR} has SUNDIALS ${BODESMITH_SUNDIALS}, not 6")
endif()
execute_process(COMMAND ${CMAKE_AR} t ${CVODE_ARCHIVE} OUTPUT_VARIABLE members COMMAND_ERROR_IS_FATAL ANY)
string(STRIP "${members}" members)
string(REPLACE "\n" ";" members "${members}")
bodesmith_from_archive(cvode ${CVODE_ARCHIVE} ${members})
target_include_directories(bodesmith_cvode SYSTEM INTERFACE $<BUILD_INTERFACE:${CVODE_INCLUDE_DIR}>)
