#include "studies/figures/layout_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/base/not_a_number.h"
#include "render/base/units.h"
#include "studies/figures/gnuplot.h"

namespace gladstone {
namespace {

using unit::mm;
constexpr int layout_width = 1200;
constexpr double left = 0.04, right = 0.98;  // horizontal limits of the panels, relative to the figure
// heights from below [px]: bottom and top of the stretched panel, gap between the panels, space above
constexpr int stretched_bottom = 64, stretched_top = 410, between = 50, above = 84;

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

/// Sets the vertical limits of a panel [px].
void set_heights(GnuplotFigure& plot, double low, double high) {
  plot.set_margins(left * layout_width, right * layout_width, plot.height_px() - high, plot.height_px() - low);
}

void arrow(GnuplotFigure& plot, double from, double to, double at) {
  plot.command(
      fmt::format("set arrow from first {:.6g},graph {:.3f} to first {:.6g},graph {:.3f} heads size screen 0.006,20 "
                  "linecolor '#606060'",
                  from / mm, at, to / mm, at));
}

void distance(GnuplotFigure& plot, double from, double to, double at, std::string const& name) {
  arrow(plot, from, to, at);
  plot.command(fmt::format("set label {} at first {:.6g},graph {:.3f} center front boxed textcolor '#202020'",
                           GnuplotFigure::quoted(fmt::format("{} = {:.5g} mm", name, (to - from) / mm)),
                           0.5 * (from + to) / mm, at));
}

/// @param alignment  of the text at z: "center" or "right"
void name_part(GnuplotFigure& plot, std::string const& name, double z, double at,
               std::string_view alignment = "center") {
  plot.command(fmt::format("set label {} at first {:.6g},graph {:.3f} {} front boxed textcolor '#202020'",
                           GnuplotFigure::quoted(name), z / mm, at, alignment));
}

void draw(GnuplotFigure& plot, Drawing const& d) {
  bool const dots = d.sheet.z.empty();
  auto const lines = [&plot](Outlines const& l, std::string_view colour, int thickness, std::string const& title) {
    return fmt::format("{} using 1:2 with lines linewidth {} linecolor '{}' {}", plot.add_table({l.z, l.y}), thickness,
                       colour, title.empty() ? "notitle" : "title " + GnuplotFigure::quoted(title));
  };
  std::string command =
      "plot " + lines(d.view, house_colour(5), 1, "field of view") + ", " +
      lines(d.cone, house_colour(1), 2, dots ? "light of the dot on the axis" : "light of a particle") + ", " +
      (d.medium.z.empty() ? "" : lines(d.medium, house_colour(2), 2, "medium") + ", ") +
      lines(d.lens, house_colour(0), 3, "stop") + ", " +
      lines(d.planes, "#202020", 3, dots ? "dots and sensor" : "sensor");
  if (!dots) command += ", " + lines(d.sheet, house_colour(3), 2, "laser sheet");
  plot.command(command);
}

/// Labels of a layout.
struct LayoutWords {
  std::string title;
  std::string seen;    ///< in the plane of the dots or of the sheet
  std::string medium;  ///< empty: no label
};

void write_layout(std::string const& path, OpticalLayout const& l, LayoutWords const& words) {
  Drawing const drawing = drawing_of(l);
  bool const dots = l.sheet_half_height == 0;
  double const length = l.sensor_z - l.dots_z, z_high = l.sensor_z + 0.06 * length;
  double lowest = std::min(l.dots_z, -l.medium_half_thickness);
  for (double const z : l.planes) lowest = std::min(lowest, z);
  double const z_low = lowest - 0.06 * length;
  double const tallest =
      1.3 * std::max({l.dots_half, l.medium_half, l.pupil_radius, l.sensor_half, l.sheet_half_height});
  double const mm_a_px = (z_high - z_low) / mm / ((right - left) * layout_width);
  double const to_scale_px = std::max(40.0, 2 * tallest / mm / mm_a_px);  // height of the panel to scale
  GnuplotFigure plot(layout_width, stretched_top + between + static_cast<int>(std::ceil(to_scale_px)) + above);
  plot.command("set style textbox opaque noborder margins 0.4,0.2");
  plot.command("set multiplot");
  plot.command(fmt::format("set label 1 {} at screen 0.5,0.965 center font 'DejaVu Sans,14' textcolor '#101010'",
                           GnuplotFigure::quoted(words.title)));
  plot.command("unset border; unset ytics; unset key; set format x ''; set xtics scale 0");
  plot.command(fmt::format("set xrange [{:.6g}:{:.6g}]", z_low / mm, z_high / mm));
  plot.command(fmt::format("set yrange [{:.6g}:{:.6g}]", -to_scale_px * mm_a_px / 2, to_scale_px * mm_a_px / 2));
  set_heights(plot, stretched_top + between, stretched_top + between + to_scale_px);
  plot.command("set label 2 'to scale' at graph 0,1.06 left textcolor '#606060'");
  draw(plot, drawing);
  plot.command("unset label 1; unset label 2");
  plot.command("set border 1; set format x '%g'; set xtics scale 0.5; set xlabel 'Z [mm]' offset 0,0.5");
  plot.command(fmt::format("set yrange [{:.6g}:{:.6g}]", -1.6 * tallest / mm, 1.35 * tallest / mm));
  set_heights(plot, stretched_bottom, stretched_top);
  double const stretched = mm_a_px * (stretched_top - stretched_bottom) / (2.95 * tallest / mm);
  plot.command(fmt::format("set label 3 {} at graph 0,1.01 left textcolor '#606060'",
                           GnuplotFigure::quoted(fmt::format("heights times {:.2g}", stretched))));
  plot.command("set key at graph 0.995,1.06 right top horizontal samplen 2");
  distance(plot, 0, l.lens_z, 0.14, "Z_A");
  if (dots && l.dots_z < 0) {
    distance(plot, l.dots_z, 0, 0.14, "Z_D");
    distance(plot, l.dots_z, l.lens_z, 0.06, "Z_B");
  }
  // the arrow of the image distance is too short for its label, which is between the lines of Z_A and Z_B
  arrow(plot, l.lens_z, l.sensor_z, 0.14);
  plot.command(fmt::format("set label {} at graph 1,0.10 right front textcolor '#202020'",
                           GnuplotFigure::quoted(fmt::format("z_i = {:.5g} mm", (l.sensor_z - l.lens_z) / mm))));
  name_part(plot, words.seen, l.dots_z + (dots ? 0.03 : 0.08) * length, dots ? 0.95 : 0.82);
  if (!words.medium.empty()) name_part(plot, words.medium, dots ? 0 : 0.08 * length, 0.89);
  // beside the stop, whose bars reach up to the label's height if the pupil is the tallest part
  name_part(plot, fmt::format("pupil {:.4g} mm", 2 * l.pupil_radius / mm), l.lens_z - 0.02 * length, 0.83, "right");
  name_part(plot, fmt::format("sensor {:.4g} mm", 2 * l.sensor_half / mm), l.sensor_z, 0.20);
  draw(plot, drawing);
  plot.command("unset multiplot");
  plot.write(path);
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

void write_layout_figure(std::string const& path, DesignPoint<double> const& bench) {
  OpticalLayout const l = make_optical_layout(bench);
  write_layout(path, l,
               {fmt::format("Layout: f = {:.5g} mm, f/{:.4g}, M = {:.4g}", bench.focal_length / mm, bench.f_number,
                            bench.magnification()),
                fmt::format("sees {:.4g} mm", 2 * l.dots_half / mm),
                fmt::format("medium: view {:.4g} mm, cone {:.3g} mm", 2 * l.medium_half / mm, 2 * l.cone_radius / mm)});
}

OpticalLayout make_camera_layout(Setup const& setup) {
  ImagingGeometry const imaging = setup.imaging();
  double const half = setup.camera.rows / 2.0 * setup.camera.pixel_pitch, seen = half / imaging.magnification;
  double const z_b = setup.z_b(), behind = z_b - setup.z_a;  // distance from the mid-plane to the dots on the axis
  return {.dots_z = -behind,
          .lens_z = setup.z_a,
          .sensor_z = setup.z_a + imaging.image_distance + setup.element_shift(ElementSide::sensor),
          .medium_half_thickness = setup.planes.empty() ? setup.medium.thickness / 2 : 0,
          .pupil_radius = imaging.entrance_pupil / 2,
          .sensor_half = half,
          .medium_half = seen * setup.z_a / z_b,
          .dots_half = seen,
          .cone_radius = imaging.entrance_pupil / 2 * behind / z_b,
          .planes = setup.planes};
}

void write_camera_layout(std::string const& path, Setup const& setup) {
  OpticalLayout const l = make_camera_layout(setup);
  if (!std::isfinite(l.sensor_z) || !std::isfinite(l.dots_half)) {
    throw DataError(ErrorCode::unsupported, path,
                    "cannot be drawn (the image distance or the view of the camera is infinite); omit --figure");
  }
  write_layout(path, l,
               {fmt::format("Layout along the camera's axis: f/{:.4g}, M = {:.4g}", setup.lens.f_number,
                            setup.imaging().magnification),
                fmt::format("sees {:.4g} mm", 2 * l.dots_half / mm), ""});
}

OpticalLayout piv_layout(Setup const& setup) {
  ImagingGeometry const imaging = setup.imaging();
  double const half = setup.camera.rows / 2.0 * setup.camera.pixel_pitch, seen = half / imaging.magnification;
  return {0,
          setup.z_a,
          setup.z_a + imaging.image_distance,
          setup.medium.thickness / 2,
          imaging.entrance_pupil / 2,
          half,
          seen,
          seen,
          0,
          setup.piv->laser.thickness / 2,
          setup.piv->laser.height / 2};
}

void write_piv_layout(std::string const& path, Setup const& setup) {
  OpticalLayout const l = piv_layout(setup);
  LaserSetup const& laser = setup.piv->laser;
  write_layout(path, l,
               {fmt::format("Layout: f/{:.4g}, M = {:.4g}, sheet {:.4g} mm thick", setup.lens.f_number,
                            setup.imaging().magnification, laser.thickness / mm),
                fmt::format("sees {:.4g} mm", 2 * l.dots_half / mm), ""});
}

}  // namespace gladstone
