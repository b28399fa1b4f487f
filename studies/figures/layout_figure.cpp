#include "studies/figures/layout_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/base/not_a_number.h"
#include "render/base/units.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;
using unit::mm;
// sizes [px]: page, horizontal limits of the panels, height of the stretched panel, space above, between and below
constexpr int layout_width = 1200;
constexpr double left = 48, right = 1176, stretched_px = 346, above = 84, between = 60, below = 64;

/// Polylines in mm, separated by NaN.
struct Outlines {
  std::vector<double> z, y;
  void add(std::initializer_list<std::pair<double, double>> points) {
    for (auto const& [at_z, at_y] : points) {
      z.push_back(at_z / mm);
      y.push_back(at_y / mm);
    }
    z.push_back(not_a_number);
    y.push_back(not_a_number);
  }
};

struct Drawing {
  Outlines planes, medium, lens, view, cone, sheet;
};

Drawing drawing_of(OpticalLayout const& l) {
  Drawing d;
  if (l.sheet_half_height > 0) {
    double const w = l.sheet_half_thickness, height = l.sheet_half_height;
    d.sheet.add({{-w, -height}, {w, -height}, {w, height}, {-w, height}, {-w, -height}});
  } else {
    d.planes.add({{l.dots_z, -1.15 * l.dots_half}, {l.dots_z, 1.15 * l.dots_half}});
  }
  for (double const z : l.planes) d.planes.add({{z, -1.15 * l.dots_half}, {z, 1.15 * l.dots_half}});
  d.planes.add({{l.sensor_z, -l.sensor_half}, {l.sensor_z, l.sensor_half}});
  double const h = 1.1 * std::max(l.medium_half, l.cone_radius), t = l.medium_half_thickness;
  if (t > 0) d.medium.add({{-t, -h}, {t, -h}, {t, h}, {-t, h}, {-t, -h}});
  double const rim = 1.35 * std::max(l.pupil_radius, l.sensor_half), tip = 0.012 * (l.sensor_z - l.dots_z);
  for (double const side : {-1.0, 1.0}) {
    d.lens.add({{l.lens_z, side * l.pupil_radius}, {l.lens_z, side * rim}});
    d.lens.add({{l.lens_z - tip / 2, side * rim}, {l.lens_z + tip / 2, side * rim}});
    d.view.add({{l.dots_z, side * l.dots_half}, {l.lens_z, 0}, {l.sensor_z, -side * l.sensor_half}});
    d.cone.add({{l.dots_z, 0}, {l.lens_z, side * l.pupil_radius}, {l.sensor_z, 0}});
  }
  return d;
}

std::vector<Layer> make_layers(Drawing const& d) {
  std::vector<Layer> layers;
  auto const add = [&layers](Outlines const& lines, std::string const& colour, double width, char const* name) {
    if (!lines.z.empty()) layers.push_back({Layer::Kind::line, {lines.z, lines.y}, colour, name, width});
  };
  bool const dots = d.sheet.z.empty();
  add(d.view, house_colour(5), 1, "field of view");
  add(d.cone, house_colour(1), 2, dots ? "light of the dot on the axis" : "light of a particle");
  add(d.medium, house_colour(2), 2, "medium");
  add(d.lens, house_colour(0), 3, "stop");
  add(d.planes, "#202020", 3, dots ? "dots and sensor" : "sensor");
  add(d.sheet, house_colour(3), 2, "laser sheet");
  return layers;
}

/// Labels of a layout.
struct LayoutWords {
  std::string title;
  std::string seen;    ///< field of view in the plane of the dots or of the sheet
  std::string medium;  ///< name of the medium; empty: no label
};

/// Panel with stretched heights, to which distances and names are added.
class StretchedPanel {
 public:
  /// @param tallest  half height of the tallest part [m]
  StretchedPanel(Panel panel, double tallest) : panel_(std::move(panel)) {
    panel_.x.label = "Z [mm]";
    panel_.x.marks = Axis::Marks::texts;
    panel_.y.low = -1.6 * tallest / mm;
    panel_.y.high = 1.35 * tallest / mm;
    panel_.border = Border::bottom;
  }

