#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs a command on a screen that only exists in memory, drawn by software: on_screen.sh COMMAND [ARGUMENT...]
# The server itself takes a display that is free, so that any number of these may begin at once.
set -euo pipefail

exec 3< <(exec Xvfb -displayfd 1 -screen 0 1440x860x24 -nolisten tcp 2> xvfb.log)
screen=$!
trap 'kill $screen 2> /dev/null || true' EXIT
read -r -t 60 display <&3
export DISPLAY=:$display LIBGL_ALWAYS_SOFTWARE=1
"$@" 3<&-
