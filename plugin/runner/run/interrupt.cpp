// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/interrupt.hpp"

#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

namespace hexaplast::runner {
namespace {

volatile std::sig_atomic_t requested = 0;

void note(int signal) {
  // A second one ends the program at once: the step may be a long one.
  if (requested != 0) std::_Exit(128 + signal);
  requested = signal;
}

}  // namespace

void watch_signals() {
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
  std::signal(SIGPIPE, SIG_IGN);
}

int requested_signal() { return requested; }

void end_with(int parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) std::_Exit(128 + SIGKILL);  // it was too late for the signal
}

}  // namespace hexaplast::runner
