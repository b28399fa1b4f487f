#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <filesystem>

#include "python/src/call.h"
#include "python/src/setup_text.h"
#include "render/base/parallel.h"
#include "render/files/text_file.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/backend.h"
#include "studies/case/cameras.h"
#include "studies/case/case.h"
#include "studies/case/uncertain_inputs.h"

namespace gladstone::python {
namespace {

/// Returns true if a later `replace` can solve a problem of this kind: a key that is still missing, or a file that does
/// not exist yet. All other mistakes are reported at once.
bool may_wait(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_value:
    case ErrorCode::unknown_key:
    case ErrorCode::wrong_type:
    case ErrorCode::out_of_range:
    case ErrorCode::unknown_choice:
    case ErrorCode::syntax:
      return false;
    default:
      return true;
  }
}

/// Returns the setup if its keys have allowed values.
/// @throws SetupError with all problems
SetupText checked(SetupText setup) {
  try {
    run([&] { check_camera_keys(setup.document()); });
  } catch (SetupError const& error) {
    auto const waits = [](SetupProblem const& problem) { return may_wait(problem.code); };
    if (!std::all_of(error.problems().begin(), error.problems().end(), waits)) throw;
  }
  return setup;
}

SetupText read_setup_file(std::string const& path) {
  read_setup_document(path);  // reports a file that cannot be read or is not TOML
  return checked({read_text_file(path), path, std::filesystem::absolute(path).parent_path().string(), {}});
}

/// Returns the resolved setups of all cameras, whose name is empty if there is one camera only.
/// @throws SetupError with all problems
std::vector<std::pair<std::string, std::string>> resolve(SetupText const& setup) {
  std::vector<std::pair<std::string, std::string>> resolved;
  for (auto const& [camera, loaded] : load_cameras(setup.document())) {
    resolved.emplace_back(camera, loaded.document.resolved());
  }
  return resolved;
}

/// Returns the setup without defaults. File names are absolute, unless the setup has problems.
std::string written(SetupText const& setup) {
  SetupDocument document = setup.document();
  try {
    return written_setup(document.copy(), load_cameras(document));
  } catch (SetupError const&) {
    return document.written();
  }
}

}  // namespace

SetupDocument SetupText::document() const {
  SetupDocument document = SetupDocument::from_text(text, name, folder);
  for (std::string const& assignment : overrides) document.override_key(assignment);
  return document;
}

void bind_setup(nb::module_& module) {
  nb::class_<SetupText>(module, "SetupText",
                        "Setup as TOML text with replaced keys, whose names and values are allowed.")
      .def(nb::new_([](std::string text, std::string name, std::string folder, std::vector<std::string> overrides) {
             return checked({std::move(text), std::move(name), std::move(folder), std::move(overrides)});
           }),
           nb::arg("text"), nb::arg("name"), nb::arg("folder"), nb::arg("overrides"))
      .def_static("from_file", &read_setup_file, nb::arg("path"))
      .def_ro("text", &SetupText::text)
      .def_ro("name", &SetupText::name)
      .def_ro("folder", &SetupText::folder)
      .def_ro("overrides", &SetupText::overrides)
      .def(
          "written", [](SetupText const& setup) { return run([&] { return written(setup); }); },
          "Returns the setup as one TOML document, without defaults.")
      .def(
          "resolved",
          [](SetupText const& setup) {
            auto const resolved = run([&] { return resolve(setup); });
            nb::dict by_camera;
            for (auto const& [camera, text] : resolved) by_camera[camera.c_str()] = text;
            return by_camera;
          },
          "Checks the setup and returns it with all defaults, as TOML by name of the camera.");
  module.def("version", &version_text, "Version, commit and backends.");
  module.def("version_json", &version_json, "Version, commit and backends as a JSON object.");
  module.def("set_threads", &set_thread_count, nb::arg("threads"), "Sets the number of threads; 0: all cores.");
  module.def("threads", &thread_count, "Number of threads of parallel work.");
}

}  // namespace gladstone::python
