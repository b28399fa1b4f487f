#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "render/base/warning.h"
#include "render/light/flow.h"
#include "render/light/laser_sheet.h"
#include "render/light/particle_sequence.h"
#include "render/light/particle_setup.h"
#include "render/light/sources.h"
#include "render/light/target_setup.h"
#include "render/medium/medium_setup.h"
#include "render/optics/lens_setup.h"
#include "render/optics/optical_element.h"
#include "render/scene/experiment.h"
#include "render/scene/sequence_setup.h"
#include "render/sensor/camera_setup.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline scene {

/// e^-2 diameter of dot and particle images below which correlation is biased towards whole pixels (peak locking) [px].
inline constexpr double min_image_px = 2;

/// Maximum number of integration steps per ray: 10 nm each in 10 mm.
inline constexpr double max_step_count = 1e6;

/// Precision in which rays are traced. The truth requires double; single is a preview mode of the GPU.
enum class Precision { double_precision, single };

/// Method by which images and truth are computed.
enum class RenderMethod {
  automatic,     ///< focused_dots if valid; formula for particles with ideal images; else rays
  rays,          ///< ray tracing: any source, any camera
  focused_dots,  ///< deflection tables: flat dots in focus of an ideal thin lens
  formula,       ///< ideal particle images, without rays
};

/// Table [render] of a setup.
struct RenderSetup {
  std::optional<std::uint64_t> rays_per_dot;  ///< number of rays per dot; empty: auto
  PupilSampling sampling = PupilSampling::sobol;
  std::uint64_t seed = 1;
  Precision precision = Precision::double_precision;
  RenderMethod method = RenderMethod::automatic;
};

/// Particles, laser sheet and flow of a PIV setup.
struct PivSetup {
  ParticleSetup particles;
  LaserSetup laser;
  FlowSetup flow;
};

/// Complete description of a BOS pair, a PIV pair or a calibration, in SI.
struct Setup {
  CameraSetup camera;
  LensSetup lens;
  MediumSetup medium;
  TargetSetup target;
  std::vector<double> planes;  ///< Z of the planes of a calibration target [m]; empty: no calibration
  /// particles, laser sheet and flow; empty: BOS or calibration; in PIV, the "dots' plane" is Z = 0
  std::optional<PivSetup> piv;
  /// sequence and the pair of it that the setup describes; empty: a single pair
  std::optional<SequenceSetup> sequence;
  std::shared_ptr<ParticleCache> shared_particles;  ///< particles shared by the pairs of a sequence; null: none
  RenderSetup render;
  double z_a = 0.75;  ///< distance from the front principal plane to the medium's mid-plane along the camera's axis [m]
  std::optional<double> z_sensor;  ///< position of a fixed sensor on the Z axis, from which the lens is placed [m]
  /// distance from the medium's mid-plane to the dots along Z [m]; 0 for PIV and calibration (plane_setup)
  double z_d = 0.25;
  std::optional<Pose<double>> pose;  ///< pose of the camera, see camera_pose(); empty: on the Z axis, looking along -Z
  std::vector<OpticalElement> elements;  ///< optical elements besides the lens; those of a side in the light's order
  Warnings warnings;                     ///< warnings from reading the setup
  int view_margin_px = 64;  ///< margin of a target of default extent beyond the view: first-pass window [px]

