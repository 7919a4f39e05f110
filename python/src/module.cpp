// SPDX-License-Identifier: LGPL-2.1-or-later
// The Python module: arrays and exceptions are converted here, everything else is the library's.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cerrno>
#include <filesystem>

#include "base/simd.hpp"
#include "body.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/formats/mesh_import.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "instrument.hpp"
#include "record/files.hpp"
#include "scene/reader.hpp"
#include "tools.hpp"

namespace hexaplast::python {
namespace {

/// The library's exceptions as Python's own kinds, with their messages.
void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  } catch (const scene::SceneError& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  } catch (const scene::OverrideError& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  } catch (const NumericalError& error) {
    PyErr_SetString(PyExc_ArithmeticError, error.what());
  } catch (const scene::FileError& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  } catch (const output::OutputError& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  } catch (const scene::PluginError& error) {
    PyErr_SetString(PyExc_ImportError, error.what());
  }
}

py::tuple grid(std::array<int, 3> cells, std::array<double, 3> min, std::array<double, 3> max) {
  const HexMesh mesh = regular_grid(cells, Vec3(min[0], min[1], min[2]), Vec3(max[0], max[1], max[2]));
  return py::make_tuple(taken(mesh.positions()), cells_of(mesh.hexahedra()));
}

py::tuple read(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) {
    errno = ENOENT;
    PyErr_SetFromErrnoWithFilename(PyExc_OSError, file.c_str());
    throw py::error_already_set();
  }
  ImportedMesh mesh = read_mesh(file);
  return py::make_tuple(taken(std::move(mesh.positions)), cells_of(mesh.hexahedra));
}

void set_threads(int count) {
  if (count < 1 || count > kMaxThreads)
    throw py::value_error("number of threads " + std::to_string(count) + " must lie in [1, " +
                          std::to_string(kMaxThreads) + "]");
  set_num_threads(count);
}

}  // namespace

PYBIND11_MODULE(_hexaplast, module) {
  module.doc() = "Hexahedral corotational elastoplastic finite elements in real time";
  module.attr("__version__") = HEXAPLAST_VERSION;
  py::register_exception_translator(&translate);

  add_body(module);
  add_instrument(module);
  add_tools(module);
  add_simulation(module);
  add_batch(module);
  add_scene(module);
  module.def("grid", &grid, py::arg("cells"), py::arg("min"), py::arg("max"),
             "A box of hexahedra between two corners [m]: positions (n, 3) and hexahedra (m, 8), x fastest");
  module.def("read_mesh", &read, py::arg("file"),
             "Positions (n, 3) and hexahedra (m, 8) of a .vtu, .vtk, .msh, .obj or .stl file");
  module.def("set_num_threads", &set_threads, py::arg("count"), "Of every parallel loop; results do not depend on it");
  module.def("num_threads", &num_threads);
  module.def("simd_target", &simd_target, "Instruction set of the kernels; last bits differ between them");
}

}  // namespace hexaplast::python
