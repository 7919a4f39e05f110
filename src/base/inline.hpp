// SPDX-License-Identifier: LGPL-2.1-or-later
// How formulas are compiled: into their callers, and for a device too where the compiler knows one. There a call would
// put its arguments on a stack.
#pragma once

#if defined(__CUDACC__) || defined(__CUDA__)
#define HEXAPLAST_DEVICE __attribute__((host)) __attribute__((device))
#define HEXAPLAST_INLINE HEXAPLAST_DEVICE inline __attribute__((always_inline))
#define HEXAPLAST_NOINLINE HEXAPLAST_INLINE
#else
#define HEXAPLAST_DEVICE
#define HEXAPLAST_INLINE inline __attribute__((always_inline))
#define HEXAPLAST_NOINLINE __attribute__((noinline))
#endif
