#pragma once

#include <memory>
#include <optional>

#include "render/base/warning.h"
#include "render/optics/lens.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline optics {

enum class Focus { target, medium, distance };
enum class SpotModel { airy, gaussian, gaussian_first_zero, seed_eq8, none };

/// Losses of light in the glass of lenses and windows.
enum class Transmittance {
  ideal,     ///< no losses
  surfaces,  ///< Fresnel reflection at uncoated surfaces
  glass,     ///< Fresnel reflection, and absorption according to the glass catalogue
};

/// Table [lens] of a setup, in SI.
struct LensSetup {
  double focal_length = 0.105;  ///< focal length [m]; infinite for afocal prescriptions
  double f_number = 11.0;  ///< f-number; infinite: chief rays only; NaN: not defined by the setup or the prescription
  Focus focus = Focus::target;
  double focus_distance = 0.0;  ///< distance from the front principal plane to the plane in focus, for Focus::distance
                                ///< [m]
  SpotModel spot = SpotModel::gaussian;
  Transmittance transmittance = Transmittance::ideal;
  std::vector<std::string> glasses;          ///< files of additional glass catalogues (AGF), also for windows
  std::string file;                          ///< file of a prescription; empty: ideal thin lens
  std::shared_ptr<Lens const> prescription;  ///< lens at the setup's wavelength; null: ideal thin lens
};

/// Reads table [lens]. The prescription itself is read later, by build_prescription().
/// @param focus_on  word for the plane of the sources in focus = "...", and default: "target", or "sheet" for PIV
LensSetup read_lens_setup(SetupTable table, std::string const& focus_on = "target");

/// Returns the shipped glasses and those of the catalogues in a setup. Errors are reported at the key `glasses`.
GlassCatalogue read_glasses(LensSetup const& setup, SetupTable table);

/// Reads the prescription of a setup and builds the lens at a wavelength [m]; also sets focal length and f-number.
/// Errors are reported at the key `file`.
/// @param object_distance  distance from the first vertex to the plane in focus, for the f-number of telecentric lenses
/// [m]; empty: unknown
/// @param warnings         receives the lens' warnings
void build_prescription(LensSetup& setup, SetupTable table, GlassCatalogue const& glasses, double wavelength,
                        std::optional<double> object_distance, Warnings& warnings);

/// Image distance and magnification of a thin lens (Raffel 2015, Exp. Fluids 56:60), or of a lens that is equivalent to
/// one in paraxial approximation.
struct ImagingGeometry {
  double image_distance;  ///< z_i, from the lens to the sensor [m]; z_i / d_A is the working f-number
  double magnification;   ///< M = z_i / Z_B with the actual sensor distance, also when defocused [1]
  double entrance_pupil;  ///< d_A = f / N, diameter of the entrance pupil at the lens [m]; 0: chief rays only
};

/// Returns the imaging geometry of a thin lens.
/// @param focus_distance   distance of the plane in focus [m]; @pre greater than the focal length
/// @param target_distance  distance of the target, Z_B [m]
ImagingGeometry thin_lens_imaging(double focal_length, double f_number, double focus_distance, double target_distance);

}  // namespace gladstone::inline optics
