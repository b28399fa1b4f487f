#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>

#include "analysis/correlation/pair_assessment.h"
#include "analysis/vectors/vector_file.h"
#include "analysis/vectors/vector_writers/vector_columns.h"
#include "python/src/arrays.h"
#include "python/src/call.h"
#include "python/src/field.h"
#include "python/src/warnings.h"
#include "render/base/error.h"
#include "render/files/hdf5_file.h"
#include "render/files/source_files.h"
#include "studies/case/correlation_setup.h"
#include "studies/case/peak_locking.h"
#include "studies/compare/compared_vectors.h"
#include "studies/compare/correlate.h"

namespace gladstone::python {
namespace {

using Field = std::shared_ptr<MeasuredField>;

/// Returns the field of a measurement with these settings.
Field make_field(Measurement measured, CorrelationFile const& given) {
  auto field = std::make_shared<MeasuredField>();
  field->field = std::move(measured.field);
  field->foreign = false;
  field->settings = given.settings;
  field->resolved = given.resolved;
  field->device = measured.device;
  field->seconds = measured.seconds;
  return field;
}

Field correlate(ImageArray const& a, ImageArray const& b, std::vector<std::string> const& overrides,
                std::string const& device_name, nb::handle progress) {
  return run(
      [&] {
        ImageSamples const samples_a = image_samples(a, "a"), samples_b = image_samples(b, "b");
        HostFrames const frames(read_samples(samples_a), read_samples(samples_b));
        CorrelationFile const given = default_correlation(overrides);
        Measurement measured = correlate_frames("a", "b", frames, given.settings, open_device(device_name));
        if (auto const advice = locking_advice(frames.reference()); advice && frames_correlate(measured.field))
          measured.field.warnings.push_back(*advice);
        Field field = make_field(std::move(measured), given);
        field->reference_sha256 = pixel_sha256(frames.reference(), samples_a.bits);
        field->flow_sha256 = pixel_sha256(frames.flow(), samples_b.bits);
        return field;
      },
      progress);
}

/// Correlates images in the memory of the first GPU. Without a copy in host memory, the frames have no hashes, and the
/// size of their dots is not examined.
Field correlate_gpu_images(GpuImageArray const& a, GpuImageArray const& b, std::vector<std::string> const& overrides,
                           std::string const& device_name, nb::handle progress) {
  return run(
      [&] {
        CorrelationFile const given = default_correlation(overrides);
        return make_field(correlate_gpu_arrays("a", image_samples(a, "a"), "b", image_samples(b, "b"), given.settings,
                                               open_device(device_name)),
                          given);
      },
      progress);
}

/// Measures the displacement field common to many pairs. @param files  frames A and B of each pair in turn
Field correlate_ensemble(std::vector<std::string> const& files, std::vector<std::string> const& overrides) {
  CorrelationFile const given = default_correlation(overrides);
  SourceFiles sources;
  return make_field(correlate_ensemble_files(files, given.settings, sources), given);
}

/// Reads a file of vectors and converts it to our conventions.
/// @param conventions  as read by parse_conventions(); empty: those of the format
/// @param image_rows   number of rows of the image, for conventions with "y-up-image"
Field load_field(std::string const& path, std::string const& conventions, int image_rows) {
  VectorFile file = read_vectors(path);
  log_remarks(file);
  if (!conventions.empty()) override_conventions(file, conventions);
  file = convert_to_pixels(std::move(file), path);
  if (file.conventions.y_up && file.conventions.mirror == VectorConventions::Mirror::image && image_rows <= 0) {
    throw DataError(ErrorCode::undetermined, path,
                    "counts y upwards from the image's lower edge; give image_rows, its number of rows");
  }
  auto field = std::make_shared<MeasuredField>();
  field->name = path;
  field->foreign = file.foreign;
  field->complete = file.complete;
  field->field = apply_conventions(std::move(file.field), file.conventions, image_rows);
  if (file.foreign || !has_hdf5_ending(path)) return field;
  Hdf5Reader const measured(path);
  field->resolved = measured.attribute("setup");
  field->device = measured.attribute("device");
  field->field.warnings = read_warnings(measured);
  field->reference_sha256 = measured.attribute("reference_sha256");
  field->flow_sha256 = measured.attribute("flow_sha256");
  if (field->resolved.empty()) return field;
  SetupDocument document = SetupDocument::from_text(field->resolved, path);
  field->settings = read_correlation_settings(document.root().table("correlate"));
  return field;
}

std::vector<Vec2d> pairs(NumberArray const& x, NumberArray const& y) {
  std::vector<Vec2d> both(x.shape(0));
  for (std::size_t i = 0; i < both.size(); ++i) both[i] = {x.data()[i], y.data()[i]};
  return both;
}

/// Makes a field of arrays of equal length; a complete lattice is sorted row by row.
Field field_of_arrays(NumberArray const& x, NumberArray const& y, NumberArray const& u, NumberArray const& v,
                      std::optional<NumberArray> const& sigma_u, std::optional<NumberArray> const& sigma_v) {
  std::size_t const count = x.shape(0);
  auto const check = [count](NumberArray const& array, char const* name) {
    if (array.shape(0) == count) return;
    throw DataError(
        ErrorCode::wrong_shape, "field",
        fmt::format("{} has {} values, but x has {}; give one value for each vector", name, array.shape(0), count));
  };
  check(y, "y");
  check(u, "u");
  check(v, "v");
  auto made = std::make_shared<MeasuredField>();
  DisplacementField& field = made->field;
  field.position_px = pairs(x, y);
  field.displacement_px = pairs(u, v);
  if (sigma_u && sigma_v) {
    check(*sigma_u, "sigma_u");
    check(*sigma_v, "sigma_v");
    field.sigma_px = pairs(*sigma_u, *sigma_v);
  }
  for (Vec2d const& d : field.displacement_px) {
    bool const known = std::isfinite(d.x) && std::isfinite(d.y);
    field.status.push_back(known ? VectorStatus::valid : VectorStatus::invalid);
  }
  arrange_as_grid(field);
  return made;
}

void save(MeasuredField const& self, std::string const& path) {
  SourceFiles sources;
  if (!self.reference_sha256.empty()) {
    sources.add_known("reference", self.reference_sha256);
    sources.add_known("flow", self.flow_sha256);
  }
  if (!has_vector_extension(path)) {
    throw OutputError(
        path, fmt::format("must end in one of {}, which selects the format", fmt::join(vector_extensions(), ", ")));
  }
  write_vectors(path, self.field, {"gladstone vectors", 1, self.resolved, 0, self.device, std::move(sources)});
}

/// Returns one array of the vectors by name, of length `size`; None if it was not measured.
nb::object field_array(nb::handle_t<MeasuredField> self, std::string const& name) {
  DisplacementField const& field = nb::cast<MeasuredField&>(self).field;
  if (name == "position") return view_of(field.position_px, self);
  if (name == "displacement") return view_of(field.displacement_px, self);
  if (name == "sigma") return view_of(field.sigma_px, self);
  if (name == "peak_ratio") return view_of(field.peak_ratio, self);
  if (name == "correlation") return view_of(field.correlation, self);
  if (name == "status" && !field.status.empty()) {
    std::vector<std::uint8_t> codes;
    for (VectorStatus const status : field.status) codes.push_back(static_cast<std::uint8_t>(status));
    std::size_t const count = codes.size();
    return array_of(std::move(codes), {count});
  }
  return nb::none();
}

/// Returns one column of the files of vectors by name, "u_raw_px", of length `size`.
nb::object field_column(MeasuredField const& self, std::string const& name) {
  std::vector<double> values = column_named(vector_columns(self.field), name).values;
  std::size_t const count = values.size();
  return array_of(std::move(values), {count});
}

}  // namespace

void bind_field(nb::module_& module) {
  nb::class_<MeasuredField>(module, "MeasuredField",
                            "Displacement vectors, with the settings, device and duration of their measurement.")
      .def_prop_ro("size", [](MeasuredField const& self) { return self.field.size(); })
      .def_prop_ro("columns", [](MeasuredField const& self) { return self.field.columns; })
      .def_prop_ro("rows", [](MeasuredField const& self) { return self.field.rows; })
      .def_prop_ro("warnings", [](MeasuredField const& self) { return warning_texts(self.field.warnings); })
      .def_prop_ro("verdict", [](MeasuredField const& self) { return verdict_text(self.field.verdict); })
      .def_prop_ro("verdict_code",
                   [](MeasuredField const& self) { return std::string(verdict_code(self.field.verdict.kind)); })
      .def_prop_ro("verdict_number", [](MeasuredField const& self) { return self.field.verdict.number; })
      .def_prop_ro("uncertainty_method", [](MeasuredField const& self) { return self.field.uncertainty_method; })
      .def_prop_ro("uncertainty_key", [](MeasuredField const& self) { return self.field.uncertainty_key; })
      .def_rw("name", &MeasuredField::name)
      .def_ro("settings", &MeasuredField::resolved)
      .def_ro("device", &MeasuredField::device)
      .def_rw("seconds", &MeasuredField::seconds)
      .def_rw("foreign", &MeasuredField::foreign)
      .def("array", &field_array, nb::arg("name"))
      .def("column", &field_column, nb::arg("name"))
      .def(
          "save", [](MeasuredField const& self, std::string const& path) { run([&] { save(self, path); }); },
          nb::arg("path"));
  module.def("gpu_is_usable", &gpu_is_usable, "Whether images in the memory of the first GPU can be correlated there.");
  module.def("correlate", &correlate, nb::arg("a"), nb::arg("b"), nb::arg("overrides"), nb::arg("device"),
             nb::arg("progress").none());
  module.def("correlate_gpu_images", &correlate_gpu_images, nb::arg("a"), nb::arg("b"), nb::arg("overrides"),
             nb::arg("device"), nb::arg("progress").none());
  module.def(
      "correlate_ensemble",
      [](std::vector<std::string> const& files, std::vector<std::string> const& overrides, nb::handle progress) {
        return run([&] { return correlate_ensemble(files, overrides); }, progress);
      },
      nb::arg("files"), nb::arg("overrides"), nb::arg("progress").none());
  module.def(
      "load_field",
      [](std::string const& path, std::string const& conventions, int image_rows) {
        return run([&] { return load_field(path, conventions, image_rows); });
      },
      nb::arg("path"), nb::arg("conventions"), nb::arg("image_rows"));
  module.def("field_of_arrays", &field_of_arrays, nb::arg("x"), nb::arg("y"), nb::arg("u"), nb::arg("v"),
             nb::arg("sigma_u").none(), nb::arg("sigma_v").none());
}

}  // namespace gladstone::python
