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
#include "render/base/error.h"
#include "render/base/units.h"
#include "studies/case/backend.h"
#include "studies/case/json_text.h"
#include "studies/commands/density_options.h"
#include "studies/commands/volume_options.h"
#include "studies/compare/tomography.h"
#include "studies/compare/tomography_file.h"
#include "studies/compare/tomography_plan.h"

namespace gladstone::python {
namespace {

using PointArray = nb::ndarray<double const, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

/// Returns the positions of the volume's nodes along an axis (0: X, 1: Y, 2: Z) [mm].
nb::object volume_axis_mm(Tomography const& self, int axis) {
  std::vector<double> mm;
  for (int i = 0; i < self.grid.nodes[static_cast<std::size_t>(axis)]; ++i)
    mm.push_back((self.grid.origin[axis] + i * self.grid.spacing[axis]) / unit::mm);
  std::size_t const count = mm.size();
  return array_of(std::move(mm), {count});
}

/// Returns one field of the volume by name, [z, y, x]; None if it does not exist.
nb::object volume_array(nb::handle_t<Tomography> self, std::string const& name) {
  Tomography const& all = nb::cast<Tomography&>(self);
  auto const& nodes = all.grid.nodes;
  auto const volume = [&](auto const& values) {
    return values.empty() ? nb::object(nb::none())
                          : view_of(values.data(),
                                    {static_cast<std::size_t>(nodes[2]), static_cast<std::size_t>(nodes[1]),
                                     static_cast<std::size_t>(nodes[0])},
                                    self);
  };
  if (name == "density") return volume(all.density);
  if (name == "truth") return volume(all.truth);
  if (name == "views") return volume(all.seen);
  return nb::none();
}

tomography::SartSettings sart_settings(int iterations, double tolerance, double relaxation,
                                       std::optional<double> tv_weight) {
  tomography::SartSettings settings;
  settings.iterations = iterations;
  settings.tolerance = tolerance;
  settings.relaxation = relaxation;
  settings.tv_weight = tv_weight;
  return settings;
}

/// Converts arrays of parallel lines to views.
/// @param view  index of the view of each line, ascending from 0
std::vector<tomography::ProjectedView> split_lines(PointArray const& origin_mm, PointArray const& direction,
                                                   NumberArray const& value, NumberArray const& view) {
  std::size_t const count = value.shape(0);
  if (origin_mm.shape(0) != count || direction.shape(0) != count || view.shape(0) != count || origin_mm.shape(1) != 3 ||
      direction.shape(1) != 3)
    throw DataError(ErrorCode::wrong_shape, "lines", "origin and direction must be [lines, 3], value and view [lines]");
  std::vector<tomography::ProjectedView> views;
  for (std::size_t i = 0; i < count; ++i) {
    double const index = view.data()[i];
    if (views.empty() || (index == static_cast<double>(views.size()))) {
      views.emplace_back();
      views.back().name = "view " + std::to_string(views.size() - 1);
    }
    if (index != static_cast<double>(views.size() - 1))
      throw DataError(ErrorCode::invalid_value, "lines", "the indices of the views must ascend from 0 in steps of 1");
    tomography::SightLine line;
    double const *o = origin_mm.data() + 3 * i, *d = direction.data() + 3 * i;
    line.origin = unit::mm * Vec3d{o[0], o[1], o[2]};
    line.direction = normalized(Vec3d{d[0], d[1], d[2]});
    views.back().lines.push_back(line);
    views.back().value.push_back(value.data()[i]);
  }
  return views;
}

}  // namespace

void bind_tomography(nb::module_& module) {
  nb::class_<Tomography>(module, "Tomography", "Density of a volume, reconstructed from several views.")
      .def_prop_ro("warnings", [](Tomography const& self) { return warning_texts(self.warnings); })
      .def("axis_mm", &volume_axis_mm, nb::arg("axis"))
      .def("array", &volume_array, nb::arg("name"))
      .def(
          "save", [](Tomography const& self, std::string const& path) { run([&] { write_tomography(path, self); }); },
          nb::arg("path"))
      .def("summary", [](Tomography const& self) { return json_text(summarize_tomography(self)); })
      .def("text", [](Tomography const& self) { return tomography_report(self); });
  module.def(
      "tomography",
      [](std::vector<std::string> const& cases, std::vector<std::string> const& vectors,
         std::optional<std::string> const& conventions, bool ray_truth, std::vector<double> const& angles_deg,
         double arc_deg, std::vector<std::string> const& reference, std::optional<double> reference_density,
         std::vector<double> const& bounds_mm, std::optional<double> spacing_mm,
         std::optional<std::string> const& support, double least_density, std::optional<double> largest_density,
         int iterations, double tolerance, double relaxation, std::optional<double> tv_weight,
         std::string const& device, nb::handle progress) {
        return run(
            [&] {
              TomographyOptions options;
              options.views = cases;
              options.vectors = vectors;
              options.conventions = conventions;
              options.ray_truth = ray_truth;
              for (double const angle : angles_deg) options.angles.push_back(angle * unit::degree);
              options.arc = arc_deg * unit::degree;
              for (std::string const& text : reference) options.reference.push_back(parse_reference(text));
              options.reference_density = reference_density;
              if (bounds_mm.size() == 6)
                options.bounds = {unit::mm * Vec3d{bounds_mm[0], bounds_mm[1], bounds_mm[2]},
                                  unit::mm * Vec3d{bounds_mm[3], bounds_mm[4], bounds_mm[5]}};
              if (spacing_mm) options.spacing = *spacing_mm * unit::mm;
              if (support) options.support = parse_support(*support);
              options.least_density = least_density;
              if (largest_density) options.largest_density = *largest_density;
              options.sart = sart_settings(iterations, tolerance, relaxation, tv_weight);
              return std::make_shared<Tomography>(reconstruct_views(options, open_volume_device(device)));
            },
            progress);
      },
      nb::arg("cases"), nb::arg("vectors"), nb::arg("conventions").none(), nb::arg("ray_truth"), nb::arg("angles_deg"),
      nb::arg("arc_deg"), nb::arg("reference"), nb::arg("reference_density").none(), nb::arg("bounds_mm"),
      nb::arg("spacing_mm").none(), nb::arg("support").none(), nb::arg("least_density"),
      nb::arg("largest_density").none(), nb::arg("iterations"), nb::arg("tolerance"), nb::arg("relaxation"),
      nb::arg("tv_weight").none(), nb::arg("device"), nb::arg("progress").none());
  module.def(
      "tomography_setups",
      [](std::string const& setup, int views, double arc_deg, std::string const& folder) {
        return run([&] { return write_tomography_setups({setup, views, arc_deg * unit::degree}, folder); });
      },
      nb::arg("setup"), nb::arg("views"), nb::arg("arc_deg"), nb::arg("folder"));
  module.def(
      "reconstruct_lines",
      [](PointArray const& origin_mm, PointArray const& direction, NumberArray const& value, NumberArray const& view,
         std::array<int, 3> const& nodes, double spacing_mm, std::array<double, 3> const& center_mm, double lowest,
         double highest, int iterations, double tolerance, double relaxation, std::optional<double> tv_weight,
         std::string const& device, nb::handle progress) {
        std::vector<tomography::ProjectedView> const views = split_lines(origin_mm, direction, value, view);
        RegularGrid grid;
        grid.nodes = nodes;
        double const spacing = spacing_mm * unit::mm;
        grid.spacing = {spacing, spacing, spacing};
        for (int axis = 0; axis < 3; ++axis) {
          auto const a = static_cast<std::size_t>(axis);
          grid.origin[axis] = center_mm[a] * unit::mm - 0.5 * (nodes[a] - 1) * spacing;
        }
        std::vector<double> volume = run(
            [&] {
              tomography::SartSettings settings = sart_settings(iterations, tolerance, relaxation, tv_weight);
              settings.lowest = lowest;
              settings.highest = highest;
              return reconstruct_volume(views, grid, settings, open_volume_device(device)).value;
            },
            progress);
        return array_of(std::move(volume), {static_cast<std::size_t>(nodes[2]), static_cast<std::size_t>(nodes[1]),
                                            static_cast<std::size_t>(nodes[0])});
      },
      nb::arg("origin_mm"), nb::arg("direction"), nb::arg("value"), nb::arg("view"), nb::arg("nodes"),
      nb::arg("spacing_mm"), nb::arg("center_mm"), nb::arg("lowest"), nb::arg("highest"), nb::arg("iterations"),
      nb::arg("tolerance"), nb::arg("relaxation"), nb::arg("tv_weight").none(), nb::arg("device"),
      nb::arg("progress").none());
}

}  // namespace gladstone::python
