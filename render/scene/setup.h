#pragma once

#include <cstdint>
#include <optional>

#include "render/base/setup_table.h"
#include "render/light/flow.h"
#include "render/light/laser_sheet.h"
#include "render/light/particle_setup.h"
#include "render/light/sources.h"
#include "render/light/target_setup.h"
#include "render/medium/medium_setup.h"
#include "render/optics/lens_setup.h"
#include "render/optics/lenslet_array.h"
#include "render/optics/window.h"
#include "render/sensor/camera_setup.h"

namespace gladstone {

/// e^-2 diameter of dot and particle images below which correlation locks to whole pixels [px].
inline constexpr double least_image_px = 2;

/// That a ray may take across the medium: 10 nm each in 10 mm.
inline constexpr double most_steps = 1e6;

/// Table [render] of a setup.
/// Scalar that rays are traced in. Truth is double; single is the GPU's preview.
enum class Precision { double_precision, single };

/// How images and truth are made.
enum class RenderMethod {
  automatic,     ///< focused_dots where it holds, formula for particles that have no other light, else rays
  rays,          ///< ray by ray: any source, any camera
  focused_dots,  ///< from tables, for flat dots in focus of an ideal thin lens
  formula,       ///< particles as ideal images, without rays
};

struct RenderSetup {
  std::optional<std::uint64_t> rays_per_dot;  ///< empty: auto
  PupilSampling sampling = PupilSampling::sobol;
  std::uint64_t seed = 1;
  Precision precision = Precision::double_precision;
  RenderMethod method = RenderMethod::automatic;
};

/// Particles in a laser sheet, and what moves them.
struct PivSetup {
  ParticleSetup particles;
  LaserSetup laser;
  FlowSetup flow;
};

/// Everything that rendering a BOS pair, a PIV pair or a calibration needs, in SI.
struct Setup {
  CameraSetup camera;
  LensSetup lens;
  MediumSetup medium;
  TargetSetup target;
  std::vector<double> planes;   ///< Z of each that a calibration shows its target on [m]; empty: no calibration
  std::optional<PivSetup> piv;  ///< there is no target then: "the dots' plane" is Z = 0
  RenderSetup render;
  double z_a = 0.75;               ///< front principal plane to the medium's mid-plane, along the camera's axis [m]
  std::optional<double> z_sensor;  ///< of the sensor on the Z axis, where it places the lens [m]
  double z_d =
      0.25;  ///< the medium's mid-plane to the dots, along Z [m]; 0 for PIV, and for a calibration: see plane_setup
  std::optional<Pose<double>> pose;      ///< of the camera: see camera_pose(); empty: on the Z axis, looking along -Z
  std::optional<LensletSetup> lenslets;  ///< a plenoptic camera's, which its lens is focused on
  std::vector<WindowSetup> windows;      ///< in the order light meets them
  std::vector<std::string> warnings;     ///< of what was read
  int view_margin_px = 64;  ///< by which a target of default extent reaches beyond the view: the first pass's window

  /// Of the front principal plane (of the first vertex, where a lens has no such plane): z along the light, x right and
  /// y up as the camera sees them.
  Pose<double> camera_pose() const { return pose ? *pose : Pose<double>{{0, 0, z_a}}; }
  /// Front principal plane to the dots along the camera's axis [m].
  double z_b() const { return z_a + z_d / camera_pose().z.z; }
  /// Where the camera's axis meets the dots' plane [m].
  Vec2d axis_on_target() const;
  /// Middle of the target on its plane: there, or as the setup says [m].
  Vec2d target_centre() const;
  /// By how much a target is to be larger than the view, since its middle lies elsewhere [m].
  Vec2d beyond_view() const;
  /// Whether the camera is an ideal thin lens on the Z axis with nothing before it, and its sensor square to it: what
  /// closed forms describe.
  bool on_bench() const {
    return !lens.prescription && !pose && windows.empty() && !camera.tilted() && !camera.distorted() && !lenslets;
  }
  bool calibration() const { return !planes.empty(); }
  double focus_distance() const;
  /// How far off the axis, in x or y, anything may lie that a lens is to see: ten times the way from the dots to it, 84
  /// degrees [m].
  double farthest_off_axis() const { return 10 * z_b(); }
  /// Magnification and pupil about the axis; of prescriptions and through windows those of paraxial light, with the
  /// sensor in the paraxial image.
  ImagingGeometry imaging() const;
  double ambient_index() const { return 1 + medium.ambient_refractivity(); }
  /// Width and height of the target, about target_centre() [m].
  Vec2d target_extent() const;
  /// Diameter of a dot on the target [m]; from dot_diameter_px by pixel_size().
  double dot_diameter() const;
  /// N (1 + M) lambda, as image distance over pupil diameter times wavelength [px]; 0 for chief rays. Of a plenoptic
  /// camera that of a lenslet: its distance from the sensor over its pitch, times wavelength.
  double spot_scale_px() const;
  /// Diameter d_d of the diffraction spot that is drawn [px]: between the first zeros of the Airy pattern for "airy"
  /// and for the Gaussian matched to it; four standard deviations for "gaussian_first_zero" (2.44 N (1 + M) lambda) and
  /// "seed_eq8" (pi times that, as the seed prints it); 0 without a spot.
  double spot_diameter_px() const;
  /// e^-2 diameter (four standard deviations) of the spot that is drawn; of "airy" that of the matched Gaussian [px].
  double spot_e2_diameter_px() const;
  /// Diameter of the disc of confusion of a point in the dots' plane, on a sensor that is focused elsewhere [px].
  double defocus_diameter_px() const;
  /// The diameter of a dot's image, everywhere [px]: e^-2 diameters of the geometric image, the spot and the disc of
  /// confusion, in quadrature (Adrian & Yao 1985; Olsen & Adrian 2000).
  /// @param geometric_px diameter of the geometric image [px]
  double image_diameter_px(double geometric_px) const;
  /// Diameter of the geometric image of a dot of the target [px].
  double geometric_dot_px() const { return dot_diameter() / pixel_size(); }
  /// Side of the square that is as large as what a pixel sees at the target's middle, by the chief rays there [m]: a
  /// disc of that diameter has an image of a pixel's width, or, foreshortened, of the same area.
  double pixel_size() const;
  /// Area of the target that a pixel sees [m^2]; of a turned or tilted camera the mean over its picture.
  double pixel_area() const;
  /// Number of dots on the target, for kind = "dots".
  double dot_count() const;
};

/// Reads the tables of a setup of BOS, PIV or calibration through the rooms' readers; what is due later is refused by
/// name.
Setup read_setup(SetupTable root);

/// Cross-checks by physics: focus, planes, steps across the medium, field of view, dot size, dot coverage. Of files
/// only the size of the field's grid is looked at. Problems go to the setup's document with their keys; warnings are
/// returned.
std::vector<std::string> cross_check(Setup const& setup, SetupTable root);

}  // namespace gladstone
