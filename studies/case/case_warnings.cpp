#include "studies/case/case_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/units.h"
#include "render/rays/ray_planning.h"
#include "render/scene/light_through_lens.h"
#include "render/scene/side_faces.h"
#include "render/sensor/detector.h"
#include "studies/case/warning_log.h"
#include "studies/case/write_case.h"

namespace gladstone::inline cases {
namespace {

std::string levels_unit(int bits) { return fmt::format("grey levels of {} bits", bits); }

/// Returns the largest number of rays of a source.
std::int64_t most_rays_of_a_source(GroundTruth const& truth) {
  return truth.size() == 0 ? 0 : *std::max_element(truth.rays_planned.begin(), truth.rays_planned.end());
}

}  // namespace

void warn(Warnings& warnings, Warning warning) {
  log_warning(warning);
  warnings.push_back(std::move(warning));
}

void warn(Warnings& warnings, Warnings const& added) {
  for (Warning const& warning : added) warn(warnings, warning);
}

std::string describe_error(double error, double resolution, std::string_view unit) {
  if (std::isnan(error)) return "an unknown amount";
  if (error < resolution) return fmt::format("less than {:.2g} {}", resolution, unit);
  return error < 99.5 ? fmt::format("{:.2g} {}", error, unit) : fmt::format("{:.0f} {}", error, unit);
}

void warn_of_ray_limit(Warnings& warnings, PreparedCase const& prepared, Rendering const& rendering) {
  if (!prepared.plan.adaptive_criteria || prepared.plan.rays == 1) return;
  bool const by_table =
      rendering.plan.method == RenderMethod::focused_dots;  // only the others take as many as required
  auto const limit = static_cast<std::int64_t>(by_table ? max_rays_per_source(prepared.scene, prepared.plan)
                                                        : largest_ray_number(prepared.scene, prepared.plan));
  std::vector<std::int64_t> const& rays = rendering.truth.rays_planned;
  std::size_t at_limit = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    bool const adaptive = !by_table || rendering.truth.path[i] == TruthPath::rays;
    if (adaptive && rays[i] >= limit) ++at_limit;
  }
  if (at_limit == 0) return;
  warn(warnings,
       {WarningCode::low_accuracy, "render.rays_per_dot",
        fmt::format(
            "\"auto\": {} of {} sources use the limit of {} rays ({:.2g} s of processor time each, or 1024 rays) and "
            "may miss the goals of {} px and {} grey levels; set a larger render.rays_per_dot if this matters",
            at_limit, rays.size(), limit, source_budget_s, truth_tolerance_px, image_tolerance_levels)});
}

void warn_of_images(Warnings& warnings, CameraSetup const& camera, double error_levels) {
  if (!(error_levels > image_tolerance_levels)) return;
  warn(warnings,
       {WarningCode::low_accuracy, "images",
        fmt::format("the standard error of lit pixels due to the number of rays is {} (the goal is {}); set a larger "
                    "render.rays_per_dot if this matters",
                    describe_error(error_levels, 0, levels_unit(error_bit_depth(camera))), image_tolerance_levels)});
}

std::optional<SideFaceAccuracy> side_face_accuracy(Scene const& scene, Rendering const& rendering) {
  if (rendering.plan.method != RenderMethod::focused_dots) return std::nullopt;
  SideFaceAccuracy there;
  bool seen = false;
  double squares = 0, components = 0;
  for (std::size_t const dot : sources_at_side_faces(scene, rendering.plan, scene.dots)) {
    ++there.dots;
    there.most_rays = std::max(there.most_rays, rendering.truth.rays_planned[dot]);
    seen = seen || scene.in_view(scene.dots.centre[dot]);
    Vec2d const error = rendering.truth.displacement_error_px[dot];
    if (!is_finite(error)) continue;
    squares += error.x * error.x + error.y * error.y;
    components += 2;
  }
  if (!seen) return std::nullopt;
  there.truth_error_px = std::sqrt(squares / components);
  return there;
}

