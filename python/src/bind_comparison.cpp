#include <fmt/format.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "python/src/arrays.h"
#include "python/src/call.h"
#include "python/src/case.h"
#include "python/src/field.h"
#include "python/src/warnings.h"
#include "render/base/error.h"
#include "studies/case/warning_log.h"
#include "studies/case/write_case.h"
#include "studies/compare/compare.h"
#include "studies/compare/compared_vectors.h"
#include "studies/compare/comparison_results.h"
#include "studies/compare/comparison_warnings.h"
#include "studies/figures/comparison_figures.h"
#include "studies/report/report.h"

namespace gladstone::python {
namespace {

/// Returns whether gladstone is known to have measured the vectors on exactly the frames of the case.
/// @throws DataError if the frames were exchanged
bool is_own(PairCase const& one, MeasuredField const& field) {
  if (field.foreign || !field.settings) return false;
  bool const named = !field.reference_sha256.empty();
  if (named && field.reference_sha256 == one.reference_sha256() && field.flow_sha256 == one.flow_sha256()) return true;
  if (named && field.reference_sha256 == one.flow_sha256() && field.flow_sha256 == one.reference_sha256()) {
    throw DataError(ErrorCode::inconsistent, field.name,
                    "was measured from the case's frame b to its frame a, so that every displacement has "
                    "the opposite sign; correlate case.a with case.b");
  }
  log_warning({WarningCode::inconsistent, field.name,
               fmt::format("the vectors {} measured on the frames of this case as they were rendered; the error of the "
                           "estimator includes that of noise",
                           named ? "were not" : "may not have been")});
  return false;
}

MeasuredVectors vectors_of(PairCase const& one, MeasuredField const& field, CompareOptions const& options) {
  bool const own = is_own(one, field);
  VectorFile file;
  file.field = field.field;
  file.format = "given";
  file.foreign = !own;
  file.complete = field.complete;
  MeasuredVectors vectors = accept_vectors(std::move(file), field.name, one.loaded(), &one.truth(), options,
                                           own || !field.foreign ? ConventionCheck::none : ConventionCheck::warn);
  if (field.settings) vectors.settings = *field.settings;
  return vectors;
}

Comparison compare(PairCase& one, MeasuredField const& field, bool at_reference, std::string const& device_name) {
  CompareOptions options;
  if (at_reference) options.truth_at = TruthAt::reference;
  Backend const device = open_device(device_name);
  MeasuredVectors vectors = vectors_of(one, field, options);
  PreparedCase const& prepared = one.prepared();
  RenderedCase const* const rendered = vectors.foreign ? nullptr : &one.rendered(device);
  PointTruth point = truth_of_vectors(prepared, *device.renderer, vectors.field.position_px, options.truth_at);
  Comparison comparison =
      compare_vectors(prepared, one.truth(), rendered, std::move(vectors), std::move(point), device, options.truth_at);
  comparison.warnings = comparison_warnings(comparison, one.loaded().setup);
  for (Warning const& warning : comparison.warnings) {
    bool const told = std::find(prepared.warnings.begin(), prepared.warnings.end(), warning) != prepared.warnings.end();
    if (!told) log_warning(warning);
  }
  return comparison;
}

/// Returns one array of the comparison by name, a row for each vector; None if it does not exist.
nb::object comparison_array(nb::handle_t<Comparison> self, std::string const& name) {
  Comparison const& all = nb::cast<Comparison&>(self);
  if (name == "position_px") return view_of(all.measured.position_px, self);
  if (name == "measured_px") return view_of(all.measured.displacement_px, self);
  if (name == "truth_px") return view_of(all.point.displacement_px, self);
  if (name == "eq9_px") return view_of(all.point.eq9_px, self);
  if (name == "eq9_cone_px") return view_of(all.point.eq9_cone_px, self);
  if (name == "flow_px") return view_of(all.flow_px, self);
  if (name == "window_truth_px") return view_of(all.recorded().displacement_px, self);
  if (name == "mask") {
    std::vector<std::uint8_t> mask;
    for (auto const counts : all.mask) mask.push_back(counts != 0 ? 1 : 0);
    std::size_t const count = mask.size();
    return array_of(std::move(mask), {count});
  }
  return nb::none();
}

/// Writes the report of a study, a case or a measurement. @return the findings, one per line
std::string report(ReportOptions const& options, std::string const& device) {
  WrittenReport const written = write_report(options, open_device(device));
  for (std::string const& file : written.doubtful) {
    log_warning(
        {WarningCode::unreliable, file,
         "the vectors of this file are incomplete, or their axes and signs were probably misread, so that the report "
         "is doubtful (reasons above); export them again, or state their axes and signs with conventions"});
  }
  return written.findings;
}

}  // namespace

void bind_comparison(nb::module_& module) {
  nb::class_<Comparison>(module, "Comparison", "Vectors compared with truth and theory.")
      .def_prop_ro("columns", [](Comparison const& self) { return self.measured.columns; })
      .def_prop_ro("rows", [](Comparison const& self) { return self.measured.rows; })
      .def_prop_ro("warnings", [](Comparison const& self) { return warning_texts(self.warnings); })
      .def("array", &comparison_array, nb::arg("name"))
      .def("errors", [](Comparison const& self) { return run([&] { return errors_json(self); }); })
      .def("text", [](Comparison const& self) { return run([&] { return error_report(self); }); })
      .def(
          "draw",
          [](Comparison const& self, std::string const& folder, std::string const& format) {
            return run([&] { return draw_comparison(folder, self, format); });
          },
          nb::arg("folder"), nb::arg("format"));
  module.def(
      "compare",
      [](PairCase& one, MeasuredField const& field, bool at_reference, std::string const& device, nb::handle progress) {
        return run([&] { return compare(one, field, at_reference, device); }, progress);
      },
      nb::arg("case"), nb::arg("field"), nb::arg("at_reference"), nb::arg("device"), nb::arg("progress").none());
  module.def(
      "report",
      [](std::string const& folder, std::string const& output, std::string const& vectors,
         std::vector<std::string> const& repeats, std::string const& conventions, std::string const& figures,
         std::string const& figure_format, std::string const& device, nb::handle progress) {
        ReportOptions options;
        options.source = folder;
        options.output = output;
        options.markdown = output.ends_with(".md");
        options.vectors = vectors;
        options.repeats = repeats;
        options.conventions = conventions;
        options.figures = figures;
        options.figure_format = figure_format;
        return run([&] { return report(options, device); }, progress);
      },
      nb::arg("folder"), nb::arg("output"), nb::arg("vectors"), nb::arg("repeats"), nb::arg("conventions"),
      nb::arg("figures"), nb::arg("figure_format"), nb::arg("device"), nb::arg("progress").none());
}

}  // namespace gladstone::python
