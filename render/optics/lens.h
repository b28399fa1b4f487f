#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/optics/glass_catalogue.h"
#include "render/optics/lens_surface.h"
#include "render/optics/prescription.h"

namespace gladstone {

/// The surfaces of a lens in the order light meets them: a view that owns nothing.
template <class T>
struct LensView {
  LensSurface<T> const* surfaces = nullptr;
  int count = 0;

  /// Carries a ray through surfaces [first, last), and on while it meets them, vignetted or not.
  /// @param failed_at surface that vignetted or ended it; `last` if none did
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

/// What bends paraxial rays at one surface.
struct ParaxialSurface {
  double curvature;  ///< of the vertex [1/m]
  double n_before;   ///< signed: negative for light that runs towards -z [1]
  double n_after;
  double to_next;    ///< [m]
  double power = 0;  ///< of an ideal thin lens, in air [1/m]

  /// n u is reduced by this times the height [1/m].
  double total_power() const { return curvature * (n_after - n_before) + power; }
};

/// A prescription made ready to trace at one wavelength.
struct Lens {
  Prescription prescription;
  double wavelength = 0;  ///< [m]
  std::vector<LensSurface<double>> surfaces;
  std::vector<Pose<double>> poses;        ///< of the surfaces' vertices
  std::vector<ParaxialSurface> paraxial;  ///< decentres and tilts left out
  double object_index = 1;                ///< of what lies ahead of the first surface [1]
  int stop = 0;
  double stop_radius = 0;                ///< that rays meet [m]
  double paraxial_stop_radius = 0;       ///< that its pupils are images of [m]
  std::optional<double> image_distance;  ///< behind the last surface; empty: the prescription does not say [m]
  std::vector<std::string> warnings;

  LensView<double> view() const { return {surfaces.data(), static_cast<int>(surfaces.size())}; }
};

struct LensOptions {
  /// Sets the stop in place of the prescription's aperture: effective focal length over the entrance pupil's diameter;
  /// of a telecentric lens, whose pupil has no width, the working f-number of the cone towards the image [1].
  std::optional<double> f_number = std::nullopt;
  /// From the first vertex to what a telecentric lens is focused on [m]; empty: as the prescription says.
  std::optional<double> object_distance = std::nullopt;
  bool fresnel = false;     ///< take reflections of bare surfaces off the light
  bool absorption = false;  ///< and what glass absorbs
};

/// Finds the glasses and places the surfaces. The stop opens as far as the aperture says: to the height of the real
/// axial ray that enters at the rim of the entrance pupil, or where that ray is lost to the paraxial one's.
/// @param wavelength [m]
/// Warns of faces that cross within the axial beam, and of an f-number that opens the stop wider than the prescription.
/// @throws DataError with the surface's place for a glass that is not known, and where nothing passes the stop;
///         SetupError with the places of all glasses where several are not
Lens build_lens(Prescription prescription, GlassCatalogue const& catalogue, double wavelength,
                LensOptions const& options = {});

}  // namespace gladstone
