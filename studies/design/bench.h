#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/light/target_setup.h"
#include "render/sensor/camera_equation.h"
#include "render/sensor/camera_setup.h"
#include "render/sensor/diffraction_spot.h"
#include "studies/design/random_error.h"
#include "studies/design/window_transfer.h"
#include "studies/disc_transfer.h"

namespace gladstone {

/// What a BOS bench is given, and no choice of distance or lens changes. In SI.
struct BenchGiven {
  CameraSetup camera;               ///< pixels, pitch, noise, exposure
  std::optional<PaperLight> light;  ///< replaces the camera's exposure
  double wavelength = 532e-9;       ///< [m]
  double gladstone_dale = 2.26e-4;  ///< K [m^3/kg]
  double ambient_index = 1.00027685;
  double thickness = 0.01;  ///< L_z [m]
  double largest_gradient =
      0;  ///< of density, averaged over the thickness, that is to be measured; 0: unknown [kg/m^4]
  double dots_per_window_32 = 20;  ///< dots in 32 x 32 px
  int first_window_px = 64;
  WindowTransfer window{WindowWeighting::gaussian, 20};  ///< of the last pass
};

inline constexpr double transfer_at_resolution = 0.70710678118654752440;
inline constexpr double automatic_peak = 0.9;  ///< of full scale, that exposure = "auto" gives the brightest pixel

/// A BOS bench: a thin lens, or one as good as it about the axis, dots in focus. Its methods are the closed forms of
/// BOS design; T is double, or a Jet that carries derivatives by the five choices. Symbols and numbers (F1 ...) as in
/// docs/design.md.
template <class T>
struct Bench {
  BenchGiven const* given;
  T focal_length;  ///< f [m]
  T f_number;      ///< N [1]
  T z_a;           ///< lens to the medium's mid-plane [m]
  T z_d;           ///< mid-plane to the dots [m]
  T dot_diameter;  ///< d, on the target [m]

  // imaging (F1, F16)
  T z_b() const { return z_a + z_d; }
  T image_distance() const { return focal_length * z_b() / (z_b() - focal_length); }
  T magnification() const { return focal_length / (z_b() - focal_length); }
  T magnification_at_medium() const { return image_distance() / z_a; }
  T pupil() const { return focal_length / f_number; }
  /// Widths of a pixel in the medium's and in the dots' plane [m].
  T pixel_at_medium() const { return given->camera.pixel_pitch / magnification_at_medium(); }
  T pixel_at_dots() const { return given->camera.pixel_pitch / magnification(); }

  // sensitivity (F5 to F8)
  /// Deflection that a density gradient of 1 kg/m^4 makes over the thickness [rad per kg/m^4].
  T deflection() const { return T(given->gladstone_dale * given->thickness / given->ambient_index); }
  /// Displacement on the sensor per deflection, M Z_D [m/rad].
  T angular_sensitivity() const { return magnification() * z_d; }
  /// M Z_D K L_z / (n0 p) [px per kg/m^4].
  T sensitivity() const { return angular_sensitivity() * deflection() / given->camera.pixel_pitch; }
  T largest_displacement_px() const { return sensitivity() * given->largest_gradient; }

  // blur and resolution (F9 to F14)
  /// Diameter of the cone of light in the mid-plane, (f / N) Z_D / Z_B [m].
  T cone_diameter() const { return pupil() * z_d / z_b(); }
  /// N (1 + M) lambda [m].
  T spot_scale() const { return f_number * (1.0 + magnification()) * given->wavelength; }
  /// d_d of F13: diameter between the first zeros of the Airy pattern, its factor rounded as usual (2.43934) [px].
  T diffraction_px() const { return 2.44 * spot_scale() / given->camera.pixel_pitch; }
  /// Standard deviation of the Gaussian matched to that spot [px].
  T spot_sigma_px() const { return 0.4206042622 * spot_scale() / given->camera.pixel_pitch; }
  T geometric_dot_px() const { return dot_diameter / pixel_at_dots(); }
  /// d_tau of F14, the e^-2 diameter of the dot's image: the disc's and the Gaussian spot's four sigmas in quadrature,
  /// as Setup::image_diameter_px() [px].
  T dot_image_px() const {
    using std::sqrt;
    T const geometric = geometric_dot_px(), spot = spot_sigma_px();
    return sqrt(geometric * geometric + 16.0 * spot * spot);
  }
  /// Width of the last pass's window in the medium's mid-plane [m].
  T window_width() const { return double(given->window.window_px()) * pixel_at_medium(); }
  /// Share of a density wave's displacement that the whole chain passes: cone, dot and window as weighted.
  T transfer(T wavelength) const {
    return cone_transfer(pupil(), z_b(), z_d, given->thickness, wavelength) *
           disc_transfer(T(dot_diameter * z_a / z_b()), wavelength) *
           given->window.share(T(pixel_at_medium() / wavelength));
  }

