#include "render/scene/cross_check_particles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/scene/read_setup.h"

namespace gladstone::inline scene {
namespace {

constexpr double scattering_contrast = 1e-3;  // minimum index difference; seeding particles in gas have 0.3 or more

/// Returns the distance of the volume from a sheet's middle plane at a pulse [m]; 0 if they intersect.
double sheet_beside(ParticleSetup const& particles, Pose<double> const& sheet) {
  Vec3d const half = 0.5 * *particles.volume, n = sheet.z;
  double const reach = std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z;
  return std::max(0.0, std::abs(dot(particles.center - sheet.origin, n)) - reach);
}

/// Reports a velocity file that ends inside the particles' volume. A file that cannot be read is ignored; its reader
/// reports it.
void cross_check_velocity_file(Setup const& setup, SetupTable flow) {
  ParticleSetup const& particles = setup.piv->particles;
  if (!particles.volume) return;
  try {
    RegularGrid const grid = velocity_grid(*setup.piv->flow.file);
    double const mm = unit::millimetre;
    for (int axis = 0; axis < 3; ++axis) {
      auto const a = static_cast<std::size_t>(axis);
      if (grid.periodic[a] || (axis == 2 && grid.nodes[2] == 1)) continue;
      double const low = grid.origin[axis], high = low + grid.spacing[axis] * (grid.nodes[a] - 1);
      double const half = (*particles.volume)[axis] / 2, middle = particles.center[axis];
      double const rounding = 1e-9 * (high - low);
      if (middle - half >= low - rounding && middle + half <= high + rounding) continue;
      flow.problem(
          "file",
          fmt::format(
              "contains a velocity field from {} = {:.6g} to {:.6g} mm, which ends inside the particles' volume, "
              "{:.6g} to {:.6g} mm; make particles.volume_mm smaller, or check flow.spacing_mm, center_mm and periodic",
              "XYZ"[axis], low / mm, high / mm, (middle - half) / mm, (middle + half) / mm));
    }
  } catch (DataError const&) {
  }
}

}  // namespace

void cross_check_particles(Setup const& setup, SetupTable root, Warnings& warnings) {
  PivSetup const& piv = *setup.piv;
  SetupTable particles = root.table("particles"), laser = root.table("laser");
  double const mm = unit::millimetre;
  if (piv.particles.scattering == ParticleScattering::mie &&
      std::abs(piv.particles.index - setup.ambient_index()) < scattering_contrast) {
    particles.problem(particles.has("material") ? "material" : "index",
                      fmt::format("differs by less than {:g} from that of the surroundings, {:.6g} (such particles "
                                  "scatter hardly any light); use another material",
                                  scattering_contrast, setup.ambient_index()));
  }
  if (std::abs(piv.laser.wavelength - setup.medium.wavelength) > 1e-6 * setup.medium.wavelength) {
    laser.problem("wavelength_nm",
                  fmt::format("is not medium.wavelength_nm = {:.6g} (the camera sees the laser's light, which "
                              "determines n and the point spread function); give both the same value",
                              setup.medium.wavelength / unit::nanometre));
  }
  if (piv.particles.volume) {
    LaserSheet<double> const sheet = laser_sheet(piv.laser);
    double const reach = (piv.laser.profile == SheetProfile::gaussian ? 1.5 : 0.5) * piv.laser.thickness;
    for (int pulse = 0; pulse < 2; ++pulse) {
      double const beside = sheet_beside(piv.particles, sheet.pose[pulse]);
      if (beside <= reach) continue;
      laser.problem(
          "offset_mm",
          fmt::format(
              "puts the sheet of pulse {} outside the particles' volume ({:.4g} mm away, so that no particle is "
              "illuminated); move laser.offset_mm, laser.center_mm, particles.center_mm or thicken particles.volume_mm",
              pulse + 1, beside / mm));
      break;
    }
    Vec3d const far = piv.particles.center + 0.5 * *piv.particles.volume;
    if (!(setup.camera_pose().origin.z > far.z)) {
      particles.problem("volume_mm", "reaches to the lens or beyond it; make it thinner, or move the camera away");
    }
  }
  if (piv.flow.file) cross_check_velocity_file(setup, root.table("flow"));
  for (std::size_t i = 0; i < setup.elements.size(); ++i) {
    OpticalElement const& element = setup.elements[i];
    double const z = element.pose().origin.z, face = z - element.thickness() / 2;
    if (element.side() == ElementSide::target) {
      element_tables(root)[i].table.problem(
          "side",
          "is \"target\", behind the particles, so that their light does not pass it on the way to the camera; use "
          "\"camera\", or remove the element");
    } else if (element.side() == ElementSide::camera && piv.particles.volume &&
               face < piv.particles.center.z + piv.particles.volume->z / 2) {
      element_tables(root)[i].table.problem("position_mm",
                                            fmt::format("puts the element at Z = {:.6g} mm, inside the particles' "
                                                        "volume or behind it; move the element or the volume",
                                                        z / mm));
    }
  }
  if (setup.camera.absolute_exposure && !setup.camera.noise.enabled) {
    warnings.push_back({WarningCode::assumed, "camera.exposure",
                        fmt::format("\"absolute\" uses the default quantum efficiency of {:.3g} and full well of "
                                    "{:.6g}, since there is no table [camera.noise]",
                                    setup.camera.noise.quantum_efficiency, setup.camera.noise.full_well_e)});
  }
}

}  // namespace gladstone::inline scene
