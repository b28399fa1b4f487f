#include <nanobind/stl/string.h>

#include <map>

#include "python/src/arrays.h"
#include "python/src/call.h"
#include "python/src/case.h"
#include "studies/compare/displacement_truth.h"

namespace gladstone::python {
namespace {

/// Returns one array of a case's truth by name; None if the experiment does not have it.
nb::object truth_array(nb::handle_t<PairCase> self, std::string const& name) {
  GroundTruth const& truth = nb::cast<PairCase&>(self).truth();
  std::map<std::string, std::vector<Vec2d> const*> const pairs{
      {"reference_px", &truth.reference_px},
      {"displacement_px", &truth.displacement_px},
      {"displacement_error_px", &truth.displacement_error_px},
      {"displacement_std_px", &truth.displacement_std_px},
      {"flux", &truth.flux},
      {"eq9_px", &truth.eq9_px},
      {"eq9_cone_px", &truth.eq9_cone_px},
      {"displacement_ambient_px", &truth.particles.displacement_ambient_px}};
  if (auto const found = pairs.find(name); found != pairs.end()) return view_of(*found->second, self);
  if (name == "position_m") return view_of(truth.position_m, self);
  if (name == "second_m") return view_of(truth.particles.second_m, self);
  if (name == "diameter_m") return view_of(truth.particles.diameter_m, self);
  if (name == "rays_planned") return view_of(truth.rays_planned, self);
  if (name == "rays" && !truth.rays.empty()) return view_of(truth.rays.front().data(), {truth.rays.size(), 2}, self);
  return nb::none();
}

/// Computes the displacement at the pixels. @return [rows, columns, 2], in px
nb::object flow(PairCase& self, bool at_frame_a, int spacing_px, bool exact, std::string const& device_name,
                nb::handle progress) {
  Image<Vec2d> const map = run(
      [&] {
        Backend const device = open_device(device_name);
        return displacement_truth(self.prepared().scene, self.prepared().plan, *device.renderer,
                                  at_frame_a ? TruthAt::reference : TruthAt::mid_position, spacing_px,
                                  exact ? TracedPixels::all : TracedPixels::adaptive);
      },
      progress);
  std::vector<double> numbers;
  numbers.reserve(2 * map.size());
  for (Vec2d const& displacement : map) numbers.insert(numbers.end(), {displacement.x, displacement.y});
  return array_of(std::move(numbers),
                  {static_cast<std::size_t>(map.rows()), static_cast<std::size_t>(map.columns()), 2});
}

}  // namespace

void bind_truth(nb::module_& module) {
  module.def("truth_array", &truth_array, nb::arg("case"), nb::arg("name"));
  module.def("flow", &flow, nb::arg("case"), nb::arg("at_frame_a"), nb::arg("spacing_px"), nb::arg("exact"),
             nb::arg("device"), nb::arg("progress").none());
}

}  // namespace gladstone::python
