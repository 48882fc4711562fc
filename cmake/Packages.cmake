# Debian packages by CPack, for Debian 12: bodesmith, bodesmith-mpi and libbodesmith-dev. .ci/package builds them, asks lintian,
# and installs and runs them in a clean root.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME bodesmith)
set(CPACK_PACKAGE_CONTACT "the bodesmith authors <bodesmith@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "analog compensators from Bode magnitudes to checked hardware")
set(CPACK_COMPONENTS_ALL program development mpi)
if(NOT TARGET bodesmith_mpi)
  list(REMOVE_ITEM CPACK_COMPONENTS_ALL mpi)
endif()
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_SOURCE_DIR}/cmake/DebianFiles.cmake)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME bodesmith)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# Loaded by name, not linked: libmatio.so.11 is in libmatio11.
string(REPLACE ".so." "" matio_package ${matio})
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS ${matio_package})
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS ngspice)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "bodesmith-mpi, libbodesmith-dev")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
"From a target Bode magnitude, or measured records of a piezo stage, to
checked analog hardware: configurations for a field-programmable analog
array (FPAA), SPICE netlists of op-amp circuits, multiplier layouts, and
a report that states the error of every step.")

set(CPACK_DEBIAN_MPI_PACKAGE_NAME bodesmith-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "bodesmith (= ${PROJECT_VERSION}-1)")
set(CPACK_DEBIAN_MPI_DESCRIPTION "analog compensators from Bode magnitudes (MPI)")
set(CPACK_COMPONENT_MPI_DESCRIPTION
"Lets several processes share the work of bodesmith's tolerance analysis:
mpirun -n N bodesmith yield. The program loads it under mpirun only.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libbodesmith-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libeigen3-dev, libsuitesparse-dev, nlohmann-json3-dev, libtomlplusplus-dev, libfmt-dev, libssl-dev, libmatio-dev")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "analog compensators from Bode magnitudes (static library)")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
"Headers and static libraries of bodesmith, with files for CMake
(find_package) and pkg-config.")
include(CPack)