  /// Returns the pose of the front principal plane (of the first vertex if the lens has no principal plane): z along
  /// the light, x right and y up as the camera sees them.
  Pose<double> camera_pose() const { return pose ? *pose : Pose<double>{{0, 0, z_a}}; }
  /// Distance from the front principal plane to the dots along the camera's axis [m].
  double z_b() const { return z_a + z_d / camera_pose().z.z; }
  /// Intersection of the camera's axis with the dots' plane [m].
  Vec2d axis_on_target() const;
  /// Centre of the target in its plane: as configured, or the intersection with the camera's axis [m].
  Vec2d target_centre() const;
  /// Returns the amount by which a target must be larger than the view because its centre is off the camera's axis [m].
  Vec2d target_view_margin() const;
  /// Returns why the closed forms of the literature (a single magnification, Eq. 9) do not describe the camera; empty
  /// for an ideal thin lens on the Z axis without other optical elements or distortion, and a sensor perpendicular to
  /// the axis. Theory and the renderers by formula depend on it; project(), unproject() and apparent_pupil() of Camera
  /// serve every camera.
  std::string reason_against_closed_form() const;
  bool has_closed_form_layout() const { return reason_against_closed_form().empty(); }
  /// Returns true if an optical element ahead of the image plane adds aberrations to those of the lens.
  bool has_refracting_elements() const;
  /// Returns true if an optical element divides the light of a point among many images.
  bool divides_light() const;
  /// Returns true if the camera is posed or tilted, or its axis is deflected, so that its view is found by tracing
  /// rays.
  bool has_oblique_view() const;
  /// Returns the apparent displacement of objects along the axis by the elements on one side [m].
  double element_shift(ElementSide side) const;
  /// Returns the first optical element of a kind; null if there is none.
  template <class Kind>
  Kind const* element() const {
    for (OpticalElement const& held : elements) {
      if (auto const* const found = held.get<Kind>()) return found;
    }
    return nullptr;
  }
  /// Returns the kind of experiment: PIV with particles, a calibration with planes, BOS otherwise.
  Experiment const& experiment() const;
  /// Returns true for particles without a scattering model, which have ideal images only.
  bool has_ideal_particles() const;
  /// Distance from the front principal plane to the plane in focus [m].
  double focus_distance() const;
  /// Upper limit of |x| and |y| of objects [m]: 10 z_b, a field angle of 84 degrees.
  double max_off_axis_distance() const { return 10 * z_b(); }
  /// Returns image distance, magnification and entrance pupil near the axis. For prescriptions and cameras behind
  /// other optical elements, these are paraxial values with the sensor in the paraxial image.
  ImagingGeometry imaging() const;
  double ambient_index() const { return 1 + medium.ambient_refractivity(); }
  /// Width and height of the target, centred on target_centre() [m].
  Vec2d target_extent() const;
  /// Diameter of a dot on the target, as configured or from dot_diameter_px [m].
  double dot_diameter() const;
  /// Scale of diffraction, N (1 + M) lambda: image distance over pupil diameter times wavelength [px]; 0 for chief
  /// rays. If an optical element (lenslets) forms the final images, N (1 + M) is replaced by their f-number.
  double spot_scale_px() const;
  /// Diameter d_d of the rendered diffraction PSF [px]: diameter of the first Airy zero for "airy" and for the Gaussian
  /// matched to it; four standard deviations for "gaussian_first_zero" (2.44 N (1 + M) lambda) and "seed_eq8" (pi times
  /// that, as printed in Eq. 8 of Rajendran et al. 2019); 0 without a PSF.
  double spot_diameter_px() const;
  /// e^-2 diameter (four standard deviations) of the rendered PSF; for "airy", that of the matched Gaussian [px].
  double spot_e2_diameter_px() const;
  /// Diameter of the circle of confusion of a point in the dots' plane for a camera that is focused elsewhere [px].
  double defocus_diameter_px() const;
  /// Diameter of the geometric image of a target dot [px].
  double geometric_dot_px() const { return dot_diameter() / pixel_size(); }
  /// Side of the square whose area equals the part of the dots' plane that a pixel sees at the target's centre, by
  /// chief rays [m]. A disc of that diameter has an image one pixel wide or, if foreshortened, of the same area.
  double pixel_size() const;
  /// Area of the target seen by a pixel [m^2]; for a posed or tilted camera, the mean over its image.
  double pixel_area() const;
  /// Number of dots on the target, for kind = "dots" with a given number per window.
  double dot_count() const;
};

}  // namespace gladstone::inline scene
