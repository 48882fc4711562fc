# Manual pages, completion for shells (both made by the program from its option tables), and the documentation site.
set(BODESMITH_MANUAL_DIR ${CMAKE_BINARY_DIR}/man/man1)
set(BODESMITH_COMPLETION_DIR ${CMAKE_BINARY_DIR}/completion)
add_custom_command(OUTPUT ${BODESMITH_MANUAL_DIR}/bodesmith.1
  COMMAND bodesmith_program manual --quiet -o ${BODESMITH_MANUAL_DIR}
  DEPENDS bodesmith_program VERBATIM)
set(pages ${BODESMITH_MANUAL_DIR}/bodesmith.1)
foreach(shell bash zsh fish)
  add_custom_command(OUTPUT ${BODESMITH_COMPLETION_DIR}/bodesmith.${shell}
    COMMAND bodesmith_program completion ${shell} --quiet -o ${BODESMITH_COMPLETION_DIR}/bodesmith.${shell}
    DEPENDS bodesmith_program VERBATIM)
  list(APPEND pages ${BODESMITH_COMPLETION_DIR}/bodesmith.${shell})
endforeach()
add_custom_target(bodesmith_manual ALL DEPENDS ${pages})

# cmake --build build --target docs: build/docs/html/index.html, from the headers and docs/.
find_package(Doxygen QUIET)
if(DOXYGEN_FOUND)
  configure_file(${CMAKE_CURRENT_SOURCE_DIR}/docs/Doxyfile.in ${CMAKE_BINARY_DIR}/docs/Doxyfile @ONLY)
  add_custom_target(docs COMMAND Doxygen::doxygen ${CMAKE_BINARY_DIR}/docs/Doxyfile
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} VERBATIM)
endif()
