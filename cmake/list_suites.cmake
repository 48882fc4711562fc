# Run once PROGRAM, a GoogleTest program, is built: OUTPUT then tells ctest of one test for each suite, named ROOM.SUITE, those of
# LONG first to begin.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+\\." suites "${listed}")
set(text "")
foreach(suite ${suites})
  string(REGEX REPLACE "\n|\\.$" "" suite "${suite}")
  set(more "")
  if(suite IN_LIST LONG)
    set(more " COST 30")
  endif()
  string(APPEND text "add_test(${ROOM}.${suite} ${PROGRAM} --gtest_brief=1 --gtest_filter=${suite}.*)\n"
                     "set_tests_properties(${ROOM}.${suite} PROPERTIES TIMEOUT 600 LABELS ${ROOM}${more})\n")
endforeach()
file(WRITE ${OUTPUT} "${text}")
