# Every file under templates/ becomes a string in the library, so that an installed program needs no data files; those under
# schemas/ too, with the folder's name in front of theirs.
function(bodesmith_embed_templates target folder schemas)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE ${folder} ${folder}/*)
  list(TRANSFORM files PREPEND ${folder}/ OUTPUT_VARIABLE absolute)
  file(GLOB schema_files CONFIGURE_DEPENDS ${schemas}/*.schema.json)
  list(APPEND absolute ${schema_files})
  set(output ${CMAKE_BINARY_DIR}/generated/embedded_templates.cpp)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DFOLDER=${folder} "-DFILES=${files}" "-DSCHEMAS=${schema_files}" -DOUTPUT=${output}
            -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/embed.cmake
    DEPENDS ${absolute} ${CMAKE_CURRENT_SOURCE_DIR}/cmake/embed.cmake VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()
