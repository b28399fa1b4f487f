#include "studies/case.h"

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
#include "render/base/text_encoding.h"
#include "render/base/units.h"
#include "render/focused_dots/focused_dots.h"
#include "render/scene/field_coverage.h"
#include "render/sensor/detector.h"
#include "studies/json_text.h"
#include "studies/scene_renderer.h"
#include "studies/truth_file.h"

namespace gladstone {
namespace {

constexpr double least_displacement_px = 1e-6;  // below it nothing moves
constexpr int map_spacing_px = 2;               // of the maps in truth.h5: turbulence's fronts are a few pixels wide

void cross_check_windows(CaseSetup& loaded) {
  CameraSetup const& camera = loaded.setup.camera;
  for (int window : loaded.correlate.window_px) {
    if (window <= std::min(camera.columns, camera.rows)) continue;
    loaded.document.root()
        .table("correlate")
        .problem("window_px",
                 fmt::format("a window of {} px is larger than the image of {} x {} px; use smaller windows", window,
                             camera.columns, camera.rows));
  }
}

/// Places check_memory's refusal, "table.key: message", in the setup. A field file that cannot be read is left to those
/// who read it.
void cross_check_memory(CaseSetup& loaded, FieldMemory field) {
  try {
    check_memory(loaded.setup, field, focused_dots_memory(loaded.setup));
  } catch (DataError const& error) {
    std::string const text = error.what();
    SetupTable root = loaded.document.root();
    auto const place = [&](std::string const& path, std::vector<SetupTable> tables) {
      std::string const start = path + ": ";
      if (!text.starts_with(start)) return;
      SetupTable table = tables.empty() ? root.table(path.substr(0, path.find('.'))) : tables.front();
      table.problem(path.substr(path.rfind('.') + 1), text.substr(start.size()));
    };
    place("camera.pixels", root.tables("camera"));
    place("medium.field.file", root.table("medium").tables("field"));
    place("target.dots_per_32px_window", {});
    place("render.rays_per_dot", {});
  }
}

/// Refuses the fast renderer where it does not hold.
void cross_check_method(CaseSetup& loaded) {
  if (loaded.setup.render.method != RenderMethod::focused_dots) return;
  std::string const reason = reason_against_focused_dots(loaded.setup);
  if (reason.empty()) return;
  loaded.document.root().table("render").problem("method",
                                                 "does not hold here (" + reason + "); use \"auto\" or \"rays\"");
}

void warn(std::vector<std::string>& warnings, std::string text) {
  spdlog::warn("{}", text);
  warnings.push_back(std::move(text));
}

/// Warns of a truth that is not known well, and says what would cure it.
void warn_of_truth(std::vector<std::string>& warnings, Rendering const& rendering, TruthAccuracy const& accuracy,
                   std::uint64_t rays) {
  if (accuracy.unknown > 0) {
    warn(warnings, fmt::format("truth: how well the displacements of {} of {} dots are known cannot be told (a single "
                               "ray has no scatter); increase render.rays_per_dot to 8 or more",
                               accuracy.unknown, rendering.truth.size()));
  }
  if (!(accuracy.rms_px > truth_tolerance_px)) return;
  std::string why;
  if (rendering.table != TableState::made) {
    why = fmt::format("; truth is that of rays alone, since {}", to_string(rendering.table));
  } else if (accuracy.above_by_rays > 0) {
    why = fmt::format(
        "; the truth of {} of these is that of rays alone, which meet the faces of the field or lose "
        "their way in it",
        accuracy.above_by_rays);
  }
  warn(warnings,
       fmt::format("truth: displacements are known to {:.2g} px only (rms of the dots' standard errors): {} of "
                   "{} dots are worse than {} px, the worst is dot {} with {:.2g} px{}; increase "
                   "render.rays_per_dot, {} now, if that matters",
                   accuracy.rms_px, accuracy.above, rendering.truth.size(), truth_tolerance_px, accuracy.worst,
                   accuracy.largest_px, why, rays));
}

nlohmann::json status_counts(StatusCounts const& counts, std::size_t frame) {
  nlohmann::json json;
  for (std::size_t status = 0; status < ray_status_count; ++status) {
    json[to_string(static_cast<RayStatus>(status))] = counts[frame][status];
  }
  return json;
}

}  // namespace

CaseSetup load_case_setup(std::string const& path, std::vector<std::string> const& overrides) {
  SetupDocument document = SetupDocument::from_file(path);
  for (auto const& assignment : overrides) document.override_key(assignment);
  return load_case_setup(std::move(document));
}

CaseSetup load_case_setup(SetupDocument document, FieldMemory field) {
  CaseSetup loaded{std::move(document), {}, {}, {}, {}};
  SetupTable root = loaded.document.root();
  loaded.setup = read_setup(root);
  loaded.correlate = read_correlation_settings(root.table("correlate"));
  if (!loaded.correlate.window_px.empty()) loaded.setup.view_margin_px = loaded.correlate.window_px.front();
  for (std::string const& name : loaded.document.file_names()) {
    if (is_utf8(name)) continue;
    loaded.document.add_problem(name,
                                "holds bytes that are no UTF-8, the only text that setups may hold; "
                                "rename the file or the folder");
  }
  if (!loaded.document.has_problems()) {
    loaded.warnings = cross_check(loaded.setup, root);
    cross_check_windows(loaded);
    cross_check_method(loaded);
  }
  if (!loaded.document.has_problems()) cross_check_memory(loaded, field);
  loaded.document.finish();
  return loaded;
}

PreparedCase prepare_case(CaseSetup& loaded, KnownParts const& known) {
  PreparedCase prepared;
  prepared.correlate = loaded.correlate;
  for (auto const& text : loaded.warnings) warn(prepared.warnings, text);
  prepared.scene = build_scene(loaded.setup, known.medium);
  Scene& scene = prepared.scene;
  for (auto const& text : scene.medium.warnings) warn(prepared.warnings, text);
  if (known.step) {
    prepared.step = *known.step;
    use_step(scene, prepared.step);
  } else {
    prepared.step = plan_step_of(scene);
  }
  if (prepared.step.change_px >= 1e-4) {
    warn(
        prepared.warnings,
        fmt::format("step_mm = {:.4g}: halving it would still change dot {} by {:.2g} px; use a smaller medium.step_mm",
                    prepared.step.step_mm, prepared.step.limiting_dot, prepared.step.change_px));
  }
  auto const in_view = [&scene](Vec2d centre) { return scene.in_view(centre); };
  if (std::none_of(scene.dots.centre.begin(), scene.dots.centre.end(), in_view)) {
    warn(prepared.warnings,
         fmt::format("none of {} dots lies in the view, {:.4g} x {:.4g} mm about the axis: the images will be empty; "
                     "check the target's file (places are in mm) or increase target.dots_per_32px_window",
                     scene.dots.centre.size(),
                     loaded.setup.camera.columns * loaded.setup.camera.pixel_pitch / scene.imaging.magnification * 1e3,
                     loaded.setup.camera.rows * loaded.setup.camera.pixel_pitch / scene.imaging.magnification * 1e3));
  }
  prepared.rays = known.rays ? *known.rays : plan_rays_of(scene);
  scene.rays_per_dot = prepared.rays.rays;
  if (!prepared.rays.converged) {
    warn(prepared.warnings,
         fmt::format("rays_per_dot = {}: the image is only good to {:.2g} grey levels of {} bits, truth to "
                     "{:.2g} px, where {} and {} are asked (that would take some {:.2g} rays a dot and {:.0f} s of one "
                     "processor; \"auto\" takes {:.0f} s or 1024 rays); set render.rays_per_dot higher if that matters",
                     prepared.rays.rays, prepared.rays.image_error_levels, prepared.rays.bits,
                     prepared.rays.truth_error_px, image_tolerance_levels, truth_tolerance_px,
                     prepared.rays.rays_wanted, rays_seconds(scene) * prepared.rays.rays_wanted, rays_budget_s));
  }
  if (loaded.setup.medium.field.kind != FieldKind::none) {
    prepared.strain = known.strain ? *known.strain : strain_of(scene);
    Bounds<double> const box = std::visit([](auto const& view) { return view.bounds(); }, scene.medium.view);
    std::string const coverage = field_coverage(box, loaded.setup).warning();
    if (!coverage.empty()) warn(prepared.warnings, coverage);
    if (prepared.strain.largest_px < least_displacement_px) {
      warn(prepared.warnings,
           fmt::format("nothing moves: by Eq. 9 the field displaces no place of the view by more than {:.2g} px; check "
                       "quantity, scale, spacing and place of medium.field, or its amplitude",
                       prepared.strain.largest_px));
    }
    if (prepared.strain.caustic_fraction > 0) {
      warn(prepared.warnings,
           fmt::format("caustic: over {:.2g} % of the view the strain is 1 or more and rays cross before they reach "
                       "the lens (images "
                       "of dots fold over there); reduce Z_D or the gradients, or leave these vectors out",
                       100 * prepared.strain.caustic_fraction));
    }
  }
  SetupTable root = loaded.document.root();
  root.table("medium").resolve("step_mm", prepared.step.step_mm);
  root.table("render").resolve("rays_per_dot", static_cast<long long>(prepared.rays.rays));
  if (loaded.setup.target.kind != TargetKind::points) {
    Vec2d const extent = loaded.setup.target_extent();
    root.table("target").resolve("extent_mm",
                                 std::vector<double>{extent.x / unit::millimetre, extent.y / unit::millimetre});
  }
  return prepared;
}

namespace {

/// Whole grey levels as a picture's file holds them.
Image<std::uint16_t> picture_of(Image<double> const& levels) {
  Image<std::uint16_t> picture(levels.columns(), levels.rows());
  std::transform(levels.begin(), levels.end(), picture.begin(),
                 [](double level) { return static_cast<std::uint16_t>(level); });
  return picture;
}

void hash_inputs(CaseSetup& loaded) {
  for (std::string const& file : loaded.document.file_names()) loaded.input_hashes[file] = byte_sha256(file);
}

/// The preview is the GPU's alone; the CPU gives better than was asked for.
bool single_precision(Setup const& setup, Renderer const& renderer) {
  return setup.render.precision == Precision::single && renderer.device() == "cuda";
}

/// What keeps pixels from saturation: what fills them is the light, the charge without light, or their noise.
/// @param light_e electrons that light sets free in the brightest pixel
std::string saturation_cure(CameraSetup const& camera, double light_e) {
  NoiseSetup const& noise = camera.noise;
  double const full_scale = std::pow(2.0, camera.bit_depth) - 1;
  double const offset_e = camera.offset_dn / full_scale * noise.full_well_e;
  double const dark_e = noise.enabled ? noise.dark_current_e : 0.0;
  bool const without_noise = offset_e + light_e + dark_e >= noise.full_well_e;
  if (without_noise && dark_e > light_e) return "lower camera.noise.dark_current_e";
  double const shot_e = noise.shot_noise ? std::sqrt(light_e + dark_e) : 0.0;
  if (without_noise || noise.read_noise_e <= shot_e) return "lower camera.exposure";
  return fmt::format("lower camera.noise.read_noise_e: {:.4g} electrons are {:.2g} of the full well",
                     noise.read_noise_e, noise.read_noise_e / noise.full_well_e);
}

}  // namespace

double exposure_of(CameraSetup const& camera, KeptLight const& light) {
  return camera.exposure_e ? *camera.exposure_e : Detector::auto_exposure(camera, light.brightest());
}

RenderedCase render_case(PreparedCase const& prepared, Renderer& renderer, RenderTheory theory) {
  auto const start = std::chrono::steady_clock::now();
  RenderedCase rendered;
  Scene scene = prepared.scene;  // a copy: tracing may widen its pupil
  rendered.rendering =
      std::make_shared<Rendering const>(renderer.render(scene, scene.dots, RenderImages::kept, theory));
  rendered.pupil_margin = scene.pupil_margin;
  rendered.exposure_e = exposure_of(scene.setup.camera, *rendered.rendering->kept);
  rendered.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return rendered;
}

RecordedFrames record_frames(PreparedCase const& prepared, RenderedCase const& rendered) {
  return rendered.rendering->kept->record(Detector(prepared.scene.setup.camera, rendered.exposure_e));
}

FinishedCase render_to_folder(CaseSetup& loaded, Renderer& renderer, std::string const& folder) {
  OutputFolder output(folder, case_content());
  FinishedCase finished;
  hash_inputs(loaded);
  finished.prepared = prepare_case(loaded);
  finished.rendered = render_case(finished.prepared, renderer, RenderTheory::yes);
  finished.frames = record_frames(finished.prepared, finished.rendered);
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
  if (single_precision(loaded.setup, renderer)) {
    warn(warnings,
         "render.precision = \"single\" is a preview: displacements carry some 1e-5 px of rounding; use \"double\" for "
         "truth");
  } else if (loaded.setup.render.precision == Precision::single) {
    warn(warnings, "render.precision = \"single\" is the GPU's preview: the CPU has rendered in double");
  }
  Scene scene = prepared.scene;
  scene.pupil_margin = rendered.pupil_margin;
  Rendering const& rendering = *rendered.rendering;
  CameraSetup const& camera = scene.setup.camera;
  std::string const device = rendering.device.empty() ? renderer.device() : rendering.device;
  auto const& [levels, saturated_reference, saturated_flow] = frames;
  loaded.document.root().table("camera").resolve("exposure", rendered.exposure_e);
  // what "auto" takes for other scenes hangs on the device, and on what is compared
  if (rendering.method == RenderMethod::focused_dots) {
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
  write_truth(place(case_file::truth), scene, rendering.truth, rendering.statuses, field_of(scene, map_spacing_px),
              rendering.method, origin);
  OutputFile::write_text(place(case_file::setup), resolved);

  auto const unseen = std::count_if(rendering.truth.displacement_px.begin(), rendering.truth.displacement_px.end(),
                                    [](Vec2d d) { return std::isnan(d.x); });
  if (unseen > 0) {
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
  warn_of_truth(warnings, rendering, accuracy, prepared.rays.rays);
  nlohmann::json summary{
      {"magnification", scene.imaging.magnification},
      {"step_mm", prepared.step.step_mm},
      {"step", {{"change_px", prepared.step.change_px}, {"limiting_dot", prepared.step.limiting_dot}}},
      {"rays_per_dot", prepared.rays.rays},
      {"exposure", rendered.exposure_e},
      {"gladstone_dale", scene.setup.medium.gladstone_dale},
      {"spot",
       {{"model", loaded.document.root().table("lens").text("psf", "gaussian")},
        {"first_zero_diameter_px", scene.setup.spot_diameter_px()},
        {"sigma_px", scene.spot_sigma_px() > 0 ? nlohmann::json(scene.spot_sigma_px()) : nlohmann::json(nullptr)}}},
      {"dots", scene.dots.centre.size()},
      {"dots_unseen", unseen},
      {"truth_error_px",
       {{"rms", accuracy.rms_px},
        {"largest", accuracy.largest_px},
        {"largest_dot", accuracy.worst},
        {"dots_above_1e-3", accuracy.above},
        {"dots_unknown", accuracy.unknown}}},
      {"estimator",
       {{"dots_by_table", accuracy.by_table},
        {"dots_by_rays", scene.dots.centre.size() - accuracy.by_table},
        {"no_table_since", to_string(rendering.table)}}},
      {"method", to_string(rendering.method)},
      {"device", device},
      {"precision", single_precision(scene.setup, renderer) ? "single (preview)" : "double"},
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
  if (!scene.setup.render.rays_per_dot) {
    summary["rays_plan"] = {{"truth_error_px", prepared.rays.truth_error_px},
                            {"image_error_levels", prepared.rays.image_error_levels},
                            {"bits", prepared.rays.bits},
                            {"extrapolated", prepared.rays.extrapolated},
                            {"truth_asked_px", truth_tolerance_px},
                            {"image_asked_levels", image_tolerance_levels},
                            {"rays_wanted", prepared.rays.rays_wanted},
                            {"processor_seconds", prepared.rays.seconds},
                            {"processor_seconds_allowed", rays_budget_s}};
  }
  std::string const text = json_text(summary) + "\n";
  OutputFile::write_text(place(case_file::summary), text);
  return text;
}

FolderContent case_content() { return {case_file::setup, {case_file::derived.begin(), case_file::derived.end()}}; }

namespace {

template <class Names>
std::vector<std::string> in_folder(std::string const& folder, Names const& names) {
  std::vector<std::string> paths;
  for (char const* name : names) paths.push_back((std::filesystem::path(folder) / name).string());
  return paths;
}

}  // namespace

std::vector<std::string> rendered_files(std::string const& folder) {
  return in_folder(folder, std::array{case_file::reference, case_file::flow, case_file::truth, case_file::setup,
                                      case_file::summary});
}

std::vector<std::string> derived_files(std::string const& folder) { return in_folder(folder, case_file::derived); }

void refuse_case_over_inputs(std::string const& folder, std::vector<std::string> const& inputs) {
  refuse_inputs_as_outputs(rendered_files(folder), inputs);
  refuse_inputs_as_outputs(derived_files(folder), inputs);
}

std::string in_case(std::string const& folder, std::string const& name) {
  namespace fs = std::filesystem;
  if (!is_complete(folder, case_content())) {
    throw DataError(folder,
                    "is not a case (it holds no setup.toml); make one with: gladstone render SETUP.toml -o " + folder);
  }
  return (fs::path(folder) / name).string();
}

}  // namespace gladstone
