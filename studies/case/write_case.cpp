#include "studies/case/write_case.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/accuracy.h"
#include "render/base/parallel.h"
#include "render/base/text.h"
#include "render/files/image_file.h"
#include "render/files/output_file.h"
#include "render/files/output_folder.h"
#include "render/files/stop_point.h"
#include "render/method.h"
#include "render/render.h"
#include "render/scene/light_through_lens.h"
#include "render/sensor/detector.h"
#include "studies/case/case_kind.h"
#include "studies/case/case_summary.h"
#include "studies/case/case_warnings.h"
#include "studies/case/json_text.h"
#include "studies/case/render_cost.h"

namespace gladstone::inline cases {

void hash_inputs(CaseSetup& loaded) {
  std::vector<std::string> const files = loaded.document.file_names();
  std::vector<std::vector<std::string>> const keys = loaded.document.file_keys();
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (keys[i].front() != "correlate") loaded.input_hashes[files[i]] = byte_sha256(files[i]);
  }
}

std::string rendering_announcement(Scene const& scene, RenderPlan const& plan, double expected_s) {
  constexpr double least_announced_s = 20;
  if (!(expected_s > least_announced_s)) return {};
  return fmt::format(
      "rendering {0} {1} will take {4} {2:.0f} s on {3}; fewer {1}, a smaller render.rays_per_dot or a larger "
      "medium.step_mm takes less time",
      scene.source_count(), scene.setup.experiment().sources.many, expected_s,
      count_text(static_cast<std::size_t>(thread_count()), "thread"),
      plan.adaptive_criteria && !case_kind(scene.setup).expected_rays ? "up to" : "some");
}

RenderedCase render_case(PreparedCase const& prepared, Renderer& renderer, RenderTheory theory) {
  bool const on_cpu = renderer.device() == "cpu";  // the estimate is valid for this device only
  double const expected_s =
      on_cpu ? expected_render_seconds(prepared.scene, prepared.plan, theory) / thread_count() : 0;
  if (std::string const text = rendering_announcement(prepared.scene, prepared.plan, expected_s); !text.empty()) {
    spdlog::info("{}", text);
  }
  auto const start = std::chrono::steady_clock::now();
  RenderedCase rendered;
  stop_point("rendering");
  rendered.rendering = std::make_shared<Rendering const>(
      render(prepared.scene, prepared.plan, renderer, RenderImages::in_place, theory));
  rendered.exposure_e = choose_exposure(prepared.scene, *rendered.rendering->in_place);
  rendered.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return rendered;
}

RecordedFrames record_frames(PreparedCase const& prepared, RenderedCase const& rendered) {
  return rendered.rendering->in_place->record(Detector(prepared.scene.setup.camera, rendered.exposure_e));
}

RecordedCase render_case_in_memory(CaseSetup& loaded, Renderer& renderer, ReusableParts const& known) {
  RecordedCase finished;
  hash_inputs(loaded);
  finished.prepared = prepare_case(loaded, known);
  finished.rendered = render_case(finished.prepared, renderer, RenderTheory::yes);
  finished.frames = record_frames(finished.prepared, finished.rendered);
  return finished;
}

