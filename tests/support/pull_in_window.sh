#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Pulls at a scene in the live window, as a hand would: opens it on the screen that there is (on_screen.sh), presses the
# mouse on tissue, moves it, lets go, takes a picture before and after, and closes the window.
#   pull_in_window.sh HEXAPLAST SCENE FROM_X FROM_Y STEP_X STEP_Y
# What `hexaplast view` prints goes to the file outcome, its last state to final.json, what was done to
# recorded.scn, pictures to this directory.
set -euo pipefail
hexaplast=$1 scene=$2 from_x=$3 from_y=$4 step_x=$5 step_y=$6

window=
trap 'kill $window 2> /dev/null || true' EXIT

"$hexaplast" view "$scene" --free --run --final final.json --record recorded.scn > outcome &
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

xdotool mousemove "$from_x" "$from_y"
take_picture 1
xdotool mousedown 1
take_picture 2
for _ in $(seq 10); do
  xdotool mousemove_relative -- "$step_x" "$step_y"
  sleep 0.05
done
take_picture 3
xdotool mouseup 1
take_picture 4
xdotool key q
wait $window
