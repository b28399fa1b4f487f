#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>

#include "python/src/arrays.h"
#include "python/src/call.h"
#include "python/src/warnings.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"
#include "studies/compare/calibrate.h"
#include "studies/compare/calibration_results.h"

namespace gladstone::python {
namespace {

Calibration calibrate(std::string const& place, std::vector<std::string> const& images) {
  Calibration calibration = images.empty() ? calibrate_case(place) : calibrate_images(place, images);
  log_warnings(calibration.warnings);
  return calibration;
}

/// Returns one array of the dots by name; None if it does not exist.
nb::object calibration_array(nb::handle_t<Calibration> self, std::string const& name) {
  Calibration const& all = nb::cast<Calibration&>(self);
  if (name == "world_m") return view_of(all.points.world, self);
  if (name == "pixel") return view_of(all.points.pixel, self);
  if (name == "residual_px") return view_of(all.pinhole.residual_px, self);
  if (name == "pinhole") return view_of(all.pinhole.camera.value.data(), {PinholeCamera::count}, self);
  if (name == "standard_error") return view_of(all.pinhole.standard_error.data(), {PinholeCamera::count}, self);
  if (name == "plane_of") {
    std::vector<std::int64_t> planes(all.plane_of.begin(), all.plane_of.end());
    std::size_t const count = planes.size();
    return array_of(std::move(planes), {count});
  }
  return nb::none();
}

}  // namespace

void bind_calibration(nb::module_& module) {
  nb::class_<Calibration>(module, "Calibration", "Camera models fitted to images of a dot grid.")
      .def_prop_ro("warnings", [](Calibration const& self) { return warning_texts(self.warnings); })
      .def("array", &calibration_array, nb::arg("name"))
      .def("json", [](Calibration const& self) { return json_text(calibration_json(self)); })
      .def("text", [](Calibration const& self) { return calibration_table(self); })
      .def(
          "save",
          [](Calibration const& self, std::string const& path) { run([&] { write_calibration_file(path, self); }); },
          nb::arg("path"))
      .def(
          "draw", [](Calibration const& self, std::string const& path) { run([&] { draw_calibration(path, self); }); },
          nb::arg("path"));
  module.def(
      "calibrate",
      [](std::string const& place, std::vector<std::string> const& images, nb::handle progress) {
        return run([&] { return calibrate(place, images); }, progress);
      },
      nb::arg("place"), nb::arg("images"), nb::arg("progress").none());
}

}  // namespace gladstone::python