  /// Adds a name. @param at  height in the panel, 0 at the lower edge
  void add_name(std::string name, double z, double at, Align align = Align::centre) {
    panel_.labels.push_back({std::move(name), z / mm, height(at), TextRole::label, align});
    panel_.labels.back().boxed = true;
  }

  /// Adds an arrow between two positions, labelled with its name if there is one.
  void add_distance(double from, double to, double at, std::string const& name) {
    panel_.layers.push_back(
        {Layer::Kind::spans, {{from / mm}, {height(at)}, {(to - from) / mm}, {0}}, "#606060", "", 1});
    if (!name.empty()) add_name(fmt::format("{} = {:.5g} mm", name, (to - from) / mm), 0.5 * (from + to), at);
  }

  Panel panel() && { return std::move(panel_); }

 private:
  double height(double at) const { return panel_.y.low + at * (panel_.y.high - panel_.y.low); }
  Panel panel_;
};

Figure make_layout(OpticalLayout const& l, LayoutWords const& words) {
  bool const dots = l.sheet_half_height == 0;
  double const length = l.sensor_z - l.dots_z, z_high = l.sensor_z + 0.06 * length;
  double lowest = std::min(l.dots_z, -l.medium_half_thickness);
  for (double const z : l.planes) lowest = std::min(lowest, z);
  double const z_low = lowest - 0.06 * length;
  double const tallest =
      1.3 * std::max({l.dots_half, l.medium_half, l.pupil_radius, l.sensor_half, l.sheet_half_height});
  double const mm_a_px = (z_high - z_low) / mm / (right - left);
  double const to_scale_px = std::max(40.0, 2 * tallest / mm / mm_a_px);  // height of the panel to scale
  double const stretched = mm_a_px * stretched_px / (2.95 * tallest / mm);

  Panel scaled{.box = {left, right, above, above + to_scale_px}, .layers = make_layers(drawing_of(l))};
  scaled.x = {.low = z_low / mm, .high = z_high / mm, .marks = Axis::Marks::none};
  scaled.y = {.low = -to_scale_px * mm_a_px / 2, .high = to_scale_px * mm_a_px / 2, .marks = Axis::Marks::none};
  scaled.border = Border::none;
  double const top = scaled.box.bottom + between;
  Figure figure{layout_width, static_cast<int>(std::ceil(top + stretched_px + below)), Figure::Kind::drawing};
  figure.add_title(words.title);
  figure.labels.push_back({"to scale", left, above - 16, TextRole::note, Align::left});
  figure.labels.push_back(
      {fmt::format("heights times {:.2g}", stretched), left, top - 24, TextRole::note, Align::left});

  Panel lower = scaled;
  lower.box = {left, right, top, top + stretched_px};
  lower.legend = {LegendPlace::above_right, top - 40, true};
  StretchedPanel panel(std::move(lower), tallest);
  panel.add_distance(0, l.lens_z, 0.14, "Z_A");
  if (dots && l.dots_z < 0) {
    panel.add_distance(l.dots_z, 0, 0.14, "Z_D");
    panel.add_distance(l.dots_z, l.lens_z, 0.06, "Z_B");
  }
  // the arrow of the image distance is too short for its label, which is between the lines of Z_A and Z_B
  panel.add_distance(l.lens_z, l.sensor_z, 0.14, "");
  panel.add_name(fmt::format("z_i = {:.5g} mm", (l.sensor_z - l.lens_z) / mm), z_high, 0.10, Align::right);
  panel.add_name(words.seen, l.dots_z + (dots ? 0.03 : 0.08) * length, dots ? 0.95 : 0.82);
  if (!words.medium.empty()) panel.add_name(words.medium, dots ? 0 : 0.08 * length, 0.89);
  // place the label next to the stop, whose bars reach up to the label if the pupil is the tallest part
  panel.add_name(fmt::format("pupil {:.4g} mm", 2 * l.pupil_radius / mm), l.lens_z - 0.02 * length, 0.83, Align::right);
  panel.add_name(fmt::format("sensor {:.4g} mm", 2 * l.sensor_half / mm), l.sensor_z, 0.20);
  figure.panels = {std::move(scaled), std::move(panel).panel()};
  return figure;
}

}  // namespace

