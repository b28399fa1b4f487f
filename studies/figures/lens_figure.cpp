#include "studies/figures/lens_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/not_a_number.h"
#include "render/base/units.h"
#include "render/optics/apparent_pupil.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;

constexpr int lens_figure_width = 1200, layout_height = 460, plots_height = 330, title_height = 40;

/// Polylines as two columns, separated by NaN.
struct RayLines {
  std::vector<double> x, y;
  void add(Vec3d p) {
    x.push_back(p.z / unit::millimetre);
    y.push_back(p.y / unit::millimetre);
  }
  void end() {
    x.push_back(not_a_number);
    y.push_back(not_a_number);
  }
};

/// Returns the half height with which each surface is drawn: the radius of the stop, the edge of a surface, or else the
/// larger of its nominal semi-diameter and 1.05 times the height of the rays.
std::vector<double> drawn_heights(Lens const& lens, std::vector<std::vector<Vec3d>> const& rays) {
  std::vector<double> heights;
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    double height = lens.prescription.surfaces[i].semi_diameter;
    if (static_cast<int>(i) == lens.stop) {
      height = lens.stop_radius;
    } else if (!lens.prescription.surfaces[i].semi_diameter_vignettes || !std::isfinite(height)) {
      if (!std::isfinite(height)) height = 0;
      for (auto const& ray : rays) {
        if (i + 1 < ray.size()) height = std::max(height, 1.05 * std::abs(lens.poses[i].point_to_local(ray[i + 1]).y));
      }
    }
    heights.push_back(height);
  }
  return heights;
}

/// Returns one half of a surface's outline, from the axis or the edge of its obscuration to a height; curved up to its
/// own edge, flat beyond, as ground lenses are.
/// @param side  1: above the axis, -1: below
std::vector<Vec3d> half_outline(Lens const& lens, std::size_t i, double own_height, double height, double side) {
  std::vector<Vec3d> points;
  double const inner = lens.prescription.surfaces[i].obscured;
  double last = 0;
  for (int k = 0; k <= 40; ++k) {
    double const y = side * (inner + (own_height - inner) * k / 40);
    double const sag = lens.surfaces[i].visit([y](auto const& surface) { return surface.shape.sag(0.0, y); });
    if (!std::isfinite(sag)) break;
    last = sag;
    points.push_back(lens.poses[i].point_to_outer({0, y, sag}));
  }
  if (height > own_height) points.push_back(lens.poses[i].point_to_outer({0, side * height, last}));
  return points;
}

bool is_glass_behind(Lens const& lens, std::size_t i) {
  auto const& after = lens.prescription.surfaces[i].after;
  return !after.is_air() && !after.is_mirror();
}

/// Outlines of a lens without its rays.
struct LensDrawing {
  RayLines glass, mirrors, planes, stop;
};

LensDrawing drawing_of(Lens const& lens, std::vector<double> const& heights) {
  LensDrawing drawing;
  std::size_t const count = lens.surfaces.size();
  // cemented elements have the same height
  std::vector<double> widths = heights;
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t end = i;
    while (end + 1 < count && is_glass_behind(lens, end)) ++end;
    double widest = 0;
    for (std::size_t k = i; k <= end; ++k) widest = std::max(widest, heights[k]);
    for (std::size_t k = i; k <= end; ++k) widths[k] = widest;
    i = end;
  }
  for (std::size_t i = 0; i < count; ++i) {
    bool const mirror = lens.prescription.surfaces[i].after.is_mirror();
    bool const refracts = is_glass_behind(lens, i) || (i > 0 && is_glass_behind(lens, i - 1));
    if (static_cast<int>(i) == lens.stop) {
      for (double const side : {-1.0, 1.0}) {
        double const sag = lens.surfaces[i].visit([&](auto const& s) { return s.shape.sag(0.0, lens.stop_radius); });
        double const z = std::isfinite(sag) ? sag : 0;
        drawing.stop.add(lens.poses[i].point_to_outer({0, side * lens.stop_radius, z}));
        drawing.stop.add(lens.poses[i].point_to_outer({0, side * std::max(1.3 * lens.stop_radius, widths[i]), z}));
        drawing.stop.end();
      }
      if (!refracts && !mirror) continue;
    }
    RayLines& lines = mirror ? drawing.mirrors : refracts ? drawing.glass : drawing.planes;
    for (double const side : {-1.0, 1.0}) {
      std::vector<Vec3d> const half = half_outline(lens, i, heights[i], widths[i], side);
      for (Vec3d const p : half) lines.add(p);
      if (is_glass_behind(lens, i) && i + 1 < count && !half.empty()) {  // along the cylindrical edge to the other face
        auto const other = half_outline(lens, i + 1, heights[i + 1], widths[i + 1], side);
        if (!other.empty()) lines.add(other.back());
      }
      lines.end();
    }
  }
  return drawing;
}

