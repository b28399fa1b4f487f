#include "render/scene/side_faces.h"

namespace gladstone::inline scene {
namespace {

/// Cross-section of a source's light cone normal to the axis.
struct Disc {
  Vec2d middle;
  double radius;  ///< [m]
};

/// Position of a light cone's range of one coordinate relative to the medium's range.
struct Sides {
  bool inside = true, below = true, above = true;

  void add(double middle, double radius, double low, double high) {
    inside = inside && middle - radius > low && middle + radius < high;
    below = below && middle + radius < low;
    above = above && middle - radius > high;
  }
  bool beside() const { return below || above; }
};

}  // namespace

std::vector<std::size_t> sources_at_side_faces(Scene const& scene, RenderPlan const& plan, DotPattern const& sources) {
  std::vector<std::size_t> found;
  if (std::holds_alternative<NoMedium<double>>(scene.medium.view)) return found;
  Bounds<double> const box = std::visit([](auto const& medium) { return medium.bounds(); }, scene.medium.view);
  // Enlarge the pupil by a tenth for the smoothed edge of the stop.
  double const way = scene.setup.z_b(), pupil = 1.1 * scene.imaging.entrance_pupil / 2 + plan.pupil_margin;
  for (std::size_t i = 0; i < sources.centre.size(); ++i) {
    // A cone is widest and farthest out at one of its ends.
    Sides along_x, along_y;
    for (double const z : {box.low.z, box.high.z}) {
      double const share = (z + scene.setup.z_d) / way;
      Disc const disc{(1 - share) * sources.centre[i], share * pupil + (1 - share) * sources.half_size};
      along_x.add(disc.middle.x, disc.radius, box.low.x, box.high.x);
      along_y.add(disc.middle.y, disc.radius, box.low.y, box.high.y);
    }
    bool const whole = along_x.inside && along_y.inside, none = along_x.beside() || along_y.beside();
    if (!whole && !none) found.push_back(i);
  }
  return found;
}

}  // namespace gladstone::inline scene