CaseOutcome judge_case(CaseSetup& loaded, PreparedCase const& prepared, RenderedCase const& rendered,
                       RecordedFrames const& frames) {
  CaseOutcome outcome;
  Warnings& warnings = outcome.warnings = prepared.warnings;
  if (loaded.setup.render.precision == Precision::single) {
    warn(warnings, {WarningCode::obsolete, "render.precision",
                    "\"single\" is obsolete, and double precision is used; remove it"});
  }
  Rendering const& rendering = *rendered.rendering;
  CameraSetup const& camera = prepared.scene.setup.camera;
  RenderingAccuracy const accuracy =
      measure_accuracy(prepared.scene, prepared.plan, rendering.truth, rendered.exposure_e);
  outcome.table_error = accuracy.table;
  outcome.image_error_levels = accuracy.image_levels;
  if (accuracy.table) warn_of_table(warnings, *accuracy.table);
  outcome.device = rendering.device;
  // If the rays are chosen again, they are chosen for the same exposure, so "auto" remains.
  if (camera.absolute_exposure) {
    loaded.document.root().table("camera").resolve("exposure", std::string("absolute"));
  } else if ((accuracy.table || prepared.plan.adaptive_criteria) && !loaded.setup.render.rays_per_dot &&
             !camera.exposure_e) {
    loaded.document.root().table("camera").resolve("exposure", std::string("auto"));
  } else {
    loaded.document.root().table("camera").resolve("exposure", rendered.exposure_e);
  }
  // comparison renders further points of this case by the same method
  if (accuracy.table || prepared.plan.method != resolve_render_method(prepared.scene)) {
    loaded.document.root().table("render").resolve("method", std::string(to_string(rendering.plan.method)));
  }
  outcome.levels = frames.levels->integers();
  outcome.reference_sha256 = pixel_sha256(outcome.levels.reference);
  outcome.flow_sha256 = pixel_sha256(outcome.levels.flow);
  static_cast<RenderedOutcome&>(outcome) = warn_of_rendering(warnings, prepared, rendered, frames);
  // If dots at side faces are traced by rays, both errors are theirs, and one warning suffices
  bool const is_warned_of = outcome.side_faces && outcome.side_faces->truth_error_px > truth_tolerance_px;
  if (!is_warned_of) warn_of_images(warnings, camera, outcome.image_error_levels);
  return outcome;
}

nlohmann::json write_case(CaseSetup& loaded, PreparedCase const& prepared, RenderedCase const& rendered,
                          RecordedFrames const& frames, CaseOutcome const& outcome, std::string const& folder) {
  namespace fs = std::filesystem;
  Scene const& scene = prepared.scene;
  Rendering const& rendering = *rendered.rendering;
  CameraSetup const& camera = scene.setup.camera;
  std::string const resolved = loaded.document.resolved();

  auto const place = [&](char const* name) { return (fs::path(folder) / name).string(); };
  ImageMetadata const metadata{camera.bit_depth, camera.pixel_pitch, resolved};
  write_tiff(place(case_file::reference), outcome.levels.reference, metadata);
  write_tiff(place(case_file::flow), outcome.levels.flow, metadata);
  FileOrigin origin{"gladstone truth", 2, resolved, scene.setup.render.seed, outcome.device};
  origin.sources.add_known("reference", outcome.reference_sha256);
  origin.sources.add_known("flow", outcome.flow_sha256);
  if (loaded.input_hashes.empty()) hash_inputs(loaded);
  for (auto const& [path, hash] : loaded.input_hashes) origin.sources.add("", path, SourceFiles::Holds::bytes, hash);
  origin.sources.add_known("inputs", nlohmann::json(loaded.input_hashes).dump());
  case_kind(scene.setup).write_truth(place(case_file::truth), scene, rendering, outcome, origin);
  OutputFile::write_text(place(case_file::setup), insert_uncertain_inputs(resolved, loaded.uncertain));
  nlohmann::json summary = case_summary(loaded, prepared, rendered, frames, outcome);
  OutputFile::write_text(place(case_file::summary), json_text(summary) + "\n");
  return summary;
}

WrittenCase render_to_folder(CaseSetup& loaded, Renderer& renderer, std::string const& folder) {
  OutputFolder output(folder, case_content());
  WrittenCase written{render_case_in_memory(loaded, renderer), {}};
  auto const& [prepared, rendered, frames] = static_cast<RecordedCase const&>(written);
  written.outcome = judge_case(loaded, prepared, rendered, frames);
  output.fill(
      [&](std::string const& place) { write_case(loaded, prepared, rendered, frames, written.outcome, place); });
  output.commit();
  return written;
}

}  // namespace gladstone::inline cases
