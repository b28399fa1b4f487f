#include <nanobind/stl/string.h>

#include <exception>
#include <filesystem>

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
    problems.append(nb::make_tuple(problem.where, problem.message, problem.key, error_code_name(problem.code)));
  }
  set_error("SetupError", problems, error.more());
}

/// Returns the name of the Python class for a DataError; two codes have their own classes.
char const* data_error_name(ErrorCode code) {
  if (code == ErrorCode::no_valid_vector) return "NoValidVector";
  return code == ErrorCode::memory ? "OutOfMemory" : "DataError";
}

/// The exceptions of gladstone are translated here, those of other libraries by nanobind.
void translate(std::exception_ptr const& thrown, void* /*payload*/) {
  try {
    std::rethrow_exception(thrown);
  } catch (SetupError const& error) {
    set_setup_error(error);
  } catch (Interrupted const& error) {
    PyErr_SetString(PyExc_KeyboardInterrupt, error.what());
  } catch (DataError const& error) {
    set_error(data_error_name(error.code()), error.place(), error.message(), error_code_name(error.code()),
              error.key());
  } catch (OutputError const& error) {
    set_error("OutputError", error.place(), error.message(), error_code_name(error.code()));
  } catch (DeviceError const& error) {
    set_error("DeviceError", std::string(error.what()));
  } catch (std::filesystem::filesystem_error const& error) {
    std::string const path = error.path1().string();
    set_error("DataError", path.empty() ? "\"\"" : path, "cannot be accessed (" + error.code().message() + ")",
              error_code_name(ErrorCode::unreadable_file));
  }
}

}  // namespace

void translate_errors() { nb::register_exception_translator(translate); }

}  // namespace gladstone::python
