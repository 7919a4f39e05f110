// SPDX-License-Identifier: LGPL-2.1-or-later
// How formulas are compiled: into their callers, and for a device too where the compiler knows one.
#pragma once

#ifdef __CUDACC__
#define HEXAPLAST_DEVICE __attribute__((host)) __attribute__((device))
#else
#define HEXAPLAST_DEVICE
#endif

#define HEXAPLAST_INLINE HEXAPLAST_DEVICE inline __attribute__((always_inline))
#ifdef __CUDACC__
#define HEXAPLAST_NOINLINE HEXAPLAST_DEVICE inline  // a call would put its arguments on a stack
#else
#define HEXAPLAST_NOINLINE __attribute__((noinline))
#endif
