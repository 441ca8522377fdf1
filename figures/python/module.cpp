// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The module `lagrain` for Python: regular triangulations in both dimensions, and runs of scenes.
/// A row of an array is a disc, sphere or contact. Lengths are in metres, all units are SI.

#include <lagrain/check.hpp>
#include <lagrain/laguerre2.hpp>
#include <lagrain/laguerre3.hpp>
#include <lagrain/output.hpp>
#include <lagrain/run.hpp>
#include <lagrain/scene.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace py = pybind11;
using namespace lagrain;

namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

// ---- Arrays -------------------------------------------------------------------------------------

/// Rows of Dim numbers as columns of a matrix.
/// @throws ContractError if the array has another shape
template <int Dim>
Columns<Dim> columns_of(const Numbers& rows, const std::string& name) {
  if (rows.ndim() != 2 || rows.shape(1) != Dim) {
    throw ContractError(name + ": expected an array of shape (N, " + std::to_string(Dim) + ")");
  }
  return Eigen::Map<const Columns<Dim>>(rows.data(), Dim, rows.shape(0));
}

Eigen::VectorXd list_of(const Numbers& numbers, const std::string& name, py::ssize_t count) {
  if (numbers.ndim() != 1 || numbers.shape(0) != count) {
    throw ContractError(name + ": expected an array of shape (" + std::to_string(count) + ",)");
  }
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), count);
}