void warn_of_side_faces(Warnings& warnings, Scene const& scene, SideFaceAccuracy const& there) {
  if (!(there.truth_error_px > truth_tolerance_px)) return;
  bool const given = scene.setup.render.rays_per_dot.has_value(), by_brightest = !scene.setup.camera.exposure_e;
  warn(warnings,
       {WarningCode::low_accuracy, "render.rays_per_dot",
        fmt::format(
            "{} dots lie at side faces of the medium, which cut their light cones, and are traced ray by ray, with {} "
            "rays each, for truth and images. The standard error of their truth is {} rms (the goal is {}){}; {}",
            there.dots, there.most_rays, describe_error(there.truth_error_px, 0, "px"), truth_tolerance_px,
            by_brightest ? ", and camera.exposure = \"auto\" is chosen from the brightest pixel of such images" : "",
            given ? "set render.rays_per_dot = \"auto\", which chooses a sufficient number for these dots"
                  : "increase render.rays_per_dot if this matters")});
}

void warn_of_truth(Warnings& warnings, Rendering const& rendering, TruthAccuracy const& accuracy,
                   std::string_view sources) {
  if (accuracy.unknown > 0) {
    warn(warnings, {WarningCode::low_accuracy, "truth",
                    fmt::format("the standard error of the displacements of {} of {} {} is unknown (a single ray has "
                                "no scatter); increase render.rays_per_dot to 8 or more",
                                accuracy.unknown, rendering.truth.size(), sources)});
  }
  if (!(accuracy.rms_px > truth_tolerance_px)) return;
  std::string why;
  if (rendering.table == TableState::by_rays) {
    // The user or the plan selected rays for all dots, which needs no explanation.
  } else if (rendering.table != TableState::made && sources == "dots") {
    why = fmt::format("; the truth is computed from rays only, since {}", to_string(rendering.table));
  } else if (accuracy.above_by_rays > 0 && sources == "dots") {
    why = fmt::format(
        "; the truth of {} of these is computed from rays only, since rays meet the side faces of the field or are "
        "lost in it",
        accuracy.above_by_rays);
  }
  warn(warnings,
       {WarningCode::low_accuracy, "truth",
        fmt::format("the standard error of the displacements is {:.2g} px rms; for {} of {} {} it exceeds {} px, and "
                    "number {} has the largest, {:.2g} px{}; increase render.rays_per_dot, now {}, if this matters",
                    accuracy.rms_px, accuracy.above, rendering.truth.size(), sources, truth_tolerance_px,
                    accuracy.worst, accuracy.largest_px, why, most_rays_of_a_source(rendering.truth))});
}

void warn_of_table(Warnings& warnings, TableError const& error) {
  if (!(error.excess() > 1)) return;
  warn(warnings,
       {WarningCode::low_accuracy, "render.method",
        fmt::format(
            "residual error of the deflection table: {} in the images, {} in the truth, and the goals are {} and {}; "
            "{}render.method = \"rays\" has no such error, but requires many render.rays_per_dot for less scatter",
            describe_error(error.image_levels, error.image_resolution_levels, levels_unit(error.bits)),
            describe_error(error.truth_px, error.truth_resolution_px, "px"), image_tolerance_levels, truth_tolerance_px,
            error.fineness == 1 ? "render.rays_per_dot = \"auto\" selects a finer table; " : "")});
}

