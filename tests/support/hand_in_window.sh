#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Takes an instrument in the live window, on the screen that there is (on_screen.sh), presses it on tissue with the
# wheel, lets go, undoes that, presses again, and closes the window.
#   hand_in_window.sh HEXAPLAST SCENE X Y KEY
# What `hexaplast view` prints goes to the file outcome, what was done to recorded.scn. Pictures: 1 while it presses, 2
# after the undo, 3 at the end.
set -euo pipefail
hexaplast=$1 scene=$2 x=$3 y=$4 key=$5

window=
trap 'kill $window 2> /dev/null || true' EXIT

"$hexaplast" view "$scene" --free --run --record recorded.scn > outcome &
window=$!
timeout 120 xdotool search --sync --onlyvisible --name Hexaplast > /dev/null

# Waits until there are so many pictures: the window has then seen everything that was done before.
take_picture() {
  xdotool key p
  for _ in $(seq 600); do
    [ "$(find . -name '*_*.png' | wc -l)" -ge "$1" ] && return
    sleep 0.1
  done
  return 1
}
press() {
  xdotool mousedown 1
  sleep 0.3
  for _ in $(seq 6); do
    xdotool click 4
    sleep 0.05
  done
  sleep 0.3
}

xdotool mousemove "$x" "$y"
xdotool key "$key"
sleep 0.5
press
take_picture 1
xdotool mouseup 1
sleep 0.3
xdotool key u
sleep 0.3
take_picture 2
press
xdotool mouseup 1
take_picture 3
xdotool key q
wait $window
