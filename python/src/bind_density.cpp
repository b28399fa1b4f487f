#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "analysis/density/density_methods.h"
#include "python/src/arrays.h"
#include "python/src/call.h"
#include "python/src/warnings.h"
#include "studies/case/json_text.h"
#include "studies/commands/density_options.h"
#include "studies/compare/density_file.h"
#include "studies/compare/reconstruct.h"
#include "studies/compare/reconstruct_case.h"

namespace gladstone::python {
namespace {

/// Returns the positions of the columns (x) or rows (y) of the grid [mm].
nb::object axis_mm(Reconstruction const& self, bool along_x) {
  density::PlaneGrid const& grid = self.grid;
  std::vector<double> axis;
  if (along_x) {
    for (int column = 0; column < grid.columns; ++column) axis.push_back(1e3 * grid.position(column, 0).x);
  } else {
    for (int row = 0; row < grid.rows; ++row) axis.push_back(1e3 * grid.position(0, row).y);
  }
  std::size_t const count = axis.size();
  return array_of(std::move(axis), {count});
}

/// Returns one quantity of the reconstruction by name, [rows, columns] or [rows, columns, 2]; None if it does not
/// exist.
nb::object density_array(nb::handle_t<Reconstruction> self, std::string const& name) {
  Reconstruction const& all = nb::cast<Reconstruction&>(self);
  auto const rows = static_cast<std::size_t>(all.grid.rows), columns = static_cast<std::size_t>(all.grid.columns);
  auto const plane = [&](auto const& values) {
    return values.empty() ? nb::object(nb::none()) : view_of(values.data(), {rows, columns}, self);
  };
  if (name == "density") return plane(all.density);
  if (name == "sigma") return plane(all.sigma);
  if (name == "sigma_random") return plane(all.sigma_random);
  if (name == "region") return plane(all.region);
  if (name == "reference") return plane(all.reference);
  if (name == "truth") return plane(all.truth);
  if (name == "gradient") return view_of(&all.gradient.front().x, {rows, columns, 2}, self);
  return nb::none();
}

}  // namespace

void bind_density(nb::module_& module) {
  nb::class_<Reconstruction>(module, "Reconstruction", "Density reconstructed from BOS vectors.")
      .def_prop_ro("warnings", [](Reconstruction const& self) { return warning_texts(self.warnings); })
      .def("x_mm", [](Reconstruction const& self) { return axis_mm(self, true); })
      .def("y_mm", [](Reconstruction const& self) { return axis_mm(self, false); })
      .def("array", &density_array, nb::arg("name"))
      .def(
          "save", [](Reconstruction const& self, std::string const& path) { run([&] { write_density(path, self); }); },
          nb::arg("path"))
      .def("summary", [](Reconstruction const& self) { return json_text(summarize_reconstruction(self)); })
      .def("text", [](Reconstruction const& self) { return reconstruction_report(self); });
  module.def("integration_methods", [] { return density::method_names(density::integration_methods()); });
  module.def("abel_methods", [] { return density::method_names(density::abel_methods()); });
  module.def(
      "reconstruct",
      [](std::string const& place, std::string const& vectors, std::optional<std::string> const& conventions,
         std::vector<std::string> const& reference, std::optional<double> reference_density, double reference_sigma,
         double scale_uncertainty, std::string const& method, std::optional<double> overlap,
         std::optional<double> deconvolve, std::optional<std::string> const& axis, std::string const& abel,
         std::optional<double> lambda, std::size_t samples, bool budget, std::string const& device,
         nb::handle progress) {
        return run(
            [&] {
              ReconstructOptions options;
              options.vectors = vectors;
              options.conventions = conventions;
              for (std::string const& text : reference) options.reference.push_back(parse_reference(text));
              options.reference_density = reference_density;
              options.reference_sigma = reference_sigma;
              options.scale_uncertainty = scale_uncertainty;
              options.method = method;
              options.overlap = overlap;
              options.deconvolution_gain = deconvolve;
              if (axis) options.axis = parse_axis(*axis);
              options.abel = abel;
              options.lambda = lambda;
              options.samples = samples;
              options.budget = budget;
              return std::make_shared<Reconstruction>(reconstruct_case(place, options, open_device(device)));
            },
            progress);
      },
      nb::arg("place"), nb::arg("vectors"), nb::arg("conventions").none(), nb::arg("reference"),
      nb::arg("reference_density").none(), nb::arg("reference_sigma"), nb::arg("scale_uncertainty"), nb::arg("method"),
      nb::arg("overlap").none(), nb::arg("deconvolve").none(), nb::arg("axis").none(), nb::arg("abel"),
      nb::arg("lambda_").none(), nb::arg("samples"), nb::arg("budget"), nb::arg("device"), nb::arg("progress").none());
}

}  // namespace gladstone::python
