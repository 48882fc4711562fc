# Run by CPack on each component's folder before it becomes a package: what Debian wants and an installation from sources does not.
# Manual pages and the changelog packed, a copyright file, examples where Debian has them.
find_program(GZIP gzip REQUIRED)
file(GLOB parts LIST_DIRECTORIES true ${CPACK_TEMPORARY_DIRECTORY}/*)
set(names_program bodesmith)
set(names_development libbodesmith-dev)
set(names_mpi bodesmith-mpi)
get_filename_component(source ${CMAKE_CURRENT_LIST_DIR}/.. ABSOLUTE)
foreach(part ${parts})
  get_filename_component(component ${part} NAME)
  if(NOT IS_DIRECTORY ${part}/usr OR NOT DEFINED names_${component})
    continue()
  endif()
  set(package ${names_${component}})
  set(doc ${part}/usr/share/doc/${package})
  file(READ ${source}/LICENSE licence)
  string(REGEX MATCH "Copyright[^\n]*" copyright "${licence}")
  string(REGEX REPLACE "^Copyright *(\\([cC]\\))? *" "" copyright "${copyright}")
  string(REGEX REPLACE "\n\n" "\n.\n" body "${licence}")
  string(REGEX REPLACE "^[^\n]*\n(\\.\n)?(Copyright[^\n]*\n)?(\\.\n)?" "" body "${body}")
  string(REGEX REPLACE "\n+$" "" body "${body}")
  string(REGEX REPLACE "\n" "\n " body "${body}")
  file(WRITE ${doc}/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: bodesmith

Files: *
Copyright: ${copyright}
License: MIT

License: MIT
 ${body}
")
  set(date $ENV{SOURCE_DATE_EPOCH})
  execute_process(COMMAND date -R --utc OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE)
  file(WRITE ${doc}/changelog.Debian "bodesmith (${CPACK_PACKAGE_VERSION}-1) unstable; urgency=low

  * Packaged by CPack; changelog of the program: changelog.gz.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
  file(COPY_FILE ${source}/CHANGELOG.md ${doc}/changelog)
  file(GLOB pages ${part}/usr/share/man/man1/*.1)
  execute_process(COMMAND ${GZIP} -9nf ${doc}/changelog.Debian ${doc}/changelog ${pages})
  if(component STREQUAL program AND IS_DIRECTORY ${part}/usr/share/bodesmith/examples)
    file(CREATE_LINK ../../bodesmith/examples ${doc}/examples SYMBOLIC)
  endif()
endforeach()
