// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <deque>
#include <exception>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "simulation.hpp"

namespace hexaplast::python {
namespace {

/// Simulations that are stepped together, each by one thread of the library.
class Batch {
 public:
  explicit Batch(const py::iterable& simulations) : simulations_(simulations) {
    for (std::size_t k = 0; k < simulations_.size(); ++k) {
      const py::object one = simulations_[k];
      if (!py::isinstance<Simulation>(one))
        throw py::type_error(fmt::format("simulations[{}]: a {} is no Simulation", k, Py_TYPE(one.ptr())->tp_name));
      all_.push_back(&one.cast<Simulation&>());
      for (std::size_t before = 0; before < k; ++before)
        if (all_[before] == all_[k]) throw InputError(fmt::format("simulations[{}] is simulations[{}]", k, before));
    }
    if (all_.empty()) throw InputError("simulations: must be at least one");
  }

  const py::tuple& simulations() const { return simulations_; }

  /// All make one step, also where others fail.
  py::list step(const py::object& actions, const py::object& act) {
    const std::vector<PointArray> forces = forces_of(actions, act);
    std::vector<RunReport> reports(all_.size());
    std::vector<std::exception_ptr> errors(all_.size());
    {
      const Turns turns(all_);
      const py::gil_scoped_release others_may_run;
      parallel_for(static_cast<int>(all_.size()), [&](int k) {
        try {
          all_[k]->advance(forces[k], reports[k]);
        } catch (...) {
          errors[k] = std::current_exception();
        }
      });
    }
    throw_first(errors);
    std::vector<std::string> warnings;
    for (const Simulation* one : all_) std::ranges::move(one->take_warnings(), std::back_inserter(warnings));
    warn(warnings);
    py::list of_each;
    for (const RunReport& report : reports) of_each.append(report);
    return of_each;
  }

  py::array positions() { return shown(positions_, &Simulation::positions); }
  py::array velocities() { return shown(velocities_, &Simulation::velocities); }

 private:
  /// All simulations, for one thread.
  class Turns {
   public:
    explicit Turns(const std::vector<Simulation*>& all) {
      for (Simulation* one : all) turns_.emplace_back(one->taken());
    }

   private:
    std::deque<Turn> turns_;
  };

  /// What actions make of the step to come.
  std::vector<PointArray> forces_of(const py::object& actions, const py::object& act) const {
    const py::tuple given = actions.is_none() ? py::tuple() : py::tuple(actions);
    if (!actions.is_none() && given.size() != all_.size())
      throw InputError(
          fmt::format("actions: {} are given, must be {}: one for each simulation", given.size(), all_.size()));
    std::vector<PointArray> forces;
    for (std::size_t k = 0; k < all_.size(); ++k) {
      py::object action = actions.is_none() ? py::object(py::none()) : py::object(given[k]);
      if (!act.is_none()) action = act(simulations_[k], action);
      const std::string name = fmt::format("{}[{}]", act.is_none() ? "actions" : "forces by act", k);
      forces.push_back(all_[k]->forces_from(name.c_str(), action));
    }
    return forces;
  }

  /// The first one says what has failed; those that failed besides are named.
  static void throw_first(const std::vector<std::exception_ptr>& errors) {
    std::vector<std::size_t> failed;
    for (std::size_t k = 0; k < errors.size(); ++k)
      if (errors[k]) failed.push_back(k);
    if (failed.empty()) return;
    const auto named = [&](const std::exception& error) {
      std::string text = fmt::format("simulations[{}]: {}", failed[0], error.what());
      if (failed.size() > 1)
        text += fmt::format(" (and {} others fail: {})", failed.size() - 1,
                            fmt::join(failed.begin() + 1, failed.end(), ", "));
      return text;
    };
    try {
      std::rethrow_exception(errors[failed[0]]);
    } catch (const NumericalError& error) {
      throw NumericalError(named(error));
    } catch (const InputError& error) {
      throw InputError(named(error));
    }
  }

  /// A view of the block, which has then what the simulations have.
  py::array shown(py::array_t<double>& block, const PointArray& (Simulation::*field)() const) {
    const Turns turns(all_);
    const int num_nodes = all_[0]->num_nodes();
    for (std::size_t k = 1; k < all_.size(); ++k)
      if (all_[k]->num_nodes() != num_nodes)
        throw InputError(fmt::format("simulations[0] has {} nodes, simulations[{}] has {}: no array holds both",
                                     num_nodes, k, all_[k]->num_nodes()));
    if (block.ndim() != 3 || block.shape(1) != num_nodes)
      block = py::array_t<double>({std::ssize(all_), static_cast<py::ssize_t>(num_nodes), py::ssize_t{3}});
    double* to = block.mutable_data();
    for (const Simulation* one : all_) {
      const PointArray& from = (one->*field)();
      to = std::copy_n(from.data(), from.size(), to);
    }
    return view(block.data(), {block.shape(0), block.shape(1), 3}, block);
  }

  py::tuple simulations_;
  std::vector<Simulation*> all_;  // of simulations_, which keeps them alive
  py::array_t<double> positions_, velocities_;
};

}  // namespace

void add_batch(py::module_& module) {
  py::class_<Batch>(module, "Batch",
                    "Simulations that make their steps together, each on one of the library's threads "
                    "(set_num_threads): with the\n"
                    "bits that they have one after the other, for any number of threads.")
      .def(py::init<py::iterable>(), py::arg("simulations"), "At least one, each once, of any meshes")
      .def_property_readonly("simulations", &Batch::simulations, "tuple of Simulation")
      .def("__len__", [](const Batch& b) { return b.simulations().size(); })
      .def("step", &Batch::step, py::arg("actions") = py::none(), py::arg("act") = py::none(),
           "One step of each simulation. actions: one for each, nodal forces (n, 3) [N] or None; or, with act, "
           "anything:\n"
           "act(simulation, action) carries it out before all steps, as by simulation.prescribe, and returns forces or "
           "None.\n"
           "Returns a StepReport of each. Where one fails, the others have made their step, and an ArithmeticError "
           "names it;\n"
           "it is as before its step")
      .def_property_readonly(
          "positions", &Batch::positions,
          "(B, n, 3) [m], read-only, of simulations that have all n nodes. Each call brings the same "
          "memory up to\n"
          "date, which arrays that were taken before show too")
      .def_property_readonly("velocities", &Batch::velocities, "(B, n, 3) [m/s], as positions")
      .def("copy", &copy_of, "A batch of copies of the simulations")
      .def("__copy__", &copy_of)
      .def(py::pickle([](const Batch& b) { return b.simulations(); },
                      [](const py::tuple& simulations) { return std::make_unique<Batch>(simulations); }));
}

}  // namespace hexaplast::python
