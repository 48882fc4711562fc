# What goes where, in three parts: the program, the library to build with, and the module for MPI; and their Debian packages
# (cd build && cpack).
include(CMakePackageConfigHelpers)
set(BODESMITH_DOC_DIR ${CMAKE_INSTALL_DATADIR}/doc/bodesmith)
set(BODESMITH_DATA_DIR ${CMAKE_INSTALL_DATADIR}/bodesmith)

# The program.
install(TARGETS bodesmith_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(DIRECTORY netlists/ DESTINATION ${BODESMITH_DATA_DIR}/netlists COMPONENT program)
install(DIRECTORY schemas/ DESTINATION ${BODESMITH_DATA_DIR}/schemas COMPONENT program)
install(DIRECTORY examples/ DESTINATION ${BODESMITH_DATA_DIR}/examples COMPONENT program USE_SOURCE_PERMISSIONS
  PATTERN hysteresis_tables EXCLUDE)
install(DIRECTORY ${BODESMITH_MANUAL_DIR}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES ${BODESMITH_COMPLETION_DIR}/bodesmith.bash RENAME bodesmith COMPONENT program
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${BODESMITH_COMPLETION_DIR}/bodesmith.zsh RENAME _bodesmith COMPONENT program
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(FILES ${BODESMITH_COMPLETION_DIR}/bodesmith.fish COMPONENT program
  DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(FILES README.md KNOWNBUGS.md CITATION.cff DESTINATION ${BODESMITH_DOC_DIR} COMPONENT program)
install(DIRECTORY docs/ DESTINATION ${BODESMITH_DOC_DIR}/docs COMPONENT program
  FILES_MATCHING PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png")

# The library.
configure_package_config_file(cmake/bodesmithConfig.cmake.in bodesmithConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/bodesmith)
write_basic_package_version_file(bodesmithConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(TARGETS bodesmith ${BODESMITH_ROOM_TARGETS} EXPORT bodesmithTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(DIRECTORY src/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/bodesmith COMPONENT development
  FILES_MATCHING PATTERN "*.hpp" PATTERN cli EXCLUDE PATTERN mpi EXCLUDE)
install(FILES ${CMAKE_BINARY_DIR}/generated/base/version.hpp COMPONENT development
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/bodesmith/base)
install(EXPORT bodesmithTargets NAMESPACE bodesmith:: COMPONENT development
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/bodesmith)
install(FILES ${CMAKE_BINARY_DIR}/bodesmithConfig.cmake ${CMAKE_BINARY_DIR}/bodesmithConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/bodesmith COMPONENT development)

# pkg-config: the rooms from the lowest floor up are to be linked from the highest down.
set(BODESMITH_PC_LIBS "")
foreach(room ${BODESMITH_ROOMS})
  if(NOT room STREQUAL cli)
    string(PREPEND BODESMITH_PC_LIBS "-lbodesmith_${room} ")
  endif()
endforeach()
foreach(archive cvode elementary)
  if(TARGET bodesmith_${archive})
    install(TARGETS bodesmith_${archive} EXPORT bodesmithTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
    string(APPEND BODESMITH_PC_LIBS "-lbodesmith_${archive} ")
  endif()
endforeach()
string(STRIP "${BODESMITH_PC_LIBS}" BODESMITH_PC_LIBS)
file(RELATIVE_PATH BODESMITH_PC_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(cmake/bodesmith.pc.in ${CMAKE_BINARY_DIR}/bodesmith.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/bodesmith.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

if(TARGET bodesmith_mpi)
  install(TARGETS bodesmith_mpi LIBRARY DESTINATION lib/bodesmith COMPONENT mpi)
endif()

if(PROJECT_IS_TOP_LEVEL)
  include(Packages)
endif()
