#include "studies/case/calibration_truth.h"

#include <Eigen/Geometry>

#include "render/files/hdf5_axes.h"
#include "render/light/calibration_target.h"
#include "render/method.h"
#include "render/scene/calibration_planes.h"

namespace gladstone::inline cases {
namespace {

/// Writes the datasets of /pinhole.
void write_pinhole(Hdf5Writer& file, Pinhole const& pinhole, Hdf5Axes& axes) {
  axes.write_numbers("/pinhole/row", 3, "row of the matrix");
  axes.write_numbers("/pinhole/column", 3, "column of the matrix");
  axes.write_numbers("/pinhole/coefficient", 4, "k1, k2, p1, p2");
  std::vector<double> const matrix{pinhole.fx, 0, pinhole.cx, 0, pinhole.fy, pinhole.cy, 0, 0, 1};
  file.write("/pinhole/camera_matrix", std::span<double const>(matrix), {3, 3}, "px",
             "fx, 0, cx; 0, fy, cy; 0, 0, 1, as in OpenCV", "row, column");
  BrownDistortion<double> const& brown = pinhole.brown;
  std::vector<double> const distortion{brown.k1, brown.k2, brown.p1, brown.p2};
  file.write("/pinhole/distortion", std::span<double const>(distortion), {4}, "1", "k1, k2, p1, p2 as in OpenCV",
             "coefficient");
  Eigen::Matrix3d rotation;
  for (int i = 0; i < 3; ++i) {
    Vec3d const row = pinhole.rows[static_cast<std::size_t>(i)];
    rotation.row(i) << row.x, row.y, row.z;
  }
  Eigen::AngleAxisd const turn(rotation);
  Eigen::Vector3d const r = turn.angle() * turn.axis();
  Vec3d const t = pinhole.translation;
  std::vector<double> const rvec{r.x(), r.y(), r.z()}, tvec{t.x, t.y, t.z};
  file.write("/pinhole/rvec", std::span<double const>(rvec), {3}, "rad",
             "rotation R from the world to the camera (x right, y down, z into the scene), as axis times angle",
             "axis");
  file.write("/pinhole/tvec", std::span<double const>(tvec), {3}, "m", "t of R X + t", "axis");
  axes.name("/pinhole/camera_matrix", {"/pinhole/row", "/pinhole/column"});
  axes.name("/pinhole/distortion", {"/pinhole/coefficient"});
  axes.name("/pinhole/rvec", {"/coordinate"});
  axes.name("/pinhole/tvec", {"/coordinate"});
}

}  // namespace

void write_calibration_truth(std::string const& path, RenderedCalibration const& rendered, FileOrigin const& origin) {
  Hdf5Writer file(path, origin);
  std::vector<double> position, image, chief, flux, z;
  std::vector<std::int64_t> plane_of, index, rays;
  for (std::size_t p = 0; p < rendered.planes.size(); ++p) {
    RenderedPlane const& plane = rendered.planes[p];
    Lattice const lattice(plane.scene.setup.target);
    z.push_back(plane.z);
    for (std::size_t k = 0; k < plane.truth.size(); ++k) {
      Vec3d const at = plane.truth.position_m[k];
      Vec2d const seen = plane.truth.reference_px[k], middle = plane.scene.to_pixel({at.x, at.y});
      position.insert(position.end(), {at.x, at.y, at.z});
      image.insert(image.end(), {seen.x, seen.y});
      chief.insert(chief.end(), {middle.x, middle.y});
      flux.push_back(plane.truth.flux[k].x);
      rays.push_back(plane.truth.rays[k][0]);
      plane_of.push_back(static_cast<std::int64_t>(p));
      index.insert(index.end(), {lattice.column(k), lattice.row(k)});
    }
  }
  std::size_t const count = flux.size();
  Hdf5Axes axes(file);
  axes.write_numbers("/component", 2, "column, row; of the grid along X, Y");
  axes.write_numbers("/coordinate", 3, "x, y, z");
  axes.write_numbers("/dots/dot", count, "number of the dot");
  axes.write_numbers("/planes/plane", z.size(), "number of the plane");
  file.write("/dots/position_m", std::span<double const>(position), {count, 3}, "m",
             "dot centres in the world frame: X right, Y up as the camera sees them, Z towards the camera",
             "dot, (x, y, z)");
  file.write(
      "/dots/image_px", std::span<double const>(image), {count, 2}, "px",
      "radiance-weighted centroid of the dot's rays that pass the stop, on the plane of the sensor; nan: no ray passes",
      "dot, (column, row)");
  file.write("/dots/chief_px", std::span<double const>(chief), {count, 2}, "px",
             "intersection of the chief ray of the dot's centre with the plane of the sensor; nan: none",
             "dot, (column, row)");
  file.write("/dots/flux", std::span<double const>(flux), {count}, "fully lit px", "light of the dot", "dot");
  file.write("/dots/rays", std::span<std::int64_t const>(rays), {count}, "1", "rays counted", "dot");
  file.write("/dots/plane", std::span<std::int64_t const>(plane_of), {count}, "1", "plane of the dot, from 0", "dot");
  file.write("/dots/index", std::span<std::int64_t const>(index), {count, 2}, "1",
             "grid position relative to the middle of the grid, in spacings along X and Y", "dot, (x, y)");
  file.write("/planes/z_m", std::span<double const>(z), {z.size()}, "m", "Z of the planes", "plane");
  Scene const& scene = rendered.planes.front().scene;
  if (auto const pinhole = equivalent_pinhole(scene.setup, scene.camera)) write_pinhole(file, *pinhole, axes);
  axes.name("/dots/position_m", {"/dots/dot", "/coordinate"});
  for (char const* const pairs : {"/dots/image_px", "/dots/chief_px", "/dots/index"})
    axes.name(pairs, {"/dots/dot", "/component"});
  for (char const* const numbers : {"/dots/flux", "/dots/rays", "/dots/plane"}) axes.name(numbers, {"/dots/dot"});
  axes.name("/planes/z_m", {"/planes/plane"});
  axes.attach();
  file.attribute("/", "method", to_string(RenderMethod::rays));
  file.close();
}

}  // namespace gladstone::inline cases
