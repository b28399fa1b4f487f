#include <nanobind/stl/string.h>

#include <exception>

#include "python/src/call.h"
#include "render/base/error.h"

namespace gladstone::python {
namespace {

/// Sets the Python error `name` of gladstone._errors.
template <class... Arguments>
void set_error(char const* name, Arguments&&... arguments) {
  nb::object const type = nb::module_::import_("gladstone._errors").attr(name);
  nb::object const error = type(std::forward<Arguments>(arguments)...);
  PyErr_SetObject(type.ptr(), error.ptr());
}

void set_setup_error(SetupError const& error) {
  nb::list problems;
  for (SetupProblem const& problem : error.problems()) {
    problems.append(nb::make_tuple(problem.where, problem.message, problem.key, problem_code_name(problem.code)));
  }
  set_error("SetupError", problems, error.more());
}

/// The exceptions of gladstone are translated here, those of other libraries by nanobind.
void translate(std::exception_ptr const& thrown, void* /*payload*/) {
  try {
    std::rethrow_exception(thrown);
  } catch (SetupError const& error) {
    set_setup_error(error);
  } catch (Interrupted const& error) {
    PyErr_SetString(PyExc_KeyboardInterrupt, error.what());
  } catch (NoValidVector const& error) {
    set_error("NoValidVector", error.file(), error.message());
  } catch (MemoryError const& error) {
    set_error("OutOfMemory", error.file(), error.message());
  } catch (DataError const& error) {
    set_error("DataError", error.file(), error.message());
  } catch (OutputError const& error) {
    set_error("OutputError", error.path(), error.message());
  } catch (DeviceError const& error) {
    set_error("DeviceError", std::string(error.what()));
  }
}

}  // namespace

void translate_errors() { nb::register_exception_translator(translate); }

}  // namespace gladstone::python
