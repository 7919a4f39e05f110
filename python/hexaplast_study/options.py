# SPDX-License-Identifier: LGPL-2.1-or-later
"""Options that hexaplast-sweep and hexaplast-fit share."""

import argparse
import os
import sys

from . import command

EXIT_CODES = ("Exit codes: 0 ok, 2 usage, 3 scene or mesh rejected, 4 numerical failure, 5 input/output, 6 plugin, "
              "130/143 interrupted.")
MAX_THREADS = 1024


class Parser(argparse.ArgumentParser):
    def __init__(self, name, description):
        super().__init__(prog=f"hexaplast {name}", description=description, epilog=EXIT_CODES, allow_abbrev=False)

    def read(self, arguments):
        given, unknown = self.parse_known_args(arguments)
        if unknown:
            self.error(f"unknown option '{unknown[0]}'" if unknown[0].startswith("-") else f"unexpected argument '{unknown[0]}'")
        return given

    def error(self, message):
        print(f"{self.prog}: error: {message}\nRun with --help for more information.", file=sys.stderr)
        sys.exit(command.UsageError.code)


def whole_number(least, most):
    def read(text):
        try:
            number = int(text)
        except ValueError:
            number = None
        if number is None or not least <= number <= most:
            raise argparse.ArgumentTypeError(f"'{text}' must be a whole number from {least} to {most}")
        return number
    return read


def number(word, option):
    """Raises UsageError."""
    try:
        return float(word)
    except ValueError:
        raise command.usage_error(f"{option}: '{word}' is no number") from None


def names(text):
    """Of a list with commas."""
    return text.split(",")


def add_scene(parser, is_required):
    parser.add_argument("scene", metavar="SCENE", nargs=None if is_required else "?", help="scene file")
    parser.add_argument("--set", action="append", default=[], metavar="PATH.attribute=VALUE",
                        help="replace an attribute of the scene; may be repeated")
    parser.add_argument("--mesh-path", action="append", default=[], metavar="DIR",
                        help="directory to look for the scene's meshes and includes in; may be repeated")
    parser.add_argument("--plugin", action="append", default=[], metavar="NAME", help="plugin to load; may be repeated")
    parser.add_argument("--plugin-path", action="append", default=[], metavar="DIR",
                        help="directory to look for plugins in; may be repeated")


def add_jobs(parser):
    parser.add_argument("--jobs", type=whole_number(1, 1024), metavar="N",
                        help="runs at a time; otherwise as many as there are processors")
    parser.add_argument("--threads", type=whole_number(1, MAX_THREADS), metavar="N", help="threads of each run; default 1")


def num_jobs(given, threads):
    return given or max(1, len(os.sched_getaffinity(0)) // (threads or 1))
