#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <complex>

#include "python/src/arrays.h"
#include "python/src/call.h"
#include "python/src/setup_text.h"
#include "render/base/error.h"
#include "render/base/units.h"
#include "render/light/mie.h"
#include "render/planning.h"
#include "studies/case/case.h"
#include "studies/case/ray_file.h"
#include "studies/case/warning_log.h"
#include "studies/commands/figure_ending.h"
#include "studies/commands/info_field.h"
#include "studies/commands/info_image.h"
#include "studies/commands/info_lens.h"
#include "studies/commands/info_mie.h"
#include "studies/commands/info_particles.h"
#include "studies/commands/info_setup.h"

namespace gladstone::python {
namespace {

/// Computes S1 and S2 at scattering angles [rad]. @return [count, 2], complex
nb::object mie_amplitudes(double x, std::complex<double> m, NumberArray const& angles) {
  bool const valid = x >= least_size_parameter && x <= largest_size_parameter && m.real() > 0 && m.imag() >= 0;
  if (!valid)
    throw DataError(ErrorCode::out_of_range, "mie",
                    "x must be from 1e-6 to 1e5, and m = n + i k with n > 0 and k >= 0");
  std::size_t const count = angles.shape(0);
  std::vector<MieAmplitudes> amplitudes(count);
  MieCoefficients(x, m).amplitudes(angles.data(), count, amplitudes.data());
  std::vector<std::complex<double>> both;
  for (MieAmplitudes const& one : amplitudes) both.insert(both.end(), {one.s1, one.s2});
  return array_of(std::move(both), {count, 2});
}

/// Traces rays given as six columns: start [mm] and direction.
std::vector<TracedRay> trace(SetupText const& setup, std::vector<double> const& rows, Through through) {
  CaseSetup loaded = load_case_setup(setup.document());
  std::vector<Ray<double>> const rays = rays_of(rows, "rays", loaded.setup.max_off_axis_distance());
  log_warnings(loaded.warnings);
  Scene const scene = build_scene(loaded.setup);
  log_warnings(scene.medium.warnings);
  return trace_rays(scene, plan_step(scene).step, rays, through);
}

nb::tuple traced_rays(SetupText const& setup, NumberArray const& numbers, std::string const& through) {
  std::vector<double> const rows(numbers.data(), numbers.data() + numbers.shape(0));
  Through const end = through == "medium" ? Through::medium : through == "optics" ? Through::optics : Through::all;
  std::vector<TracedRay> const traced = run([&] { return trace(setup, rows, end); });
  nb::list status;
  std::vector<double> values;  // position [mm], direction, optical path length [mm], column and row [px]
  for (TracedRay const& ray : traced) {
    status.append(nb::str(to_string(ray.status)));
    Vec3d const p = ray.position / unit::millimetre;
    values.insert(values.end(), {p.x, p.y, p.z, ray.direction.x, ray.direction.y, ray.direction.z,
                                 ray.optical_path / unit::millimetre, ray.pixel.x, ray.pixel.y});
  }
  return nb::make_tuple(status, array_of(std::move(values), {traced.size(), 9}));
}

}  // namespace

void bind_information(nb::module_& module) {
  module.def(
      "info_lens",
      [](std::string const& file, std::vector<std::string> const& glasses, double wavelength_nm,
         std::string const& figure) {
        return run([&] {
          check_figure_ending(figure);
          return describe_lens({file, glasses, wavelength_nm, figure}).json;
        });
      },
      nb::arg("file"), nb::arg("glasses"), nb::arg("wavelength_nm"), nb::arg("figure"));
  module.def(
      "info_field",
      [](std::string const& file, std::string const& dataset, std::string const& axes, std::string const& setup,
         std::string const& figure) {
        return run([&] {
          check_figure_ending(figure);
          return describe_field(file, dataset, axes, setup, figure).json;
        });
      },
      nb::arg("file"), nb::arg("dataset"), nb::arg("axes"), nb::arg("setup"), nb::arg("figure"));
  module.def(
      "info_image_file", [](std::string const& file) { return run([&] { return describe_image(file).json; }); },
      nb::arg("file"));
  module.def(
      "info_image",
      [](ImageArray const& array, int bit_depth) {
        return run([&] {
          ImageSamples const samples = image_samples(array, "image");
          ImageMetadata metadata;
          metadata.bit_depth = bit_depth > 0 ? bit_depth : samples.bits;
          return describe_image("image", read_samples(samples), metadata).json;
        });
      },
      nb::arg("image"), nb::arg("bit_depth"));
  module.def(
      "info_particles",
      [](SetupText const& setup) { return run([&] { return describe_particles(setup.document(), setup.name).json; }); },
      nb::arg("setup"));
  module.def(
      "info_setup",
      [](SetupText const& setup, std::string const& figure) {
        return run([&] {
          check_figure_ending(figure);
          return describe_setup(setup.document(), setup.name, figure).json;
        });
      },
      nb::arg("setup"), nb::arg("figure"));
  module.def(
      "info_mie",
      [](double x, double m_real, double m_imag, std::string const& figure) {
        return run([&] {
          check_figure_ending(figure);
          return describe_mie({x, {m_real, m_imag}, figure}).json;
        });
      },
      nb::arg("x"), nb::arg("m_real"), nb::arg("m_imag"), nb::arg("figure"));
  module.def(
      "mie_amplitudes",
      [](double x, double m_real, double m_imag, NumberArray const& angles) {
        return mie_amplitudes(x, {m_real, m_imag}, angles);
      },
      nb::arg("x"), nb::arg("m_real"), nb::arg("m_imag"), nb::arg("angles"));
  module.def("trace", &traced_rays, nb::arg("setup"), nb::arg("rays"), nb::arg("through"));
}

}  // namespace gladstone::python