std::size_t warn_of_unseen(Warnings& warnings, Scene const& scene, Rendering const& rendering, std::string_view where) {
  GroundTruth const& truth = rendering.truth;
  double const pupil_margin = rendering.pupil_margin;
  std::int64_t unseen = 0, in_reference = 0;                     // in one of the frames; in the reference
  std::int64_t rays = std::numeric_limits<std::int64_t>::max();  // smallest number of rays of an unseen dot
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!std::isnan(truth.displacement_px[i].x)) continue;
    ++unseen;
    if (std::isnan(truth.reference_px[i].x)) ++in_reference;
    rays = std::min(rays, truth.rays_planned[i]);
  }
  // unseen particles are those outside the light sheet
  if (unseen == 0 || !scene.setup.experiment().sources.on_target) return static_cast<std::size_t>(unseen);
  double const stop = scene.imaging.entrance_pupil / 2;
  double const edge = Scene::stop_edge(static_cast<double>(rendering.plan.rays));
  // radius of the disc to which rays are sent [m]
  double const disc = stop * std::sqrt(1 + edge / 2) + rendering.plan.pupil_margin;
  double const passing = static_cast<double>(rays) * (stop * stop) / (disc * disc);
  constexpr double few = 16;  // if 16 passing rays are expected, none passes with a probability of e^-16
  if (!scene.chief_rays_only() && pupil_margin > 0 && passing < few) {
    warn(warnings, {WarningCode::out_of_view, "target",
                    fmt::format("{} of {} dots{} are not imaged in one of the frames, and their truth is nan: some "
                                "{:.2g} of a dot's {} rays pass the stop, since the medium deflects them by up to "
                                "{:.3g} mm; use more rays (render.rays_per_dot), or reduce the gradients or Z_D",
                                unseen, truth.size(), where, passing, rays, pupil_margin / unit::millimetre)});
    return static_cast<std::size_t>(unseen);
  }
  if (in_reference > 0) {
    warn(warnings,
         {WarningCode::out_of_view, "target",
          fmt::format("{} of {} dots{} are not imaged, and their truth is nan: even without the medium, no ray of such "
                      "a dot ({} or more) passes the lens; these dots are outside the field of view of the lens or "
                      "vignetted, so reduce the dotted area, move the camera, or use more rays (render.rays_per_dot)",
                      in_reference, truth.size(), where, rays)});
  }
  if (unseen > in_reference) {
    warn(warnings, {WarningCode::out_of_view, "target",
                    fmt::format("{} of {} dots{} are not imaged in one of the frames, and their truth is nan: the "
                                "medium deflects their rays past the lens; reduce the gradients or Z_D",
                                unseen - in_reference, truth.size(), where)});
  }
  return static_cast<std::size_t>(unseen);
}

