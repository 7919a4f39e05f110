# SPDX-License-Identifier: LGPL-2.1-or-later
"""Builds the wheel (PEP 517): what `cmake --install` installs, in the places that it has below a prefix, so that module, command,
libraries and components find one another in a virtual environment as they do anywhere else.

    pip wheel --no-build-isolation --config-settings build-dir=build .

build-dir: a build tree of this Python, in which all is built; otherwise build-wheel/ is configured and built, for all processors.
"""
import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parents[1]
COMPONENTS = ("library", "components", "tools", "python")
PACKAGES = pathlib.Path("lib/python3/dist-packages")  # as deep as lib/python3.11/site-packages


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    named = (config_settings or {}).get("build-dir")
    tree = pathlib.Path(named).resolve() if named else _built()
    if not (tree / "CMakeCache.txt").exists():
        raise SystemExit(f"build-dir={named}: is no build tree of CMake")
    version = re.search(r"^CMAKE_PROJECT_VERSION:\w+=(.*)$", (tree / "CMakeCache.txt").read_text(), re.M).group(1)
    python = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    tag = f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    name = f"hexaplast-{version}-{tag}.whl"
    with tempfile.TemporaryDirectory() as staged:
        for component in COMPONENTS:
            subprocess.run(["cmake", "--install", tree, "--prefix", staged, "--component", component, "--strip"],
                           check=True, stdout=subprocess.DEVNULL)
        files = dict(_places(pathlib.Path(staged), f"hexaplast-{version}.data"))
        module = f"hexaplast/_hexaplast{sysconfig.get_config_var('EXT_SUFFIX')}"
        if module not in files:
            raise SystemExit(f"{tree} has no {module}: configure it with -DHEXAPLAST_WITH_PYTHON=ON "
                             f"-DPython3_EXECUTABLE={sys.executable}")
        _write(pathlib.Path(wheel_directory) / name, files, f"hexaplast-{version}.dist-info", version, tag)
    return name


def _built():
    tree = SOURCE / "build-wheel"
    subprocess.run(["cmake", "-S", SOURCE, "-B", tree, "-DCMAKE_BUILD_TYPE=Release", "-DHEXAPLAST_INSTRUCTION_SETS=all",
                    "-DHEXAPLAST_BUILD_TESTS=OFF", "-DHEXAPLAST_BUILD_BENCHMARKS=OFF", "-DHEXAPLAST_WITH_PYTHON=ON",
                    f"-DPython3_EXECUTABLE={sys.executable}"], check=True)
    subprocess.run(["cmake", "--build", tree, "--parallel", str(os.cpu_count())], check=True)
    return tree


def _places(staged, data):
    """Of each file its place in the wheel, and its content. A wheel has no links: libraries have the names that are linked to."""
    for path in sorted(path for path in staged.rglob("*") if path.is_file()):
        below = path.relative_to(staged)
        if any(other.is_symlink() and other.resolve() == path for other in path.parent.iterdir()):
            continue
        if below.parts[:2] in (("share", "doc"), ("share", "lintian")):  # of Debian packages
            continue
        content = path.read_bytes()
        if below.is_relative_to(PACKAGES):
            yield str(below.relative_to(PACKAGES)), (path, content)
        elif content.startswith(b"#!/usr/bin/python3\n"):
            yield f"{data}/scripts/{path.name}", (path, content.replace(b"#!/usr/bin/python3", b"#!python", 1))
        else:
            yield f"{data}/data/{below}", (path, content)


def _write(wheel, files, info, version, tag):
    readme = (SOURCE / "README.md").read_text().split("\n![")[0]
    texts = {
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: hexaplast\nVersion: {version}\n"
                            "Summary: Real-time hexahedral corotational elastoplastic FEM for surgery simulation\n"
                            "License: LGPL-2.1-or-later\nRequires-Python: >=3.9\nRequires-Dist: numpy\n"
                            "Provides-Extra: studies\nRequires-Dist: scipy; extra == 'studies'\n"
                            "Requires-Dist: h5py; extra == 'studies'\nRequires-Dist: matplotlib; extra == 'studies'\n"
                            f"Description-Content-Type: text/markdown\n\n{readme}\n",
        f"{info}/WHEEL": f"Wheel-Version: 1.0\nGenerator: hexaplast\nRoot-Is-Purelib: false\nTag: {tag}\n",
        f"{info}/LICENSE": (SOURCE / "LICENSE").read_text(),
    }
    record = []
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:

        def add(place, content, mode):
            entry = zipfile.ZipInfo(place)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, (0o100000 | mode) << 16
            archive.writestr(entry, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{place},sha256={digest},{len(content)}")

        for place, (path, content) in files.items():
            add(place, content, path.stat().st_mode & 0o777)
        for place, text in texts.items():
            add(place, text.encode(), 0o644)
        record.append(f"{info}/RECORD,,")
        archive.writestr(f"{info}/RECORD", "\n".join(record) + "\n")
