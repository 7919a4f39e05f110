# SPDX-License-Identifier: LGPL-2.1-or-later
# For the other scripts: where their first argument is -h or --help, prints the comment at their head and ends.
if [[ ${1:-} == -h || ${1:-} == --help ]]; then
  awk 'NR > 2 && !/^#/ { exit } NR > 2 { sub(/^# ?/, ""); print }' "$0"
  exit 0
fi
