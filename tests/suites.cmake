# SPDX-License-Identifier: LGPL-2.1-or-later
# Read by ctest: adds a test for each suite of `executable`, whose tests one process runs, one after the other.
if(NOT EXISTS ${executable})
  add_test(${executable} ${executable})  # which fails: it is not built
  return()
endif()
execute_process(COMMAND ${executable} --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${executable} --gtest_list_tests: ${failed}")
endif()
string(REGEX MATCHALL "(^|\n)[^ \n]+\\.[ \n]" suites "${listed}")
foreach(suite IN LISTS suites)
  string(REGEX REPLACE "^\n|\\..*" "" suite "${suite}")
  add_test(${suite} ${executable} --gtest_filter=${suite}.*)
  set_tests_properties(${suite} PROPERTIES ${properties})
endforeach()
