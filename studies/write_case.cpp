#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/image_file.h"
#include "render/base/output_file.h"
#include "render/base/output_folder.h"
#include "render/base/units.h"
#include "render/focused_dots/table_error.h"
#include "render/sensor/detector.h"
#include "studies/case.h"
#include "studies/json_text.h"
#include "studies/particle_case.h"
#include "studies/scene_renderer.h"
#include "studies/truth_file.h"

namespace gladstone {
namespace {

constexpr int map_spacing_px = 2;  // of the maps in truth.h5: turbulence's fronts are a few pixels wide

/// Warns of a truth that is not known well, and says what would cure it.
/// @param sources what they are: dots or particles
void warn_of_truth(std::vector<std::string>& warnings, Rendering const& rendering, TruthAccuracy const& accuracy,
                   std::uint64_t rays, std::string_view sources) {
  if (accuracy.unknown > 0) {
    warn(warnings, fmt::format("truth: how well the displacements of {} of {} {} are known cannot be told (a single "
                               "ray has no scatter); increase render.rays_per_dot to 8 or more",
                               accuracy.unknown, rendering.truth.size(), sources));
  }
  if (!(accuracy.rms_px > truth_tolerance_px)) return;
  std::string why;
  if (rendering.table != TableState::made && sources == "dots") {
    why = fmt::format("; truth is that of rays alone, since {}", to_string(rendering.table));
  } else if (accuracy.above_by_rays > 0 && sources == "dots") {
    why = fmt::format(
        "; the truth of {} of these is that of rays alone, which meet the faces of the field or lose "
        "their way in it",
        accuracy.above_by_rays);
  }
  warn(
      warnings,
      fmt::format("truth: displacements are known to {:.2g} px only (rms of the standard errors): {} of {} {} are "
                  "worse than {} px, the worst is number {} with {:.2g} px{}; increase render.rays_per_dot, {} now, if "
                  "that matters",
                  accuracy.rms_px, accuracy.above, rendering.truth.size(), sources, truth_tolerance_px, accuracy.worst,
                  accuracy.largest_px, why, rays));
}

/// What the deflection table leaves of truth and images, measured where the plan has not; with a warning where it is
/// more than is asked.
RaysPlan error_of_table(Scene const& scene, RaysPlan const& plan, std::vector<std::string>& warnings) {
  // with dots at side faces the plan's errors are also those of their rays
  bool const measured = plan.rays_at_side_faces == 0 && (plan.truth_error_px > 0 || plan.image_error_levels > 0);
  RaysPlan const error = measured ? plan : measure_table_error(focused_dots(scene).value());
  if (error.excess() > 1) {
    warn(warnings,
         fmt::format("what the table of deflections leaves: images are off by {:.2g} grey levels of {} bits, truth by "
                     "{:.2g} px, where {} and {} are asked; render.method = \"rays\" leaves nothing, but takes many "
                     "render.rays_per_dot to scatter less",
                     error.image_error_levels, error.bits, error.truth_error_px, image_tolerance_levels,
                     truth_tolerance_px));
  }
  return error;
}

/// Least, median and most of some numbers.
nlohmann::json spread_of(std::vector<std::int64_t> numbers) {
  if (numbers.empty()) return nullptr;
  std::sort(numbers.begin(), numbers.end());
  return {{"least", numbers.front()}, {"median", numbers[numbers.size() / 2]}, {"most", numbers.back()}};
}

nlohmann::json status_counts(StatusCounts const& counts, std::size_t frame) {
  nlohmann::json json;
  for (std::size_t status = 0; status < ray_status_count; ++status) {
    json[to_string(static_cast<RayStatus>(status))] = counts[frame][status];
  }
  return json;
}

/// Whole grey levels as a picture's file holds them.
Image<std::uint16_t> picture_of(Image<double> const& levels) {
  Image<std::uint16_t> picture(levels.columns(), levels.rows());
  std::transform(levels.begin(), levels.end(), picture.begin(),
                 [](double level) { return static_cast<std::uint16_t>(level); });
  return picture;
}

/// What keeps pixels from saturation: what fills them is the light, the charge without light, or their noise.
/// @param light_e electrons that light sets free in the brightest pixel
std::string saturation_cure(CameraSetup const& camera, double light_e) {
  NoiseSetup const& noise = camera.noise;
  double const full_scale = std::pow(2.0, camera.bit_depth) - 1;
  double const offset_e = camera.offset_dn / full_scale * noise.full_well_e;
  double const dark_e = noise.enabled ? noise.dark_current_e : 0.0;
  double const stray_e = camera.background.most_e();
  bool const without_noise = offset_e + light_e + stray_e + dark_e >= noise.full_well_e;
  if (without_noise && dark_e > light_e) return "lower camera.noise.dark_current_e";
  if (without_noise && stray_e > light_e) return "lower camera.background";
  double const shot_e = noise.shot_noise ? std::sqrt(light_e + dark_e) : 0.0;
  if (without_noise || noise.read_noise_e <= shot_e) return "lower camera.exposure";
  return fmt::format("lower camera.noise.read_noise_e: {:.4g} electrons are {:.2g} of the full well",
                     noise.read_noise_e, noise.read_noise_e / noise.full_well_e);
}

}  // namespace

void hash_inputs(CaseSetup& loaded) {
  for (std::string const& file : loaded.document.file_names()) loaded.input_hashes[file] = byte_sha256(file);
}

double exposure_of(Scene const& scene, KeptLight const& light) {
  CameraSetup const& camera = scene.setup.camera;
  if (camera.absolute_exposure) return scene.photon_unit * camera.noise.quantum_efficiency;
  return camera.exposure_e ? *camera.exposure_e : Detector::auto_exposure(camera, light.brightest());
}

RenderedCase render_case(PreparedCase const& prepared, Renderer& renderer, RenderTheory theory) {
  auto const start = std::chrono::steady_clock::now();
  RenderedCase rendered;
  Scene scene = prepared.scene;  // a copy: tracing may widen its pupil
  rendered.rendering = std::make_shared<Rendering const>(
      scene.setup.piv ? renderer.render_particles(scene, scene.particles, ParticleLight::scattered, RenderImages::kept)
                      : renderer.render(scene, scene.dots, RenderImages::kept, theory));
  rendered.pupil_margin = scene.pupil_margin;
  rendered.exposure_e = exposure_of(scene, *rendered.rendering->kept);
  rendered.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return rendered;
}

RecordedFrames record_frames(PreparedCase const& prepared, RenderedCase const& rendered) {
  return rendered.rendering->kept->record(Detector(prepared.scene.setup.camera, rendered.exposure_e));
}

FinishedCase finish_case(CaseSetup& loaded, Renderer& renderer, KnownParts const& known) {
  FinishedCase finished;
  hash_inputs(loaded);
  finished.prepared = prepare_case(loaded, known);
  finished.rendered = render_case(finished.prepared, renderer, RenderTheory::yes);
  finished.frames = record_frames(finished.prepared, finished.rendered);
  return finished;
}

FinishedCase render_to_folder(CaseSetup& loaded, Renderer& renderer, std::string const& folder) {
  OutputFolder output(folder, case_content());
  FinishedCase finished = finish_case(loaded, renderer);
  output.fill([&](std::string const& place) {
    finished.summary = write_case(loaded, finished.prepared, finished.rendered, finished.frames, renderer, place);
  });
  output.commit();
  return finished;
}

std::string write_case(CaseSetup& loaded, PreparedCase const& prepared, RenderedCase const& rendered,
                       RecordedFrames const& frames, Renderer const& renderer, std::string const& folder) {
  namespace fs = std::filesystem;
  std::vector<std::string> warnings = prepared.warnings;
  if (loaded.setup.render.precision == Precision::single) {
    warn(warnings, "render.precision = \"single\" gains nothing any more: rendered in double");
  }
  Scene scene = prepared.scene;
  scene.pupil_margin = rendered.pupil_margin;
  Rendering const& rendering = *rendered.rendering;
  CameraSetup const& camera = scene.setup.camera;
  bool const by_table = rendering.method == RenderMethod::focused_dots;
  std::optional<RaysPlan> table_error;
  if (by_table) table_error = error_of_table(scene, prepared.rays, warnings);
  std::string const device = rendering.device.empty() ? renderer.device() : rendering.device;
  auto const& [levels, saturated_reference, saturated_flow] = frames;
  // where the rays are planned again, they are planned for the same exposure
  if (camera.absolute_exposure) {
    loaded.document.root().table("camera").resolve("exposure", std::string("absolute"));
  } else if ((by_table || scene.by_need) && !loaded.setup.render.rays_per_dot && !camera.exposure_e) {
    loaded.document.root().table("camera").resolve("exposure", std::string("auto"));
  } else {
    loaded.document.root().table("camera").resolve("exposure", rendered.exposure_e);
  }
  // what "auto" takes for other scenes hangs on the device, and on what is compared
  if (by_table || prepared.rays.method != RenderMethod::automatic) {
    loaded.document.root().table("render").resolve("method", std::string(to_string(rendering.method)));
  }
  std::string const resolved = loaded.document.resolved();

  if (saturated_reference + saturated_flow > 0) {
    warn(warnings,
         fmt::format("{} pixels are saturated in the reference, {} in the flow frame; {}", saturated_reference,
                     saturated_flow, saturation_cure(camera, rendered.exposure_e * rendering.kept->brightest())));
  }
  auto const place = [&](char const* name) { return (fs::path(folder) / name).string(); };
  ImageMetadata const metadata{camera.bit_depth, camera.pixel_pitch, resolved};
  FileOrigin origin{"gladstone truth", 2, resolved, scene.setup.render.seed, device};
  auto const write_frame = [&](char const* name, char const* file, Image<double> const& frame) {
    Image<std::uint16_t> const picture = picture_of(frame);
    write_tiff(place(file), picture, metadata);
    origin.sources.add_known(name, pixel_sha256(picture));
  };
  write_frame("reference", case_file::reference, levels->reference());
  write_frame("flow", case_file::flow, levels->flow());
  if (loaded.input_hashes.empty()) hash_inputs(loaded);
  for (auto const& [path, hash] : loaded.input_hashes) origin.sources.add("", path, SourceFiles::Holds::bytes, hash);
  origin.sources.add_known("inputs", nlohmann::json(loaded.input_hashes).dump());
  if (scene.setup.piv) {
    write_particle_truth(place(case_file::truth), scene, rendering.truth, rendering.statuses, rendering.method, origin);
  } else {
    write_truth(place(case_file::truth), scene, rendering.truth, rendering.statuses, field_of(scene, map_spacing_px),
                rendering.method, table_error ? &*table_error : nullptr, origin);
  }
  OutputFile::write_text(place(case_file::setup), resolved);

  auto const unseen = std::count_if(rendering.truth.displacement_px.begin(), rendering.truth.displacement_px.end(),
                                    [](Vec2d d) { return std::isnan(d.x); });
  if (unseen > 0 && !scene.setup.piv) {  // of particles those are meant that are beside the light
    double const disc = scene.pupil_radius(), stop = scene.imaging.entrance_pupil / 2;
    double const passing = static_cast<double>(scene.rays_per_dot) * (stop * stop) / (disc * disc);
    constexpr double few = 16;  // 16 rays all miss the stop once in e^16 dots
    std::string const why =
        !scene.chief_rays_only() && passing < few
            ? fmt::format(
                  "some {:.2g} of a dot's {} rays pass the stop, since the flow bends them by up to {:.3g} mm; "
                  "take more rays (render.rays_per_dot), or reduce the gradients or Z_D",
                  passing, scene.rays_per_dot, scene.pupil_margin / unit::millimetre)
            : "the flow bends their rays past the lens; reduce the gradients or Z_D";
    warn(warnings, fmt::format("{} of {} dots are not seen in one of the frames, and their truth is nan: {}", unseen,
                               scene.dots.centre.size(), why));
  }
  TruthAccuracy const accuracy = truth_accuracy(rendering.truth, truth_tolerance_px);
  warn_of_truth(warnings, rendering, accuracy, prepared.rays.rays, scene.setup.piv ? "particles" : "dots");
  nlohmann::json summary{
      {"magnification", scene.imaging.magnification},
      {"step_mm", prepared.step.step_mm},
      {"step", {{"change_px", prepared.step.change_px}, {"limiting_dot", prepared.step.limiting_dot}}},
      {"rays_per_dot", prepared.rays.rays},
      {"rays_planned", spread_of(rendering.truth.rays_planned)},
      {"exposure", rendered.exposure_e},
      {"gladstone_dale", scene.setup.medium.gladstone_dale},
      {"spot",
       {{"model", loaded.document.root().table("lens").text("psf", "gaussian")},
        {"first_zero_diameter_px", scene.setup.spot_diameter_px()},
        {"sigma_px", scene.spot_sigma_px() > 0 ? nlohmann::json(scene.spot_sigma_px()) : nlohmann::json(nullptr)}}},
      {"experiment", scene.setup.piv ? "piv" : "bos"},
      {"dots", rendering.truth.size()},
      {"dots_unseen", unseen},
      {"truth_error_px",
       {{"rms", accuracy.rms_px},
        {"largest", accuracy.largest_px},
        {"largest_dot", accuracy.worst},
        {"dots_above_1e-3", accuracy.above},
        {"dots_unknown", accuracy.unknown}}},
      {"estimator",
       {{"dots_by_table", accuracy.by_table},
        {"dots_by_rays", rendering.truth.size() - accuracy.by_table},
        {"no_table_since", to_string(rendering.table)},
        {"table_error", table_error ? nlohmann::json{{"truth_px", table_error->truth_error_px},
                                                     {"image_levels", table_error->image_error_levels},
                                                     {"bits", table_error->bits}}
                                    : nlohmann::json(nullptr)}}},
      {"method", to_string(rendering.method)},
      {"device", device},
      {"precision", "double"},
      {"rays",
       {{"traced", rendering.rays},
        {"reference", status_counts(rendering.statuses, 0)},
        {"flow", status_counts(rendering.statuses, 1)}}},
      {"pupil_margin_mm", scene.pupil_margin / unit::millimetre},
      {"caustic_fraction", prepared.strain.caustic_fraction},
      {"saturated", {{"reference", saturated_reference}, {"flow", saturated_flow}}},
      {"reference_sha256", origin.sources.sha256("reference")},
      {"flow_sha256", origin.sources.sha256("flow")},
      {"photons_fully_lit", rendered.exposure_e / camera.noise.quantum_efficiency},
      {"warnings", warnings},
      {"seconds_render", rendered.seconds},
  };
  if (scene.setup.piv) summary.update(particle_summary(scene, rendering.truth, rendered.exposure_e));
  if (!scene.setup.render.rays_per_dot) {
    summary["rays_plan"] = {
        {"truth_error_px", prepared.rays.truth_error_px},
        {"image_error_levels", prepared.rays.image_error_levels},
        {"bits", prepared.rays.bits},
        {"extrapolated", prepared.rays.extrapolated},
        {"truth_asked_px", truth_tolerance_px},
        {"image_asked_levels", image_tolerance_levels},
        {"rays_wanted", prepared.rays.rays_wanted},
        {"processor_seconds", prepared.rays.seconds},
        {"processor_seconds_allowed", source_budget_s * static_cast<double>(rendering.truth.size())}};
  }
  std::string const text = json_text(summary) + "\n";
  OutputFile::write_text(place(case_file::summary), text);
  return text;
}

}  // namespace gladstone
