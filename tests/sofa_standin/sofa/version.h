// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

/// The release whose names and signatures the stand-in has.
#define SOFA_VERSION 260600