/// Traces rays of a field point over the height of the stop, starting at the object or slightly in front of the lens.
std::vector<std::vector<Vec3d>> drawn_rays(Lens const& lens, ParaxialLens const& paraxial, FieldAnalysis const& field,
                                           double angle, double total) {
  std::vector<std::vector<Vec3d>> rays;
  RayOrigin const origin = field_origin(lens, paraxial, angle);
  auto const disc = find_apparent_pupil(lens, origin);
  if (!disc) return rays;
  double foremost = 0;  // foremost vertex: behind a mirror, surfaces may be in front of the first one
  for (Pose<double> const& pose : lens.poses) foremost = std::min(foremost, pose.origin.z);
  double const begin = std::max(foremost - 0.25 * total, origin.at_infinity ? -HUGE_VAL : origin.place.z);
  for (double const y : {-0.99, -0.5, 0.0, 0.5, 0.99}) {
    double const across = std::hypot(disc->a.y, disc->b.y);
    Ray<double> ray = origin.ray_through(disc->at(across > 0 ? y * Vec2d{disc->a.y, disc->b.y} / across : Vec2d{0, y}));
    ray.position = ray.position + (begin - ray.position.z) / ray.direction.z * ray.direction;
    std::vector<Vec3d> const way = follow_ray(lens, ray, field.image_plane);
    if (way.size() > 2 || lens.surfaces.size() == 1) rays.push_back(way);  // skip rays that miss the first surface
  }
  return rays;
}

/// Returns the side view of the lens with its rays, with equal scales in a box.
Panel make_side_view(Lens const& lens, ParaxialLens const& paraxial, FieldAnalysis const& field, Box const& box) {
  Panel panel{.box = box, .x = {"z [mm]"}, .y = {"y [mm]"}, .equal_scales = true};
  auto const add = [&panel](RayLines const& lines, std::string const& colour, double width, Dash dash = Dash::solid) {
    panel.layers.push_back({Layer::Kind::line, {lines.x, lines.y}, colour, "", width, dash});
  };
  std::vector<std::vector<Vec3d>> rays;
  double total = std::abs(lens.poses.back().origin.z + field.image_plane) + 1e-3;
  for (Pose<double> const& pose : lens.poses) total = std::max(total, std::abs(pose.origin.z));
  for (std::size_t i = 0; i < field.points.size(); ++i) {
    RayLines lines;
    for (auto const& ray : drawn_rays(lens, paraxial, field, field.points[i].angle, total)) {
      rays.push_back(ray);
      for (Vec3d const p : ray) lines.add(p);
      lines.end();
    }
    add(lines, house_colour(i), 1);
  }
  LensDrawing const drawing = drawing_of(lens, drawn_heights(lens, rays));
  RayLines image;
  double tallest = 1e-4;
  for (FieldPoint const& point : field.points) tallest = std::max(tallest, 1.1 * std::abs(point.chief.y));
  Pose<double> const plane = lens.poses.back().moved({0, 0, field.image_plane});
  image.add(plane.point_to_outer({0, -tallest, 0}));
  image.add(plane.point_to_outer({0, tallest, 0}));
  add(drawing.glass, "#202020", 2);
  add(drawing.mirrors, "#607890", 4);
  add(drawing.planes, "#909090", 1, Dash::dashed);
  add(drawing.stop, "#202020", 4);
  add(image, "#808080", 2);
  return panel;
}

Panel make_spots(FieldAnalysis const& field, Box const& box) {
  double reach = 1e-9;
  for (FieldPoint const& point : field.points) {
    for (Vec2d const p : point.spot)
      reach = std::max({reach, std::abs(p.x - point.centroid.x), std::abs(p.y - point.centroid.y)});
  }
  double const apart = 2.4 * reach * 1e6;
  // The panel has the proportions of its axes, so that labels are placed above the spots.
  auto const count = static_cast<double>(field.points.size());
  double const side = std::min((box.right - box.left) / count, box.bottom - box.top);
  double const x = (box.left + box.right) / 2, y = (box.top + box.bottom) / 2;
  Panel panel{.box = {x - count * side / 2, x + count * side / 2, y - side / 2, y + side / 2}, .equal_scales = true};
  panel.x = {"spot diagrams about their centroids [µm]", -apart / 2, apart * (count - 0.5)};
  panel.y = {.low = -apart / 2, .high = apart / 2};
  for (std::size_t i = 0; i < field.points.size(); ++i) {
    FieldPoint const& point = field.points[i];
    std::string const angle = fmt::format("{:.3g}°", point.angle / unit::degree);
    panel.labels.push_back({angle, apart * static_cast<double>(i), apart / 2});
    panel.labels.back().down_px = -10;
    panel.labels.back().colour = house_colour(i);
    Layer layer{Layer::Kind::points, {{}, {}}, house_colour(i), angle};
    layer.marker = -1;
    for (Vec2d const p : point.spot) {
      layer.columns[0].push_back((p.x - point.centroid.x) * 1e6 + apart * static_cast<double>(i));
      layer.columns[1].push_back((p.y - point.centroid.y) * 1e6);
    }
    panel.layers.push_back(std::move(layer));
  }
  return panel;
}

