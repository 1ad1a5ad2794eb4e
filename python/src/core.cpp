/// The extension module `hydrapod._core`. hydrapod/__init__.py is what people use.

#include <filesystem>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/version.hpp"
#include "support.hpp"

namespace hydrapod::python {

namespace {

/// Raises hydrapod.InputError or hydrapod.ComputationError; OSError where a path cannot be looked
/// up, as open() does.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const base::InputError& error) {
    py::list findings;
    for (const auto& one : error.diagnostics())
      findings.append(py::make_tuple(one.severity == base::Severity::error ? "error" : "warning",
                                     in_words_of_python(one.file), one.line, one.column, one.key,
                                     in_words_of_python(one.message)));
    const auto type = py::module_::import("hydrapod._errors").attr("InputError");
    PyErr_SetObject(type.ptr(), py::make_tuple(in_words_of_python(error.what()), findings).ptr());
  } catch (const base::ComputationError& error) {
    const auto type = py::module_::import("hydrapod._errors").attr("ComputationError");
    PyErr_SetString(type.ptr(), in_words_of_python(error.what()).c_str());
  } catch (const std::filesystem::filesystem_error& error) {
    PyErr_SetObject(
        PyExc_OSError,
        py::make_tuple(error.code().value(), error.code().message(), error.path1().string()).ptr());
  }
}

/// Older versions of pybind11 read NumPy 1's descriptions of types: with NumPy 2 all strides would
/// be wrong.
void require_numpy() {
#if PYBIND11_VERSION_HEX < 0x020C0000
  const auto version = py::module_::import("numpy").attr("__version__").cast<std::string>();
  if (version.substr(0, version.find('.')) != "1")
    throw py::import_error("this build of hydrapod is for NumPy 1 and NumPy is " + version +
                           "; install numpy<2, or build hydrapod with pybind11 2.12 or newer");
#endif
}

}  // namespace

}  // namespace hydrapod::python

PYBIND11_MODULE(_core, module) {
  using namespace hydrapod::python;
  require_numpy();
  module.doc() = "hydrapod's tasks as an extension module; see hydrapod.";
  module.attr("version") = hydrapod::base::version;
  py::register_exception_translator(&translate);
  module.def("write_text", &hydrapod::base::write_file_whole, py::arg("path"), py::arg("text"),
             "Writes a file whole, or leaves what is there.");
  py::class_<Result, std::shared_ptr<Result>>(module, "Result")
      .def_property_readonly(
          "json", [](const Result& result) { return result.document().dump(); },
          "The document that the command line prints as JSON, but for `reproduction`.")
      .def(
          "to_dict",
          [](const Result& result) {
            return py::module_::import("json").attr("loads")(result.document().dump());
          },
          "The same as a dict.");
  add_machine(module);
  add_linear(module);
  add_record(module);
  add_measurement(module);
  add_fit(module);
  add_simulation(module);
  add_plant(module);
  add_study(module);
  add_design(module);
  add_compare(module);
  add_exchange(module);
  add_kinematics(module);
  add_records(module);
  add_realtime(module);
  py::module_::import("atexit").attr("register")(py::cpp_function(&end_all));
  // else the child of os.fork() would wait at its end for the calls of its parent
  py::module_::import("os").attr("register_at_fork")(py::arg("after_in_child") =
                                                         py::cpp_function(&forget_calls));
}
