#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "python/src/arrays.h"
#include "python/src/call.h"
#include "python/src/warnings.h"
#include "render/base/not_a_number.h"
#include "render/base/units.h"
#include "studies/case/json_text.h"
#include "studies/compare/stereo.h"
#include "studies/compare/stereo_file.h"

namespace gladstone::python {
namespace {

/// Returns the positions of the columns (x) or rows (y) of the nodes [mm].
nb::object node_axis_mm(StereoMeasurement const& self, bool along_x) {
  stereo::NodeGrid const& grid = self.field.grid;
  std::vector<double> axis;
  for (int i = 0; i < (along_x ? grid.columns : grid.rows); ++i)
    axis.push_back(((along_x ? grid.first.x : grid.first.y) + i * grid.spacing) / unit::mm);
  std::size_t const count = axis.size();
  return array_of(std::move(axis), {count});
}

/// Returns values of the nodes, [rows, columns, components] or for one component [rows, columns]; NaN where not
/// determined.
/// @param value  (vector, component) of a determined node
template <class Value>
nb::object node_array(StereoMeasurement const& self, std::size_t components, Value const& value) {
  std::vector<double> values;
  for (auto const& node : self.field.nodes)
    for (std::size_t k = 0; k < components; ++k) values.push_back(node ? value(*node, k) : not_a_number);
  std::vector<std::size_t> shape{static_cast<std::size_t>(self.field.grid.rows),
                                 static_cast<std::size_t>(self.field.grid.columns)};
  if (components > 1) shape.push_back(components);
  return array_of(std::move(values), shape);
}

/// Returns one quantity of the nodes by name; None if it does not exist.
nb::object stereo_array(StereoMeasurement const& self, std::string const& name) {
  using stereo::StereoVector;
  auto const mm = [](Vec3d const& vector, std::size_t k) { return vector[static_cast<int>(k)] / unit::mm; };
  if (name == "displacement")
    return node_array(self, 3, [&](StereoVector const& v, std::size_t k) { return mm(v.displacement, k); });
  if (name == "sigma")
    return node_array(self, 3, [&](StereoVector const& v, std::size_t k) { return mm(v.sigma(), k); });
  if (name == "covariance")
    return node_array(self, 6,
                      [](StereoVector const& v, std::size_t k) { return v.covariance[k] / (unit::mm * unit::mm); });
  if (name == "residual") return node_array(self, 1, [](StereoVector const& v, std::size_t) { return v.residual_px; });
  if (name == "residual_ratio")
    return node_array(self, 1, [](StereoVector const& v, std::size_t) { return v.residual_ratio; });
  if (name == "valid")
    return node_array(self, 1,
                      [](StereoVector const& v, std::size_t) { return v.status == VectorStatus::valid ? 1.0 : 0.0; });
  if (name == "truth" && !self.truth.empty()) {
    std::vector<double> values;
    for (Vec3d const& truth : self.truth)
      for (std::size_t k = 0; k < 3; ++k) values.push_back(mm(truth, k));
    return array_of(std::move(values), {static_cast<std::size_t>(self.field.grid.rows),
                                        static_cast<std::size_t>(self.field.grid.columns), 3});
  }
  return nb::none();
}

}  // namespace

void bind_stereo(nb::module_& module) {
  nb::class_<StereoMeasurement>(module, "StereoMeasurement", "Displacement in three components.")
      .def_prop_ro("warnings", [](StereoMeasurement const& self) { return warning_texts(self.warnings); })
      .def("x_mm", [](StereoMeasurement const& self) { return node_axis_mm(self, true); })
      .def("y_mm", [](StereoMeasurement const& self) { return node_axis_mm(self, false); })
      .def("array", &stereo_array, nb::arg("name"))
      .def("summary", [](StereoMeasurement const& self) { return json_text(summarize_stereo(self)); })
      .def("text", [](StereoMeasurement const& self) { return stereo_report(self); })
      .def(
          "save", [](StereoMeasurement const& self, std::string const& path) { write_stereo(path, self); },
          nb::arg("path"));
  module.def(
      "stereo",
      [](std::string const& first, std::string const& second, std::vector<std::string> const& calibrations,
         std::optional<std::string> const& conventions, double sheet_z_mm, std::array<double, 2> const& sheet_slope,
         bool align, std::vector<std::string> const& images, bool dewarp_images, double spacing_mm,
         std::optional<double> window_px, double residual_limit, std::string const& device, nb::handle progress) {
        return run(
            [&] {
              StereoOptions options;
              options.inputs = {first, second};
              options.calibrations = calibrations;
              options.conventions = conventions;
              options.plane = {sheet_z_mm * unit::mm, {sheet_slope[0], sheet_slope[1]}};
              options.align = align;
              options.images = images;
              options.dewarp_images = dewarp_images;
              options.spacing = spacing_mm * unit::mm;
              options.window_px = window_px;
              options.residual_limit = residual_limit;
              return std::make_shared<StereoMeasurement>(measure_stereo(options, open_device(device)));
            },
            progress);
      },
      nb::arg("first"), nb::arg("second"), nb::arg("calibrations"), nb::arg("conventions").none(),
      nb::arg("sheet_z_mm"), nb::arg("sheet_slope"), nb::arg("align"), nb::arg("images"), nb::arg("dewarp_images"),
      nb::arg("spacing_mm"), nb::arg("window_px").none(), nb::arg("residual_limit"), nb::arg("device"),
      nb::arg("progress").none());
}

}  // namespace gladstone::python