/// A matrix as an array that shares its memory, a row for each column. It cannot be written to, and
/// keeps the owner alive.
template <class Matrix>
py::array view_of(const Matrix& matrix, const py::handle& owner) {
  std::vector<py::ssize_t> shape{matrix.cols(), matrix.rows()};
  if constexpr (Matrix::ColsAtCompileTime == 1) shape = {matrix.rows()};
  py::array view(py::dtype::of<double>(), shape, matrix.data(), owner);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

template <class Number>
py::array_t<Number> table_of(const std::vector<Number>& numbers, py::ssize_t width) {
  py::array_t<Number> table({static_cast<py::ssize_t>(numbers.size()) / width, width});
  std::copy(numbers.begin(), numbers.end(), table.mutable_data());
  return table;
}

// ---- Triangulations -----------------------------------------------------------------------------

/// A regular triangulation with the weights r^2, and the sites as they were given.
template <int Dim>
class PyTriangulation {
 public:
  PyTriangulation(const Numbers& centres, const Numbers& radii) { build(centres, radii); }

  void build(const Numbers& centres, const Numbers& radii) {
    Columns<Dim> x = columns_of<Dim>(centres, "centres");
    const Eigen::VectorXd r = list_of(radii, "radii", x.cols());
    if (!x.allFinite() || !r.allFinite()) throw ContractError("centres and radii must be finite");
    x_ = std::move(x);
    weights_ = r.array().square();
    t_.build(x_, weights_);
  }
  std::int64_t move(const Numbers& centres, const Numbers& radii) {
    const Columns<Dim> x = columns_of<Dim>(centres, "centres");
    const Eigen::VectorXd r = list_of(radii, "radii", x.cols());
    if (x.cols() != x_.cols()) {
      throw ContractError("centres: expected " + std::to_string(x_.cols()) + " rows, got " +
                          std::to_string(x.cols()) + "; insert, remove, or build anew");
    }
    if (!x.allFinite() || !r.allFinite()) throw ContractError("centres and radii must be finite");
    const Eigen::VectorXd w = r.array().square();
    std::vector<int> moved;
    for (int i = 0; i < x.cols(); ++i) {
      if (x.col(i) != x_.col(i) || w[i] != weights_[i]) moved.push_back(i);
    }
    x_ = x;
    weights_ = w;
    return t_.move(moved, x_, weights_).flips;
  }

  py::array_t<int> edges() {
    std::vector<int> list;
    for (const auto& [i, j] : t_.edges()) list.insert(list.end(), {i, j});
    return table_of(list, 2);
  }
  py::array_t<int> simplices() const {
    std::vector<int> list;
    const auto add = [&](auto... corners) { list.insert(list.end(), {corners...}); };
    if constexpr (Dim == 2) {
      t_.for_each_triangle(add);
    } else {
      t_.for_each_tetrahedron(add);
    }
    return table_of(list, Dim + 1);
  }
  std::vector<int> hidden() const { return {t_.hidden().begin(), t_.hidden().end()}; }
  std::vector<std::string> audit() const {
    std::vector<std::string> sentences;
    for (const auto& defect : t_.audit()) sentences.push_back(defect.sentence);
    return sentences;
  }
  py::object cell(int site, const std::array<double, Dim>& low,
                  const std::array<double, Dim>& high) const {
    if (site < 0 || site >= x_.cols()) {
      throw ContractError("there is no site " + std::to_string(site) + " among " +
                          std::to_string(x_.cols()));
    }
    const Eigen::AlignedBox<double, Dim> box(Vec<Dim>(low.data()), Vec<Dim>(high.data()));
    if (!(box.sizes().minCoeff() > 0)) throw ContractError("the box is empty");
    const auto polygon = [](const auto& corners) {
      return table_of(std::vector<double>(corners.data(), corners.data() + corners.size()), Dim);
    };
    if constexpr (Dim == 2) {
      return polygon(laguerre_cell(t_, site, box));
    } else {
      py::list faces;
      for (const LaguerreFace& face : laguerre_cell(t_, site, box)) {
        faces.append(py::make_tuple(face.beyond, polygon(face.corners)));
      }
      return std::move(faces);
    }
  }
  int size() const { return static_cast<int>(x_.cols()); }

 private:
  Triangulation<Dim> t_;
  Columns<Dim> x_;
  Eigen::VectorXd weights_;
};

template <int Dim>
void add_triangulation(py::module_& module, const char* name) {
  using T = PyTriangulation<Dim>;
  const std::string d = std::to_string(Dim);
  py::class_<T>(module, name,
                "The regular triangulation of discs (2) or spheres (3) with weights r^2: exact, "
                "unique, repaired by flips when sites move.")
      .def(py::init<const Numbers&, const Numbers&>(), py::arg("centres"), py::arg("radii"),
           ("centres: shape (N, " + d + ") [m]; radii: shape (N,) [m]. All finite.").c_str())
      .def("build", &T::build, py::arg("centres"), py::arg("radii"),
           "Forgets all sites and takes these.")
      .def("move", &T::move, py::arg("centres"), py::arg("radii"),
           "All sites move or change their radii; returns the number of flips.")
      .def("cell", &T::cell, py::arg("site"), py::arg("low"), py::arg("high"),
           Dim == 2
               ? "The Laguerre cell cut to a box, as corners of shape (K, 2), counter-clockwise "
                 "[m]; K = 0 if the site is hidden."
               : "The Laguerre cell cut to a box, as a list of faces: the site beyond (negative: "
                 "a side of the box), and corners of shape (K, 3), counter-clockwise seen from "
                 "outside [m]. Empty if the site is hidden.")
      .def("audit", &T::audit, "What an exact check finds wrong, in sentences: nothing.")
      .def_property_readonly("edges", &T::edges, "Shape (M, 2): sites, the smaller number first.")
      .def_property_readonly(
          Dim == 2 ? "triangles" : "tetrahedra", &T::simplices,
          ("Shape (K, " + std::to_string(Dim + 1) + "): positively oriented.").c_str())
      .def_property_readonly("hidden", &T::hidden, "Sites whose cell is empty.")
      .def("__len__", &T::size);
}

// ---- Simulations --------------------------------------------------------------------------------

/// A run of a scene.
template <int Dim>
class PySimulation {
 public:
  PySimulation(const std::string& scene, const Settings& settings, int threads)
      : run_(make_run(parse_scene<Dim>(scene, "scene", settings), threads)) {}

  const Run<Dim>& run() const { return *run_; }

  /// Others may run meanwhile; Ctrl-C ends it between two steps.
  void step(std::int64_t count) {
    if (count < 0) throw ContractError("a number of steps is not negative");
    constexpr auto kLook = std::chrono::milliseconds(100);
    while (count > 0) {
      {
        const py::gil_scoped_release others;
        const auto begin = std::chrono::steady_clock::now();
        for (; count > 0 && std::chrono::steady_clock::now() - begin < kLook; --count) {
          run_->step();
        }
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
  }

  /// Where grains come and leave arrays change their size, so they are copied.
  template <class Matrix>
  py::array array(const Matrix& matrix, const py::handle& owner) const {
    const py::array view = view_of(matrix, owner);
    return run_->traffic() ? py::array(view.attr("copy")()) : view;
  }

  py::dict contacts() const {
    std::vector<int> i, j, wall;
    std::vector<double> overlap, normal, force;
    for (const ContactRecord<Dim>& contact : run_->contacts()) {
      i.push_back(contact.i);
      j.push_back(contact.j);
      wall.push_back(contact.wall);
      overlap.push_back(contact.overlap);
      normal.insert(normal.end(), contact.normal.begin(), contact.normal.end());
      force.insert(force.end(), contact.force.begin(), contact.force.end());
    }
    py::dict table;
    table["i"] = py::array_t<int>(static_cast<py::ssize_t>(i.size()), i.data());
    table["j"] = py::array_t<int>(static_cast<py::ssize_t>(j.size()), j.data());
    table["wall"] = py::array_t<int>(static_cast<py::ssize_t>(wall.size()), wall.data());
    table["overlap"] =
        py::array_t<double>(static_cast<py::ssize_t>(overlap.size()), overlap.data());
    table["normal"] = table_of(normal, Dim);
    table["force"] = table_of(force, Dim);
    return table;
  }
  py::dict ledger() const {
    Ledger now = run_->ledger();
    State state;
    now.persist(StateVisitor::keeping(state));
    py::dict table;
    for (const auto& [name, value] : state.values()) {
      table[name.c_str()] = std::get<NumberTable<double>>(value).numbers.front();
    }
    table["residual"] = run_->energy_residual();
    return table;
  }

 private:
  std::unique_ptr<Run<Dim>> run_;
};

template <int Dim>
void add_simulation(py::module_& module, const char* name) {
  using S = PySimulation<Dim>;
  const auto shape = " Shape (N, " + std::to_string(Dim) + "). ";
  const std::string view =
      "A read-only view without a copy: it shows the new state when it is asked for again after a "
      "step (.copy() keeps this one). A copy where grains come and leave.";
  const auto matrix = [](auto get) {
    return [get](const py::object& self) {
      const S& simulation = self.cast<const S&>();
      return simulation.array(get(simulation.run()), self);
    };
  };
  py::class_<S>(module, name, "A simulation of a scene, which is a text (TOML) as files have it.")
      .def(py::init<const std::string&, const Settings&, int>(), py::arg("scene"),
           py::arg("settings") = Settings{}, py::arg("threads") = 1,
           "scene: the text; settings: keys and values that replace the text's, such as "
           "\"law.friction=0.3\"; threads: at most so many share a step.")
      .def("step", &S::step, py::arg("count") = 1,
           "Makes time steps. Other threads of Python run meanwhile, and Ctrl-C ends it.")
      .def(
          "explain", [](const S& s) { return explain(s.run()); },
          "What the scene is made of, in words.")
      .def_property_readonly(
          "time", [](const S& s) { return s.run().time(); }, "[s]")
      .def_property_readonly(
          "time_step", [](const S& s) { return s.run().time_step(); }, "[s]")
      .def_property_readonly(
          "steps", [](const S& s) { return s.run().steps(); }, "made so far")
      .def_property_readonly(
          "duration", [](const S& s) { return s.run().scene().duration; }, "of the scene [s]")
      .def_property_readonly("positions",
                             matrix([](const auto& run) -> const auto& { return run.positions(); }),
                             ("Centres [m]." + shape + view).c_str())
      .def_property_readonly(
          "velocities", matrix([](const auto& run) -> const auto& { return run.velocities(); }),
          ("[m/s]." + shape + view).c_str())
      .def_property_readonly("radii",
                             matrix([](const auto& run) -> const auto& { return run.radii(); }),
                             ("[m]. Shape (N,). " + view).c_str())
      .def_property_readonly("masses",
                             matrix([](const auto& run) -> const auto& { return run.masses(); }),
                             ("[kg]. Shape (N,). " + view).c_str())
      .def_property_readonly(
          "ids",
          [](const S& s) {
            std::vector<int> ids;
            for (int i = 0; i < s.run().count(); ++i) ids.push_back(s.run().id(i));
            return ids;
          },
          "What each grain is called as long as it is there.")
      .def_property_readonly(
          "contacts", &S::contacts,
          "Now: i and its partner, which is grain j (wall is -1) or a wall (j is "
          "-1); overlap [m], normal [-], force on i [N].")
      .def_property_readonly("ledger", &S::ledger,
                             "Where the energy is, and what no entry accounts for (residual) [J].")
      .def("__len__", [](const S& s) { return s.run().count(); });
}

}  // namespace

PYBIND11_MODULE(lagrain, module) {
  module.doc() =
      "Granular simulation of discs and spheres on dynamic regular triangulations. All units are "
      "SI. What is wrong with an input is a ValueError; its text is one sentence.";
  module.attr("__version__") = version();
  py::register_exception<ContractError>(module, "ContractError", PyExc_ValueError);
  py::register_exception<SceneError>(module, "SceneError", PyExc_ValueError);
  py::register_exception<SimulationError>(module, "SimulationError", PyExc_ValueError);
  add_triangulation<2>(module, "Triangulation2");
  add_triangulation<3>(module, "Triangulation3");
  add_simulation<2>(module, "Simulation2");
  add_simulation<3>(module, "Simulation3");
}
