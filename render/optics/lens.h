#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/optics/glass_catalogue.h"
#include "render/optics/lens_surface.h"
#include "render/optics/prescription.h"

namespace gladstone::inline optics {

/// View of the surfaces of a lens, in the order of the light path; owns no memory.
template <class T>
struct LensView {
  LensSurface<T> const* surfaces = nullptr;
  int count = 0;

  /// Traces a ray through surfaces [first, last). Vignetted rays are traced further.
  /// @param failed_at  surface that ended the ray, else the first one that vignetted it; `last` if there is none
  GLADSTONE_HD RayStatus carry(Ray<T>& ray, RayAccount<T>& account, int first, int last, int& failed_at) const {
    RayStatus status = RayStatus::alive;
    failed_at = last;
    for (int i = first; i < last; ++i) {
      RayStatus const here = surfaces[i].visit([&](auto const& surface) { return surface.interact(ray, account); });
      if (here == RayStatus::alive) continue;
      if (status == RayStatus::alive) failed_at = i;
      status = here;
      if (here != RayStatus::vignetted) {
        failed_at = i;
        return here;
      }
    }
    return status;
  }
  GLADSTONE_HD RayStatus carry(Ray<T>& ray, RayAccount<T>& account) const {
    int ignored;
    return carry(ray, account, 0, count, ignored);
  }
};

/// Paraxial properties of one surface.
struct ParaxialSurface {
  double curvature;  ///< vertex curvature [1/m]
  double n_before;   ///< index ahead of the surface, negative for light in -z direction [1]
  double n_after;    ///< index behind the surface, with sign [1]
  double to_next;    ///< distance to the next vertex, with sign [m]
  double power = 0;  ///< power of an ideal thin lens in air [1/m]

  /// Total refractive power: n u decreases by this times the ray height [1/m].
  double total_power() const { return curvature * (n_after - n_before) + power; }
};

/// Lens at one wavelength, ready for ray tracing.
struct Lens {
  Prescription prescription;
  double wavelength = 0;  ///< [m]
  std::vector<LensSurface<double>> surfaces;
  std::vector<Pose<double>> poses;        ///< poses of the surface vertices
  std::vector<ParaxialSurface> paraxial;  ///< surfaces for paraxial tracing, without decentres and tilts
  double object_index = 1;                ///< index of the medium ahead of the first surface [1]
  int stop = 0;
  double stop_radius = 0;                ///< radius of the stop for real rays [m]
  double paraxial_stop_radius = 0;       ///< radius of the stop for paraxial pupils [m]
  std::optional<double> image_distance;  ///< distance of the image plane behind the last surface [m]; empty: not
                                         ///< prescribed
  Warnings warnings;

  LensView<double> view() const { return {surfaces.data(), static_cast<int>(surfaces.size())}; }
};

struct LensOptions {
  /// F-number that replaces the prescription's aperture: effective focal length over diameter of the entrance pupil or,
  /// for a telecentric lens, whose pupil diameter is infinite, the image-side working f-number [1].
  std::optional<double> f_number = std::nullopt;
  /// Distance from the first vertex to the plane in focus, for telecentric lenses [m]; empty: as in the prescription.
  std::optional<double> object_distance = std::nullopt;
  bool fresnel = false;     ///< true: rays lose light by Fresnel reflection at uncoated surfaces
  bool absorption = false;  ///< true: rays lose light by absorption in glass
};

/// Returns the shape of a prescribed surface.
LensShape<double> make_shape(PrescribedSurface const& surface);

/// Builds a lens from a prescription: finds the glasses, places the surfaces and sets the radius of the stop. The
/// radius is the height, in the stop, of the real axial ray through the rim of the entrance pupil, or of the paraxial
/// ray if the real ray is lost. Warns of faces that cross within the axial beam, and of an f-number that opens the stop
/// wider than the prescription.
/// @param wavelength  [m]
/// @throws DataError with the location of an unknown glass, if no light passes the stop, or if the axial ray is lost;
/// SetupError with all locations if several glasses are unknown
Lens build_lens(Prescription prescription, GlassCatalogue const& catalogue, double wavelength,
                LensOptions const& options = {});

}  // namespace gladstone::inline optics
