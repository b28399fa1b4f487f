#pragma once

#include <memory>
#include <optional>

#include "render/base/setup_table.h"
#include "render/optics/lens.h"

namespace gladstone {

enum class Focus { target, medium, distance };
enum class SpotModel { airy, gaussian, gaussian_first_zero, seed_eq8, none };

/// What glass takes off the light: of lenses and of windows.
enum class Transmittance {
  ideal,     ///< nothing
  surfaces,  ///< what bare surfaces reflect (Fresnel)
  glass,     ///< that, and what the glass absorbs as its catalogue says
};

/// Table [lens] of a setup, in SI.
struct LensSetup {
  double focal_length = 0.105;  ///< infinite for afocal prescriptions [m]
  double f_number = 11.0;       ///< infinite: chief rays only; NaN: of a prescription that has none
  Focus focus = Focus::target;
  double focus_distance = 0.0;  ///< from the front principal plane, for Focus::distance [m]
  SpotModel spot = SpotModel::gaussian;
  Transmittance transmittance = Transmittance::ideal;
  std::vector<std::string> glasses;          ///< catalogues (AGF) beside the shipped ones, for windows too
  std::string file;                          ///< of a prescription; empty: an ideal thin lens
  std::shared_ptr<Lens const> prescription;  ///< made ready at the setup's wavelength; null: an ideal thin lens
};

/// Reads [lens]. A prescription is named only; build_prescription() makes it ready.
/// @param focus_on what focus = "..." calls the plane of the sources: "target", or "sheet" for PIV; it is the default
LensSetup read_lens_setup(SetupTable table, std::string const& focus_on = "target");

/// The shipped glasses and those of the catalogues that a setup names. Problems go to the key `glasses`.
GlassCatalogue read_glasses(LensSetup const& setup, SetupTable table);

/// Reads the prescription that a setup names, at the setup's wavelength [m]: sets focal length and f-number too.
/// Problems go to the key `file`. @param object_distance from the first vertex to the plane in focus, that the f-number
/// of a telecentric lens is of [m]; empty: not known @param warnings of glasses that are not known well
void build_prescription(LensSetup& setup, SetupTable table, GlassCatalogue const& glasses, double wavelength,
                        std::optional<double> object_distance, std::vector<std::string>& warnings);

/// Image distance and magnifications of a thin lens (Raffel 2015, Exp. Fluids 56:60), or of one that is as good as it
/// about the axis.
struct ImagingGeometry {
  double image_distance;  ///< z_i, lens to sensor; with d_A the working f-number z_i / d_A [m]
  double magnification;   ///< M = z_i / Z_B with the actual sensor distance, also when defocused [1]
  double entrance_pupil;  ///< d_A = f / N: width at the lens of the light that passes the stop [m]; 0 for chief rays
};

/// @param focus_distance object distance that is imaged sharply [m]; @pre greater than the focal length
ImagingGeometry thin_lens_imaging(double focal_length, double f_number, double focus_distance, double target_distance);

}  // namespace gladstone
