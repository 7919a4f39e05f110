# SPDX-License-Identifier: LGPL-2.1-or-later
"""States of runs: the stream that the command writes (plugin/record/state_stream.hpp), and HDF5 files of them."""

import itertools
import json
import os
import signal
import sys
import zlib

import h5py
import numpy as np
from h5py import h5d, h5p, h5s, h5t
from h5py._objects import phil

CHUNK_BYTES = 256 * 1024  # several states of small bodies together; a part of one state of large ones
MAX_CHUNK_STATES = 256
COMPRESSION = 4
HEAD = b"hexaplast states 2 "
END, SPLIT = -1, -2  # in place of a step


class EndOfRun(Exception):
    """A stream without its end: the run has failed."""


class Stream:
    """The states of a run, as they come. `positions` (n, 3) [m], initial; iterating gives records with step, time [s],
    probes, measures, and the fields by their names. As of the latest record: `hexahedra` (m, 8), and `initial_node`, of
    which each node is a copy; both are longer where nodes have split. `attributes` has those of the end after the last
    state.
    """

    def __init__(self, file):
        self._file = file
        line = file.readline()
        if not line.startswith(HEAD) or not line.endswith(b"\n"):
            raise EndOfRun
        self.head = json.loads(line[len(HEAD):])
        n, m = self.head["nodes"], self.head["hexahedra"]
        self.positions = np.frombuffer(self._read(24 * n)).reshape(n, 3)
        self.attributes = dict(self.head["attributes"])
        self.initial_node = np.arange(n, dtype=np.int32)
        self._read_hexahedra()

    def _read_hexahedra(self):
        n, m = len(self.initial_node), self.head["hexahedra"]
        self.hexahedra = np.frombuffer(self._read(32 * m), np.int32).reshape(m, 8)
        shapes = {"nodes": (n, 3), "hexahedra": (m,)}
        self.type = np.dtype([("step", "i8"), ("time", "f8"), ("probes", "f8", (len(self.head["probes"]),)),
                              ("measures", "f8", (len(self.head["measures"]),)),
                              *[(field["name"], "f8", shapes[field["of"]]) for field in self.head["fields"]]])

    def __iter__(self):
        while (step := self._read_integer()) != END:
            if step == SPLIT:
                added = np.frombuffer(self._read(4 * self._read_integer()), np.int32)
                self.initial_node = np.concatenate([self.initial_node, added])
                self._read_hexahedra()
            else:
                yield np.frombuffer(np.int64(step).tobytes() + self._read(self.type.itemsize - 8), self.type)[0]
        try:
            self.attributes.update(json.loads(self._file.read()))
        except ValueError:
            raise EndOfRun from None

    def _read_integer(self):
        return int(np.frombuffer(self._read(8), "i8")[0])

    def _read(self, size):
        data = self._file.read(size)
        if len(data) < size:
            raise EndOfRun
        return data


