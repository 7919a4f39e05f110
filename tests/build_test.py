#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""scripts/build on a project of one file: a build that began without ccache compiles nothing anew when ccache is there."""
import os
import pathlib
import shutil
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PRESETS = """{"version": 3,
 "configurePresets": [{"name": "release", "generator": "Ninja", "binaryDir": "${sourceDir}/build"}],
 "buildPresets": [{"name": "release", "configurePreset": "release"}]}"""
PROJECT = "cmake_minimum_required(VERSION 3.22)\nproject(One LANGUAGES CXX)\nadd_executable(one one.cpp)\n"


def program(path, text):
    path.write_text("#!/bin/sh\n" + text)
    path.chmod(0o755)


def main():
    with tempfile.TemporaryDirectory() as name:
        project = pathlib.Path(name)
        tools, scripts = project / "tools", project / "scripts"
        tools.mkdir()
        scripts.mkdir()
        for tool in pathlib.Path("/usr/bin").iterdir():
            if tool.name != "ccache":
                (tools / tool.name).symlink_to(tool)
        for script in ("build", "usage.sh"):
            shutil.copy(ROOT / "scripts" / script, scripts)
        program(scripts / "install_packages", "exit 0\n")
        (project / "CMakePresets.json").write_text(PRESETS)
        (project / "CMakeLists.txt").write_text(PROJECT)
        (project / "one.cpp").write_text("int main() {}\n")

        def compiled():
            environment = {key: value for key, value in os.environ.items() if not key.startswith(("CMAKE_", "CCACHE_"))}
            subprocess.run([scripts / "build"], check=True, env={**environment, "PATH": str(tools)}, capture_output=True)
            return next((project / "build").rglob("one.cpp.o")).stat().st_mtime_ns

        first = compiled()
        program(tools / "ccache", f'echo called >> "{project}/calls"\nexec "$@"\n')
        assert compiled() == first, "another launcher compiles everything anew"
        shutil.rmtree(project / "build")
        compiled()
        assert (project / "calls").exists(), "a new build does not use ccache"


if __name__ == "__main__":
    main()