  // light and noise (F21)
  /// Electrons at the middle of a dot's image. A disc of diameter g under a Gaussian spot of sigma has the share
  /// 1 - exp(-g^2 / (8 sigma^2)) of a fully lit pixel; the pixel's own width adds 1/12 to sigma^2.
  T peak_electrons() const {
    if (!given->light && !given->camera.exposure_e) return T(automatic_peak * given->camera.noise.full_well_e);
    return lit_electrons() * peak_share();
  }
  /// In a fully lit pixel, of the light or of the exposure; with "auto" what puts the peak at 90 % of full scale.
  T lit_electrons() const {
    CameraSetup const& camera = given->camera;
    if (given->light) {
      return fully_lit_electrons(*given->light, f_number, magnification(), camera.pixel_pitch, given->wavelength,
                                 camera.noise.quantum_efficiency);
    }
    return camera.exposure_e ? T(*camera.exposure_e) : automatic_peak * camera.noise.full_well_e / peak_share();
  }
  T peak_share() const {
    using std::exp;
    T const sigma = spot_sigma_px(), geometric = geometric_dot_px();
    return 1.0 - exp(-geometric * geometric / (8.0 * (sigma * sigma + 1.0 / 12)));
  }
  /// Standard deviation of the noise at the peak over the peak's own height: shot noise, dark current, read noise and
  /// rounding to grey levels.
  T noise() const {
    using std::pow;
    using std::sqrt;
    NoiseSetup const& camera = given->camera.noise;
    double const level = camera.full_well_e / (pow(2.0, given->camera.bit_depth) - 1);
    T variance(level * level / 12);
    if (camera.enabled) {
      variance += camera.read_noise_e * camera.read_noise_e;
      if (camera.shot_noise) variance += peak_electrons() + camera.dark_current_e;
    }
    return sqrt(variance) / peak_electrons();
  }

  // what is measured (F15, F18, F26)
  double dots_in_window() const {
    double const window = given->window.window_px() / 32.0;
    return given->dots_per_window_32 * window * window;
  }
  /// Share of the target that dots cover.
  T coverage() const {
    T const geometric = geometric_dot_px();
    return given->dots_per_window_32 / 1024 * pi / 4 * geometric * geometric;
  }
  T random_error() const { return random_error_px(geometric_dot_px(), spot_sigma_px(), noise(), dots_in_window()); }
  /// Gradient whose displacement is this many px [kg/m^4].
  T gradient_of(T displacement_px) const { return displacement_px / sensitivity(); }
  /// Smallest gradient that is seen, at two standard deviations of the random error [kg/m^4].
  T smallest_gradient() const { return gradient_of(T(2.0 * random_error())); }
};

/// The wavelength of density that the whole chain passes with 1 / sqrt(2): shorter waves pass less [m].
double resolved_wavelength(Bench<double> const& bench);

/// The same with the derivatives of a Jet, by the implicit function theorem: transfer(wavelength, choices) is constant.
template <class T>
T resolved_wavelength(Bench<T> const& bench, Bench<double> const& value) {
  double const wavelength = resolved_wavelength(value), step = 1e-5 * wavelength;
  double const slope = (value.transfer(wavelength + step) - value.transfer(wavelength - step)) / (2 * step);
  return wavelength - (bench.transfer(T(wavelength)) - transfer_at_resolution) / slope;
}

}  // namespace gladstone