class _Series:
    """A data set that grows by a row per state, and along the first dimension of its rows; what earlier rows lack is
    `fill`. Chunks are compressed outside of HDF5, where threads do not wait for each other."""

    def __init__(self, file, name, stored, row, unit="", fill=0):
        chunk, size = list(row), 8
        for d in reversed(range(len(row))):
            chunk[d] = max(1, min(row[d], CHUNK_BYTES // size))
            size *= chunk[d]
        self._chunk = (min(max(CHUNK_BYTES // size, 1), MAX_CHUNK_STATES), *chunk)
        longest = (None, None, *row[1:]) if row else (None,)
        self.set = file.create_dataset(name, (0, *row), stored, chunks=self._chunk, maxshape=longest, shuffle=True,
                                       compression="gzip", compression_opts=COMPRESSION, track_times=False,
                                       fillvalue=fill)
        if unit:
            self.set.attrs["unit"] = unit
        self._fill = fill
        self._rows = np.full((self._chunk[0], *row), fill, stored)
        self._count = 0

    def append(self, value):
        if self.set.ndim > 1 and len(value) > self._rows.shape[1]:
            added = (self._rows.shape[0], len(value) - self._rows.shape[1], *self._rows.shape[2:])
            self._rows = np.concatenate([self._rows, np.full(added, self._fill, self._rows.dtype)], axis=1)
            self.set.resize(len(value), axis=1)
        self._rows[self._count % self._chunk[0]] = value
        self._count += 1
        if self._count % self._chunk[0] == 0:
            self._write()

    def close(self):
        if self._count % self._chunk[0] != 0:
            self._rows[self._count % self._chunk[0]:] = self._fill
            self._write()

    def _write(self):
        self.set.resize(self._count, axis=0)
        first = (self._count - 1) // self._chunk[0] * self._chunk[0]
        row, chunk = self._rows.shape[1:], self._chunk[1:]
        for corner in itertools.product(*[range(0, all, part) for all, part in zip(row, chunk)]):
            block = np.full(self._chunk, self._fill, self._rows.dtype)
            inside = self._rows[(slice(None), *[slice(at, at + part) for at, part in zip(corner, chunk)])]
            block[tuple(slice(0, size) for size in inside.shape)] = inside
            shuffled = block.reshape(-1).view(np.uint8).reshape(-1, block.itemsize).T.tobytes()
            compressed = zlib.compress(shuffled, COMPRESSION)
            with phil:  # the lock of h5py, which this method alone does not take: threads would wait for each other for ever
                self.set.id.write_direct_chunk((first, *corner), compressed)


def write_states(stream, path, ready=lambda: None):
    """Writes an HDF5 file (docs/studies.md) of a stream. Equal runs give equal bytes. ready: called when the file is open.
    Raises EndOfRun if the run fails; OSError."""
    with h5py.File(path, "w", locking=False) as file:
        ready()
        states = Stream(stream)
        file.create_group("overrides").attrs.update(states.head["overrides"])
        file.create_dataset("positions", data=states.positions, dtype="<f8", track_times=False).attrs["unit"] = "m"
        file.create_dataset("hexahedra", data=states.hexahedra, dtype="<i4", track_times=False)
        series = {"step": _Series(file, "step", "<i8", ()), "time": _Series(file, "time", "<f8", (), "s")}
        for field in states.head["fields"]:
            series[field["name"]] = _Series(file, f"fields/{field['name']}", "<f8", states.type[field["name"]].shape,
                                            field["unit"], np.nan)
            series[field["name"]].set.attrs.update({"description": field["description"], "of": field["of"]})
        probes = [_Series(file, f"probes/{name}", "<f8", ()) for name in states.head["probes"]]
        topology, last = None, states.hexahedra
        for state in states:
            if topology is None and len(states.initial_node) > len(states.positions):
                topology = [_Series(file, "topology/step", "<i8", ()),
                            _Series(file, "topology/hexahedra", "<i4", states.hexahedra.shape)]
            if topology and states.hexahedra is not last:
                topology[0].append(state["step"])
                topology[1].append(states.hexahedra)
            last = states.hexahedra
            for name, one in series.items():
                one.append(state[name])
            for one, value in zip(probes, state["probes"]):
                one.append(value)
        for one in (*series.values(), *probes, *(topology or ())):
            one.close()
        if topology:
            file.create_dataset("topology/initial_node", data=states.initial_node, dtype="<i4", track_times=False)
        file.attrs.update(states.attributes)


def _sets_of(path):
    """Shape, type and unit of each data set of a file, by name."""
    found = {}

    def visit(name, one):
        if isinstance(one, h5py.Dataset):
            found[name] = one.shape, one.dtype, one.attrs.get("unit", "")

    with h5py.File(path, "r", locking=False) as file:
        file.visititems(visit)
    return found


def _create_virtual(file, name, runs, shape, stored):
    """As create_virtual_dataset of h5py, which notes the time."""
    made_with = h5p.create(h5p.DATASET_CREATE)
    made_with.set_obj_track_times(False)
    made_with.set_fill_value(np.array(-1 if stored.kind == "i" else np.nan, stored))
    space, source = h5s.create_simple((len(runs), *shape)), h5s.create_simple(shape)
    for number, run in enumerate(runs):
        if run:
            space.select_hyperslab((number, *[0] * len(shape)), (1, *shape))
            made_with.set_virtual(space, run.encode(), f"/{name}".encode(), source)
    space.select_all()
    group, _, own_name = name.rpartition("/")
    h5d.create(file.require_group(group or "/").id, own_name.encode(), h5t.py_create(stored), space, made_with)


def write_overview(path, directory, runs, columns, attributes):
    """Writes one HDF5 file over those of many runs: each data set with the same shape in all of them, with the run as first
    dimension. It reads the data from their files (virtual data sets of HDF5).

    runs: names of files below `directory`; None: there is none, and the values are NaN, or -1 in whole numbers. columns:
    name, unit and values (one per run) of further data sets. Returns the names of data sets whose shapes differ, or that
    only some runs have: they are left out."""
    sets = [_sets_of(directory / run) for run in runs if run]
    common = {name: one for found in sets for name, one in found.items()}
    differing = {name for name, one in common.items() if any(found.get(name, (None,))[0] != one[0] for found in sets)}
    with h5py.File(path, "w", locking=False) as file:
        file.attrs.update(attributes)
        for name, unit, values in columns:
            is_text = len(values) > 0 and isinstance(values[0], str)
            stored = h5py.string_dtype(length=max(1, *map(lambda text: len(text.encode()), values))) if is_text else "<f8"
            one = file.create_dataset(name, data=[v.encode() for v in values] if is_text else values, dtype=stored,
                                      track_times=False)
            if unit:
                one.attrs["unit"] = unit
        for name, (shape, stored, unit) in sorted(common.items()):
            if name in differing:
                continue
            _create_virtual(file, name, runs, shape, stored)
            if unit:
                file[name].attrs["unit"] = unit
    return sorted(differing)


def main():
    """hexaplast-data DESCRIPTOR NAME: writes the HDF5 file of `hexaplast run --data` into an open file, from the stream on
    standard input. Says 1 on standard output when it is ready."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the run decides when it ends
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    descriptor, name = sys.argv[1:]
    try:
        with open(0, "rb", buffering=1 << 20) as stream:
            write_states(stream, f"/proc/self/fd/{descriptor}", lambda: os.write(1, b"1"))
        return 0
    except EndOfRun:
        return 1
    except OSError as error:
        print(f"hexaplast: error: {name}: cannot be written: {error}", file=sys.stderr)
        return 5