OpticalLayout make_optical_layout(DesignPoint<double> const& b) {
  double const half = b.given->camera.rows / 2.0;
  return {-b.z_d,
          b.z_a,
          b.z_a + b.image_distance(),
          b.given->thickness / 2,
          b.pupil() / 2,
          half * b.given->camera.pixel_pitch,
          half * b.pixel_at_medium(),
          half * b.pixel_at_dots(),
          b.cone_diameter() / 2};
}

Figure make_layout_figure(DesignPoint<double> const& bench) {
  OpticalLayout const l = make_optical_layout(bench);
  return make_layout(
      l, {fmt::format("Layout: f = {:.5g} mm, f/{:.4g}, M = {:.4g}", bench.focal_length / mm, bench.f_number,
                      bench.magnification()),
          fmt::format("field of view {:.4g} mm", 2 * l.dots_half / mm),
          fmt::format("medium: view {:.4g} mm, cone {:.3g} mm", 2 * l.medium_half / mm, 2 * l.cone_radius / mm)});
}

OpticalLayout make_camera_layout(Setup const& setup) {
  ImagingGeometry const imaging = setup.imaging();
  double const half = setup.camera.rows / 2.0 * setup.camera.pixel_pitch, seen = half / imaging.magnification;
  double const z_b = setup.z_b(), behind = z_b - setup.z_a;  // distance from the mid-plane to the dots on the axis
  LaserSetup const sheet = setup.piv ? setup.piv->laser : LaserSetup{.thickness = 0, .height = 0};
  bool const medium = setup.experiment().correlated && setup.medium.field.kind != FieldKind::none;
  return {.dots_z = -behind,
          .lens_z = setup.z_a,
          .sensor_z = setup.z_a + imaging.image_distance + setup.element_shift(ElementSide::sensor),
          .medium_half_thickness = medium ? setup.medium.thickness / 2 : 0,
          .pupil_radius = imaging.entrance_pupil / 2,
          .sensor_half = half,
          .medium_half = seen * setup.z_a / z_b,
          .dots_half = seen,
          .cone_radius = imaging.entrance_pupil / 2 * behind / z_b,
          .sheet_half_thickness = sheet.thickness / 2,
          .sheet_half_height = sheet.height / 2,
          .planes = setup.planes};
}

Figure make_camera_layout_figure(Setup const& setup) {
  OpticalLayout const l = make_camera_layout(setup);
  if (!std::isfinite(l.sensor_z) || !std::isfinite(l.dots_half)) {
    throw DataError(ErrorCode::unsupported, "layout",
                    "cannot be drawn (the image distance or the view of the camera is infinite); omit --figure");
  }
  return make_layout(
      l, {fmt::format("Layout along the camera's axis: f/{:.4g}, M = {:.4g}{}", setup.lens.f_number,
                      setup.imaging().magnification, l.sheet_half_thickness > 0 ? ", sheet drawn across the axis" : ""),
          fmt::format("field of view {:.4g} mm", 2 * l.dots_half / mm), ""});
}

Figure make_piv_layout_figure(Setup const& setup) {
  OpticalLayout const l = make_camera_layout(setup);
  LaserSetup const& laser = setup.piv->laser;
  return make_layout(l, {fmt::format("Layout: f/{:.4g}, M = {:.4g}, sheet {:.4g} mm thick", setup.lens.f_number,
                                     setup.imaging().magnification, laser.thickness / mm),
                         fmt::format("field of view {:.4g} mm", 2 * l.dots_half / mm), ""});
}

}  // namespace gladstone::inline figures