namespace {

/// Returns a remedy for saturation, depending on its main cause: light, charge without light, or noise.
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

void warn_of_saturation(Warnings& warnings, CameraSetup const& camera, std::size_t in_reference, std::size_t in_flow,
                        double light_e) {
  if (in_reference + in_flow == 0) return;
  warn(warnings, {WarningCode::exposure, "camera.exposure",
                  fmt::format("{} pixels are saturated in reference.tif, {} in flow.tif; {}", in_reference, in_flow,
                              saturation_cure(camera, light_e))});
}

namespace {

/// Signal-to-noise ratio of the brightest pixel below which a warning is given: twice the ratio of 5 at which a
/// particle is just visible (Rose, J. Opt. Soc. Am. 38 (1948) 196), since most particles are dimmer than the brightest.
constexpr double least_peak_snr = 10;

/// Returns the ratio of a pixel's charge from light to its shot, dark and read noise.
/// @param peak_e  charge from light [e]
double peak_snr(CameraSetup const& camera, double peak_e) {
  NoiseSetup const& noise = camera.noise;
  double const charge_e = peak_e + noise.dark_current_e + camera.background.level_e;
  return peak_e / std::hypot(noise.shot_noise ? std::sqrt(charge_e) : 0.0, noise.read_noise_e);
}

}  // namespace

void warn_of_exposure(Warnings& warnings, Scene const& scene, double exposure_e, double brightest) {
  if (!scene.setup.experiment().sources.in_photons) return;
  CameraSetup const& camera = scene.setup.camera;
  double const photons = scene.photon_unit, limit_e = photon_limited_exposure(scene);
  std::string const cure =
      "increase laser.pulse_energy_mj, reduce lens.f_number, or use larger particles (particles.diameter_um)";
  if (!(brightest > 0) || photons < 1) {
    warn(
        warnings,
        {WarningCode::exposure, "particles",
         fmt::format(
             "the brightest one sends {:.2g} photons per pulse through the lens, {}; {}", brightest > 0 ? photons : 0.0,
             camera.noise.enabled
                 ? "too few for any sensor"
                 : "too few for any sensor (the images do not show it, since they have no noise; add [camera.noise])",
             cure)});
  } else if (camera.absolute_exposure) {
    double const peak_e = exposure_e * brightest, snr = peak_snr(camera, peak_e);
    if (!camera.noise.enabled || snr >= least_peak_snr) return;
    warn(warnings,
         {WarningCode::exposure, "camera.exposure",
          fmt::format(
              "\"absolute\": the brightest particle sends {:.3g} photons through the lens, and the brightest pixel "
              "collects {:.3g} electrons, {:.2g} times its noise (below {:g} most particles are lost in noise); {}",
              photons, peak_e, snr, least_peak_snr, cure)});
  } else if (camera.exposure_e && exposure_e > limit_e * (1 + 1e-9)) {
    warn(warnings, {WarningCode::exposure, "camera.exposure",
                    fmt::format("the brightest particle sends {:.3g} photons through the lens, which release {:.3g} "
                                "electrons at a quantum efficiency of {:.3g}, not {:.6g}: the images have less noise "
                                "than such light; set camera.exposure = \"auto\" or \"absolute\", or {}",
                                photons, limit_e, camera.noise.quantum_efficiency, exposure_e, cure)});
  } else if (double const wanted = Detector::auto_exposure(camera, brightest); !camera.exposure_e && wanted > limit_e) {
    double const full_scale = std::pow(2.0, camera.bit_depth) - 1;
    warn(warnings,
         {WarningCode::exposure, "camera.exposure",
          fmt::format("\"auto\" is limited by the light: the brightest particle sends {:.3g} photons through the lens, "
                      "which release {:.3g} electrons at a quantum efficiency of {:.3g}, and its pixel reaches {:.2g} "
                      "% of full scale instead of 90 %. For 90 %, {:.3g} times as much light is required: {}, or "
                      "reduce camera.noise.full_well_e",
                      photons, limit_e, camera.noise.quantum_efficiency,
                      100 * Detector(camera, limit_e).ideal_level(brightest) / full_scale, wanted / limit_e, cure)});
  }
}

RenderedOutcome warn_of_rendering(Warnings& warnings, PreparedCase const& prepared, RenderedCase const& rendered,
                                  RecordedFrames const& frames) {
  Setup const& setup = prepared.scene.setup;
  Rendering const& rendering = *rendered.rendering;
  warn_of_saturation(warnings, setup.camera, frames.saturated_reference, frames.saturated_flow,
                     rendered.exposure_e * rendering.in_place->brightest());
  warn_of_exposure(warnings, prepared.scene, rendered.exposure_e, rendering.in_place->brightest());
  RenderedOutcome outcome;
  outcome.unseen = warn_of_unseen(warnings, prepared.scene, rendering);
  outcome.accuracy = truth_accuracy(rendering.truth, truth_tolerance_px);
  warn_of_ray_limit(warnings, prepared, rendering);
  outcome.side_faces = side_face_accuracy(prepared.scene, rendering);
  if (outcome.side_faces) warn_of_side_faces(warnings, prepared.scene, *outcome.side_faces);
  // If all dots above the goal are traced by rays, the warning of dots at side faces suffices
  bool const only_by_rays = outcome.side_faces && outcome.side_faces->truth_error_px > truth_tolerance_px &&
                            outcome.accuracy.above == outcome.accuracy.above_by_rays;
  if (!only_by_rays) warn_of_truth(warnings, rendering, outcome.accuracy, setup.experiment().sources.many);
  return outcome;
}

}  // namespace gladstone::inline cases
