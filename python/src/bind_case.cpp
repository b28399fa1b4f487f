#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <variant>

#include "python/src/arrays.h"
#include "python/src/call.h"
#include "python/src/case.h"
#include "render/scene/experiment.h"
#include "studies/case/cameras.h"

namespace gladstone::python {
namespace {

using AnyCase = std::variant<std::shared_ptr<PairCase>, std::shared_ptr<PlanesCase>>;

/// Renders every camera of a setup. Cameras that see the same field share it.
std::vector<AnyCase> render_cameras(SetupText const& setup, std::string const& device_name) {
  std::vector<CameraCase> cameras = load_cameras(setup.document());
  Backend const device = open_device(device_name);
  std::vector<AnyCase> rendered;
  std::shared_ptr<PairCase> first;
  for (CameraCase& one : cameras) {
    if (!one.loaded.setup.experiment().correlated) {
      rendered.emplace_back(std::make_shared<PlanesCase>(std::move(one), device));
      continue;
    }
    ReusableParts known;
    if (first) known.medium = &first->prepared().scene.medium;
    auto const pair = std::make_shared<PairCase>(std::move(one), device, known);
    if (!first) first = pair;
    rendered.emplace_back(pair);
  }
  return rendered;
}

nb::list render(SetupText const& setup, std::string const& device, nb::handle progress) {
  nb::list cases;
  for (AnyCase const& one : run([&] { return render_cameras(setup, device); }, progress)) {
    std::visit([&](auto const& held) { cases.append(nb::cast(held)); }, one);
  }
  return cases;
}

nb::dict make_accuracy_dict(PairCase const& self) {
  TruthAccuracy const& accuracy = self.accuracy();
  nb::dict all;
  all["rms_px"] = accuracy.rms_px;
  all["largest_px"] = accuracy.largest_px;
  all["worst"] = accuracy.worst;
  all["above"] = accuracy.above;
  all["unknown"] = accuracy.unknown;
  all["image_error_levels"] = self.image_error_levels();
  return all;
}

std::size_t rows(CaseSetup const& loaded) { return static_cast<std::size_t>(loaded.setup.camera.rows); }
std::size_t columns(CaseSetup const& loaded) { return static_cast<std::size_t>(loaded.setup.camera.columns); }

}  // namespace

void bind_case(nb::module_& module) {
  nb::class_<PairCase>(module, "PairCase", "Image pair of one camera with its truth.")
      .def_static(
          "load", [](std::string const& folder) { return run([&] { return std::make_shared<PairCase>(folder); }); },
          nb::arg("folder"))
      .def_prop_ro("camera", &PairCase::camera)
      .def_prop_ro("folder", &PairCase::folder)
      .def_prop_ro("is_piv", [](PairCase const& self) { return !self.loaded().setup.experiment().sources.on_target; })
      .def("images",
           [](nb::handle_t<PairCase> self) {
             auto& held = nb::cast<PairCase&>(self);
             return view_of(held.images().data(), {2, rows(held.loaded()), columns(held.loaded())}, self);
           })
      .def("accuracy", &make_accuracy_dict)
      .def("summary", [](PairCase& self) { return run([&] { return self.summary(); }); })
      .def("resolved", &PairCase::resolved)
      .def(
          "save", [](PairCase& self, std::string const& folder) { run([&] { self.save(folder); }); },
          nb::arg("folder"));
  nb::class_<PlanesCase>(module, "PlanesCase", "Images of a calibration target in several planes.")
      .def_ro("camera", &PlanesCase::camera)
      .def("images",
           [](nb::handle_t<PlanesCase> self) {
             auto& held = nb::cast<PlanesCase&>(self);
             return view_of(held.images.data(), {held.rendered.planes.size(), rows(held.loaded), columns(held.loaded)},
                            self);
           })
      .def_prop_ro("planes_m", [](PlanesCase const& self) { return self.loaded.setup.planes; })
      .def("resolved", [](PlanesCase const& self) { return self.loaded.document.resolved(); })
      .def(
          "save", [](PlanesCase& self, std::string const& folder) { run([&] { self.save(folder); }); },
          nb::arg("folder"));
  module.def("render", &render, nb::arg("setup"), nb::arg("device"), nb::arg("progress").none(),
             "Renders every camera of a setup: a list of PairCase or PlanesCase.");
}

}  // namespace gladstone::python