/// Returns quantities against the field angle, from the axis to the prescription's largest angle.
Panel make_field_curves(Box const& box, std::string const& label, FieldAnalysis const& curves,
                        std::vector<std::pair<std::string, double (*)(FieldPoint const&)>> const& values) {
  Panel panel{.box = box, .x = {"field angle [°]"}, .y = {label}, .grid = Grid::both};
  for (std::size_t i = 0; i < values.size(); ++i) {
    Layer curve{.columns = {{}, {}}, .colour = house_colour(i), .name = values.size() > 1 ? values[i].first : ""};
    for (FieldPoint const& point : curves.points) {
      curve.columns[0].push_back(point.angle / unit::degree);
      curve.columns[1].push_back(point.imaged ? values[i].second(point) : not_a_number);
    }
    panel.layers.push_back(std::move(curve));
  }
  if (values.size() > 1) panel.legend.place = LegendPlace::bottom_left;
  return panel;
}

/// Analyses the lens at many angles from the axis to its largest field angle, for curves.
FieldAnalysis between_fields(Lens const& lens, ParaxialLens const& paraxial) {
  double widest = 0;
  for (double const angle : lens.prescription.field_angles) widest = std::max(widest, std::abs(angle));
  Lens fine = lens;
  fine.prescription.field_angles.clear();
  constexpr int angles = 24;
  for (int i = 0; i <= angles; ++i) fine.prescription.field_angles.push_back(widest * i / angles);
  return analyse_field(fine, paraxial, 400);
}

}  // namespace

Figure make_lens_figure(Lens const& lens, ParaxialLens const& paraxial, FieldAnalysis const& field) {
  bool const off_axis =
      std::any_of(field.points.begin(), field.points.end(), [](auto const& p) { return p.angle != 0; });
  Figure figure{lens_figure_width, title_height + layout_height + plots_height, Figure::Kind::drawing};
  std::string const focal =
      std::isfinite(paraxial.effective_focal_length)
          ? fmt::format("f = {:.5g} mm, {}", paraxial.effective_focal_length * 1e3,
                        paraxial.telecentric ? "telecentric" : fmt::format("f/{:.3g}", paraxial.f_number))
          : std::string(paraxial.telecentric ? "afocal, telecentric" : "afocal");
  std::string const& title = lens.prescription.title;
  figure.add_title(fmt::format("{}{}{}, {:.5g} nm", title, title.empty() ? "" : ": ", focal, lens.wavelength * 1e9));
  double const end = lens_figure_width - 20, top = title_height + layout_height + 10;
  double const bottom = title_height + layout_height + plots_height - 55;
  figure.panels.push_back(make_side_view(lens, paraxial, field, {70, end, title_height + 10, top - 65}));
  figure.panels.push_back(make_spots(field, {off_axis ? 50.0 : 70.0, off_axis ? 360 : end, top, bottom}));
  if (!off_axis) return figure;
  FieldAnalysis const curves = between_fields(lens, paraxial);
  figure.panels.push_back(make_field_curves({480, 640, top, bottom}, "distortion [%]", curves,
                                            {{"", [](FieldPoint const& p) { return 100 * p.distortion; }}}));
  figure.panels.push_back(
      make_field_curves({740, 900, top, bottom}, "focus from the image plane [mm]", curves,
                        {{"tangential", [](FieldPoint const& p) { return p.tangential_focus * 1e3; }},
                         {"sagittal", [](FieldPoint const& p) { return p.sagittal_focus * 1e3; }}}));
  figure.panels.push_back(make_field_curves({1010, 1180, top, bottom}, "light that is not vignetted [%]", curves,
                                            {{"", [](FieldPoint const& p) { return 100 * (1 - p.vignetting); }}}));
  return figure;
}

}  // namespace gladstone::inline figures
