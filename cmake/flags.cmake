# SPDX-License-Identifier: LGPL-2.1-or-later
# Flags of every target of ours, and the options that choose them.
option(HEXAPLAST_WARNINGS_AS_ERRORS "Treat compiler warnings as errors" OFF)
option(HEXAPLAST_HARDENING "Compile with checks against overflows of buffers and of the stack" OFF)
set(HEXAPLAST_SANITIZE "" CACHE STRING "Sanitizers to build with, e.g. address,undefined")

add_library(hexaplast_flags INTERFACE)
# Contraction to FMA changes the last bit between machines; we promise the same bits.
target_compile_options(hexaplast_flags INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -ffp-contract=off
                       $<$<BOOL:${HEXAPLAST_WARNINGS_AS_ERRORS}>:-Werror>)
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)  # which takes the files that are compiled at a time for headers
  target_compile_options(hexaplast_flags INTERFACE -Wno-subobject-linkage)
endif()
# Tables of addresses are filled when a program starts and read-only from then on.
target_link_options(hexaplast_flags INTERFACE -Wl,-z,relro,-z,now)
if(HEXAPLAST_HARDENING)
  target_compile_options(hexaplast_flags INTERFACE -fstack-protector-strong -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2)
endif()
if(HEXAPLAST_SANITIZE)
  # a null pointer that is used ends the program by itself, and the address sanitizer sees what an address beyond its object
  # reads or writes: to ask before each use takes two fifths of the compile
  # time
  target_compile_options(hexaplast_flags INTERFACE -fsanitize=${HEXAPLAST_SANITIZE} -fno-omit-frame-pointer
                         -fno-sanitize-recover=all -fno-sanitize=null,object-size,pointer-overflow
                         $<$<CXX_COMPILER_ID:Clang>:-fsanitize-ignorelist=${CMAKE_CURRENT_LIST_DIR}/sanitize_ignore.txt>)
  # Clang puts the sanitizer into programs alone: libraries find it when they are loaded, not when they are linked.
  target_link_options(hexaplast_flags INTERFACE -fsanitize=${HEXAPLAST_SANITIZE} -Wl,-z,undefs)
endif()
