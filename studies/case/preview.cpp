#include "studies/case/preview.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "render/base/error.h"
#include "render/planning.h"
#include "render/render.h"
#include "render/scene/calibration_planes.h"
#include "render/scene/light_through_lens.h"

namespace gladstone::inline cases {
namespace {

/// Returns the pixel of the strongest density gradient in view.
Vec2d steepest_pixel(Scene const& scene) {
  RenderPlan plan;
  plan.step = scene.medium.coarsest_step;  // the map needs no accurate step
  constexpr int nodes_across = 64;
  CameraSetup const& camera = scene.setup.camera;
  FieldMap const map = field_in_view(scene, plan, std::max(1, std::max(camera.columns, camera.rows) / nodes_across));
  Vec2d place = 0.5 * Vec2d{camera.columns - 1.0, camera.rows - 1.0};
  double most = 0;
  for (int row = 0; row < map.density_gradient.rows(); ++row) {
    for (int column = 0; column < map.density_gradient.columns(); ++column) {
      double const here = length(map.density_gradient(column, row));
      if (!(here > most)) continue;
      most = here;
      place = map.position_px(column, row);
    }
  }
  return place;
}

/// Centres the preview at a pixel, as far as it remains within the image.
void place_preview(CasePreview& preview, CameraSetup const& camera, Vec2d middle) {
  auto const first = [](double at, int size, int of) {
    return std::clamp(static_cast<int>(std::lround(at - 0.5 * (size - 1))), 0, of - size);
  };
  preview.columns = std::min(preview_side_px, camera.columns);
  preview.rows = std::min(preview_side_px, camera.rows);
  preview.first_column = first(middle.x, preview.columns, camera.columns);
  preview.first_row = first(middle.y, preview.rows, camera.rows);
}

bool is_near(CasePreview const& preview, Vec2d pixel, double margin) {
  Vec2d const from{pixel.x - preview.first_column, pixel.y - preview.first_row};
  return from.x > -margin && from.x < preview.columns + margin && from.y > -margin && from.y < preview.rows + margin;
}

/// Removes the dots of a scene, or the light of its particles, that are not near the preview.
/// @return number of those that remain
std::size_t keep_near(Scene& scene, CasePreview const& preview) {
  double const margin = scene.setup.view_margin_px + scene.setup.defocus_diameter_px();
  return scene.setup.experiment().sources.retain(scene, [&](Vec2d pixel) { return is_near(preview, pixel, margin); });
}

/// Records the previewed part of a frame.
Image<std::uint16_t> record_part(CasePreview const& preview, Detector const& detector, Image<double> const& light,
                                 RandomStream stream) {
  Recording const recording = detector.record(light, stream);
  Image<std::uint16_t> part(preview.columns, preview.rows);
  for (int row = 0; row < preview.rows; ++row) {
    for (int column = 0; column < preview.columns; ++column) {
      part(column, row) = recording.image(preview.first_column + column, preview.first_row + row);
    }
  }
  return part;
}

/// Returns the exposure of both frames, or of the only frame of a calibration [e].
double preview_exposure(Scene const& scene, FramePair<double> const& light) {
  CameraSetup const& camera = scene.setup.camera;
  if (scene.setup.experiment().correlated) return choose_exposure(scene, HostLight(light));
  double const brightest = *std::max_element(light.reference.begin(), light.reference.end());
  return camera.exposure_e ? *camera.exposure_e : Detector::auto_exposure(camera, brightest);
}

}  // namespace

CasePreview render_preview(CaseSetup const& loaded, Renderer& renderer) {
  auto const start = std::chrono::steady_clock::now();
  bool const one_frame_per_plane = !loaded.setup.experiment().correlated;
  CasePreview preview;
  if (one_frame_per_plane) {
    auto const nearer = [](double a, double b) { return std::abs(a) < std::abs(b); };
    preview.plane_z = *std::min_element(loaded.setup.planes.begin(), loaded.setup.planes.end(), nearer);
  }
  Scene scene = build_scene(one_frame_per_plane ? plane_setup(loaded.setup, preview.plane_z) : loaded.setup);
  Setup const& setup = scene.setup;
  preview.at_gradient = setup.experiment().measures_density && setup.medium.field.kind != FieldKind::none;
  Vec2d const centre = 0.5 * Vec2d{setup.camera.columns - 1.0, setup.camera.rows - 1.0};
  place_preview(preview, setup.camera, centre);
  if (preview.at_gradient) place_preview(preview, setup.camera, steepest_pixel(scene));
  preview.sources = keep_near(scene, preview);
  if (preview.sources == 0) {
    throw DataError(ErrorCode::undetermined, "preview",
                    "contains no dot or particle (none is near this part of the image); render the "
                    "complete images, or check the target or the particles");
  }
  RenderPlan stepped = plan_step(scene);
  if (!stepped.given_rays) stepped.given_rays = preview_rays;
  RenderPlan const plan = plan_rays(scene, stepped);
  Rendering const rendering = render(scene, plan, renderer, RenderImages::yes, RenderTheory::no);
  preview.rays = plan.rays;
  preview.method = rendering.plan.method;
  Detector const detector(setup.camera, preview_exposure(scene, rendering.light));
  preview.frames.push_back(record_part(preview, detector, rendering.light.reference, RandomStream::noise_reference));
  if (!one_frame_per_plane) {
    preview.frames.push_back(record_part(preview, detector, rendering.light.flow, RandomStream::noise_flow));
  }
  preview.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return preview;
}

Image<std::uint8_t> preview_picture(CasePreview const& preview, int bit_depth) {
  constexpr int least_height = 384, gap = 4;
  int const factor = std::max(1, (least_height + preview.rows - 1) / preview.rows);
  int const width = factor * preview.columns, count = static_cast<int>(preview.frames.size());
  double const full_scale = std::pow(2.0, bit_depth) - 1;
  Image<std::uint8_t> picture(count * width + (count - 1) * gap, factor * preview.rows);
  std::fill(picture.begin(), picture.end(), std::uint8_t{255});
  for (int frame = 0; frame < count; ++frame) {
    Image<std::uint16_t> const& levels = preview.frames[static_cast<std::size_t>(frame)];
    for (int row = 0; row < picture.rows(); ++row) {
      for (int column = 0; column < width; ++column) {
        double const share = levels(column / factor, row / factor) / full_scale;
        picture(frame * (width + gap) + column, row) = static_cast<std::uint8_t>(std::lround(255 * share));
      }
    }
  }
  return picture;
}

}  // namespace gladstone::inline cases
