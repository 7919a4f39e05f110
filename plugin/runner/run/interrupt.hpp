// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace hexaplast::runner {

/// From now on SIGINT and SIGTERM are noted instead of ending the program, and writing to a closed pipe is an error of
/// that write alone.
void watch_signals();

/// Number of the signal that asked the run to end; 0: none did.
int requested_signal();

/// Kills this process when the thread of `parent` ends that has started it, in whatever way.
void end_with(int parent);

}  // namespace hexaplast::runner
