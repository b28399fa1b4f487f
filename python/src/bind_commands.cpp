#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "python/src/arrays.h"
#include "python/src/call.h"
#include "python/src/setup_text.h"
#include "render/base/units.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/backend.h"
#include "studies/case/cameras.h"
#include "studies/case/case.h"
#include "studies/case/json_text.h"
#include "studies/case/plenoptic_views.h"
#include "studies/case/preview.h"
#include "studies/case/render_sequence.h"
#include "studies/case/warning_log.h"
#include "studies/commands/convert.h"
#include "studies/commands/init.h"
#include "studies/commands/keys.h"
#include "studies/commands/target.h"
#include "studies/examples/demo.h"
#include "studies/examples/gallery.h"
#include "studies/oracles/validate.h"

namespace gladstone::python {
namespace {

struct CameraPreview {
  std::string camera;
  CasePreview preview;
};

std::vector<CameraPreview> render_previews(SetupText const& setup, std::string const& device_name) {
  Backend const device = open_device(device_name);
  std::vector<CameraPreview> previews;
  for (auto const& [camera, loaded] : load_cameras(setup.document())) {
    log_warnings(loaded.warnings);
    previews.push_back({camera, render_preview(loaded, *device.renderer)});
  }
  return previews;
}

/// Returns (camera, grey levels [frames, rows, columns], first column, first row, at gradient, sources) of each camera.
nb::list previews_of(SetupText const& setup, std::string const& device, nb::handle progress) {
  nb::list all;
  for (CameraPreview const& one : run([&] { return render_previews(setup, device); }, progress)) {
    CasePreview const& preview = one.preview;
    std::vector<std::uint16_t> levels;
    for (Image<std::uint16_t> const& frame : preview.frames) levels.insert(levels.end(), frame.begin(), frame.end());
    auto const rows = static_cast<std::size_t>(preview.rows), columns = static_cast<std::size_t>(preview.columns);
    all.append(nb::make_tuple(one.camera, array_of(std::move(levels), {preview.frames.size(), rows, columns}),
                              preview.first_column, preview.first_row, preview.at_gradient, preview.sources));
  }
  return all;
}

/// Renders a setup with a table [sequence] into a folder. @return contents of its summary.json
std::string render_sequence(std::string const& setup, std::vector<std::string> const& overrides,
                            std::string const& folder, std::string const& device_name) {
  SequenceRenderer sequence(read_setup_document(setup, overrides), setup);
  sequence.refuse_over_inputs(folder);
  RenderedSequence const rendered = sequence.render(*open_device(device_name).renderer, folder, true);
  log_warnings(rendered.warnings);
  return rendered.summary;
}

/// Measures all oracles. @return (name, source, measured, exact, tolerance, tolerance is relative, passed) of each
nb::list oracles(std::string const& device, nb::handle progress) {
  nb::list rows;
  for (OracleResult const& one : run([&] { return run_oracles(*open_device(device).renderer); }, progress)) {
    rows.append(nb::make_tuple(one.oracle.name, one.oracle.source, one.measured, one.oracle.exact, one.oracle.tolerance,
                               one.oracle.kind == ToleranceKind::relative, one.passed()));
  }
  return rows;
}

/// Converts a file of vectors. @return description as JSON
std::string convert(VectorConversion const& conversion) {
  ConvertedVectors const converted = convert_vectors(conversion);
  if (!converted.complete)
    log_warning(
        {WarningCode::incomplete, conversion.input, "its header declares another number of vectors; export it again"});
  return converted.description.json;
}

void bind_setup_commands(nb::module_& module) {
  module.def("template_kinds", &template_kinds);
  module.def(
      "template_text",
      [](std::string const& kind, bool all) {
        return run([&] { return template_text(kind, all ? TemplateKeys::all : TemplateKeys::important); });
      },
      nb::arg("kind"), nb::arg("all_keys"));
  module.def(
      "write_template",
      [](std::string const& path, std::string const& kind, bool all) {
        return run([&] { return write_template(path, kind, all ? TemplateKeys::all : TemplateKeys::important); });
      },
      nb::arg("path"), nb::arg("kind"), nb::arg("all_keys"));
  module.def(
      "find_keys",
      [](std::string const& pattern) {
        FoundKeys const found = find_keys(pattern);
        return json_text(nlohmann::ordered_json{{"keys", keys_json(found)}, {"similar", found.similar}});
      },
      nb::arg("pattern"));
  module.def(
      "target",
      [](SetupText const& setup, std::string const& path) {
        return run([&] { return write_target(setup.document(), setup.name, path).json; });
      },
      nb::arg("setup"), nb::arg("path"));
  module.def("previews", &previews_of, nb::arg("setup"), nb::arg("device"), nb::arg("progress").none());
}

}  // namespace

void bind_commands(nb::module_& module) {
  bind_setup_commands(module);
  module.def(
      "render_sequence",
      [](std::string const& setup, std::vector<std::string> const& overrides, std::string const& folder,
         std::string const& device, nb::handle progress) {
        return run([&] { return render_sequence(setup, overrides, folder, device); }, progress);
      },
      nb::arg("setup"), nb::arg("overrides"), nb::arg("folder"), nb::arg("device"), nb::arg("progress").none());
  module.def("oracles", &oracles, nb::arg("device"), nb::arg("progress").none());
  module.def(
      "convert",
      [](std::string const& input, std::string const& output, std::string const& conventions, int image_rows,
         int spacing_px, bool at_frame_a, bool exact, std::string const& device, nb::handle progress) {
        TruthAt const at = at_frame_a ? TruthAt::reference : TruthAt::mid_position;
        TracedPixels const traced = exact ? TracedPixels::all : TracedPixels::adaptive;
        return run(
            [&] {
              return convert({input, output, conventions, image_rows, spacing_px, at, traced, device});
            },
            progress);
      },
      nb::arg("input"), nb::arg("output"), nb::arg("conventions"), nb::arg("image_rows"), nb::arg("spacing_px"),
      nb::arg("at_frame_a"), nb::arg("exact"), nb::arg("device"), nb::arg("progress").none());
  module.def(
      "views",
      [](std::string const& case_folder, std::string const& folder, int across, std::optional<double> refocus_mm) {
        std::optional<double> z;
        if (refocus_mm) z = *refocus_mm * unit::millimetre;
        return run([&] { return write_views(case_folder, folder, across, z).json; });
      },
      nb::arg("case_folder"), nb::arg("folder"), nb::arg("across"), nb::arg("refocus_mm").none());
  module.def(
      "demo",
      [](std::string const& folder, std::string const& device, nb::handle progress) {
        return run([&] { return run_demo(folder, open_device(device)); }, progress);
      },
      nb::arg("folder"), nb::arg("device"), nb::arg("progress").none());
  module.def(
      "gallery",
      [](std::string const& folder, std::string const& device, nb::handle progress) {
        return run([&] { return run_gallery(folder, open_device(device)); }, progress);
      },
      nb::arg("folder"), nb::arg("device"), nb::arg("progress").none());
}

}  // namespace gladstone::python
