# SPDX-License-Identifier: LGPL-2.1-or-later
# Instruction sets that the kernels are compiled for. Each takes a compiler a minute; programs choose among them when they start.
set(HEXAPLAST_INSTRUCTION_SETS all CACHE STRING "Instruction sets of the kernels: all, or native (the best of this processor)")
set_property(CACHE HEXAPLAST_INSTRUCTION_SETS PROPERTY STRINGS all native)

add_library(hexaplast_kernels INTERFACE)
set(no_faster "HWY_SSSE3|HWY_AVX3_DL")  # than the sets next to them
if(HEXAPLAST_INSTRUCTION_SETS STREQUAL "all")
  set(sets "HWY_DISABLED_TARGETS=(${no_faster})")
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(APPEND sets HWY_BASELINE_TARGETS=HWY_SSE4)  # what is older runs nothing
  endif()
elseif(HEXAPLAST_INSTRUCTION_SETS STREQUAL "native")
  if(NOT DEFINED HEXAPLAST_NATIVE)
    try_run(runs compiles ${PROJECT_BINARY_DIR}/probe ${CMAKE_CURRENT_LIST_DIR}/instruction_sets.cpp
            CMAKE_FLAGS -DINCLUDE_DIRECTORIES=${HWY_INCLUDE_DIR} LINK_LIBRARIES ${HWY_LIBRARY}
            COMPILE_DEFINITIONS "-DHWY_DISABLED_TARGETS=(${no_faster})"
            COMPILE_OUTPUT_VARIABLE log RUN_OUTPUT_VARIABLE native)
    if(NOT runs EQUAL 0)
      message(FATAL_ERROR "HEXAPLAST_INSTRUCTION_SETS=native: the processor cannot be asked; take all\n${log}")
    endif()
    set(HEXAPLAST_NATIVE ${native} CACHE INTERNAL "The best instruction set of this machine")
  endif()
  set(sets HWY_BASELINE_TARGETS=${HEXAPLAST_NATIVE} "HWY_DISABLED_TARGETS=(~${HEXAPLAST_NATIVE})")
else()
  message(FATAL_ERROR "HEXAPLAST_INSTRUCTION_SETS is ${HEXAPLAST_INSTRUCTION_SETS}: must be all or native")
endif()
target_compile_definitions(hexaplast_kernels INTERFACE ${sets})
target_include_directories(hexaplast_kernels INTERFACE ${HWY_INCLUDE_DIR})
target_link_libraries(hexaplast_kernels INTERFACE ${HWY_LIBRARY})
