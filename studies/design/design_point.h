#pragma once

#include <cmath>
#include <optional>

#include "analysis/density/disc_transfer.h"
#include "render/light/target_setup.h"
#include "render/sensor/camera_equation.h"
#include "render/sensor/camera_setup.h"
#include "render/sensor/diffraction_spot.h"
#include "studies/case/random_error.h"
#include "studies/design/window_transfer.h"

namespace gladstone::inline design {

/// Given properties of a BOS set-up, which do not change with distances or lens. In SI.
struct FixedDesignParameters {
  CameraSetup camera;               ///< pixels, pitch, noise, exposure
  std::optional<PaperLight> light;  ///< illumination of the target; replaces the camera's exposure
  double wavelength = 532e-9;       ///< [m]
  double gladstone_dale = 2.26e-4;  ///< K [m^3/kg]
  double ambient_index = 1.00027685;
  double thickness = 0.01;  ///< L_z [m]
  /// largest density gradient to be measured, averaged over the thickness; 0: unknown [kg/m^4]
  double largest_gradient = 0;
  double dots_per_window_32 = 20;  ///< dots in 32 x 32 px
  int first_window_px = 64;
  WindowTransfer window{WindowWeighting::gaussian, 20};  ///< transfer of the last pass's interrogation window
};

inline constexpr double transfer_at_resolution = 0.70710678118654752440;
/// peak level of the brightest pixel with exposure = "auto", relative to full scale [1]
inline constexpr double automatic_peak = 0.9;

/// Closed-form model of a BOS set-up with a thin lens, or a lens equivalent to it near the axis, focused on the dots. T
/// is double, or a Jet for derivatives with respect to the five design variables. Symbols and numbers (F1 ...) as in
/// docs/design.md.
template <class T>
struct DesignPoint {
  FixedDesignParameters const* given;
  T focal_length;  ///< f [m]
  T f_number;      ///< N [1]
  T z_a;           ///< distance from the lens to the medium's mid-plane [m]
  T z_d;           ///< distance from the mid-plane to the dots [m]
  T dot_diameter;  ///< diameter d of a dot on the target [m]

  // imaging (F1, F16)
  T z_b() const { return z_a + z_d; }
  T image_distance() const { return focal_length * z_b() / (z_b() - focal_length); }
  T magnification() const { return focal_length / (z_b() - focal_length); }
  T magnification_at_medium() const { return image_distance() / z_a; }
  T pupil() const { return focal_length / f_number; }
  /// Return the width of a pixel in the medium's mid-plane and in the dots' plane [m].
  T pixel_at_medium() const { return given->camera.pixel_pitch / magnification_at_medium(); }
  T pixel_at_dots() const { return given->camera.pixel_pitch / magnification(); }

  // sensitivity (F5 to F8)
  /// Returns the deflection by a density gradient of 1 kg/m^4 over the thickness [rad per kg/m^4].
  T deflection() const { return T(given->gladstone_dale * given->thickness / given->ambient_index); }
  /// Returns the displacement on the sensor per deflection, M Z_D [m/rad].
  T angular_sensitivity() const { return magnification() * z_d; }
  /// Returns the displacement per density gradient, M Z_D K L_z / (n0 p) [px per kg/m^4].
  T sensitivity() const { return angular_sensitivity() * deflection() / given->camera.pixel_pitch; }
  T largest_displacement_px() const { return sensitivity() * given->largest_gradient; }

  // blur and resolution (F9 to F14)
  /// Returns the diameter of the light cone in the mid-plane, (f / N) Z_D / Z_B [m].
  T cone_diameter() const { return pupil() * z_d / z_b(); }
  /// Returns the length scale of the diffraction-limited PSF, N (1 + M) lambda [m].
  T spot_scale() const { return f_number * (1.0 + magnification()) * given->wavelength; }
  /// Returns d_d of F13, the diameter of the Airy pattern's first dark ring, with the customary factor 2.44 (exactly
  /// 2.43934) [px].
  T diffraction_px() const { return 2.44 * spot_scale() / given->camera.pixel_pitch; }
  /// Returns the standard deviation of the Gaussian matched to the Airy pattern [px].
  T spot_sigma_px() const { return 0.4206042622 * spot_scale() / given->camera.pixel_pitch; }
  T geometric_dot_px() const { return dot_diameter / pixel_at_dots(); }
  /// Returns d_tau of F14, the e^-2 diameter of the dot's image: diameter of the geometric image and four standard
  /// deviations of the PSF in quadrature (Adrian & Yao 1985; Olsen & Adrian 2000) [px].
  T dot_image_px() const {
    using std::sqrt;
    T const geometric = geometric_dot_px(), spot = spot_sigma_px();
    return sqrt(geometric * geometric + 16.0 * spot * spot);
  }
  /// Returns the width of the last pass's interrogation window in the medium's mid-plane [m].
  T window_width() const { return double(given->window.window_px()) * pixel_at_medium(); }
  /// Returns the amplitude transfer of a density wave by light cone, dot and weighted interrogation window [1].
  T transfer(T wavelength) const {
    return cone_transfer(pupil(), z_b(), z_d, given->thickness, wavelength) *
           disc_transfer(T(dot_diameter * z_a / z_b()), wavelength) *
           given->window.share(T(pixel_at_medium() / wavelength));
  }

  // light and noise (F21)
  /// Returns the charge in the pixel at the centre of a dot's image [e]. A disc of diameter g convolved with a Gaussian
  /// PSF of standard deviation sigma reaches the fraction 1 - exp(-g^2 / (8 sigma^2)) of a fully lit pixel; integration
  /// over the pixel adds 1/12 to sigma^2.
  T peak_electrons() const {
    if (!given->light && !given->camera.exposure_e) return T(automatic_peak * given->camera.noise.full_well_e);
    return lit_electrons() * peak_share();
  }
  /// Returns the charge in a fully lit pixel, from the light or the exposure; with "auto", the one for a peak at 90 %
  /// of full scale [e].
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
  /// Returns the standard deviation of the noise at the peak, relative to the peak height: shot noise, dark current,
  /// read noise and quantization [1].
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

  // measurement (F15, F18, F26)
  double dots_in_window() const {
    double const window = given->window.window_px() / 32.0;
    return given->dots_per_window_32 * window * window;
  }
  /// Returns the fraction of the target covered by dots [1].
  T coverage() const {
    T const geometric = geometric_dot_px();
    return given->dots_per_window_32 / 1024 * pi / 4 * geometric * geometric;
  }
  T random_error() const { return random_error_px(geometric_dot_px(), spot_sigma_px(), noise(), dots_in_window()); }
  /// Returns the gradient that causes a displacement [kg/m^4].
  T gradient_from_displacement(T displacement_px) const { return displacement_px / sensitivity(); }
  /// Returns the smallest detectable gradient: two standard deviations of the random error [kg/m^4].
  T smallest_gradient() const { return gradient_from_displacement(T(2.0 * random_error())); }
};

/// Returns the wavelength of density with a transfer of 1 / sqrt(2); the transfer of shorter waves is smaller [m].
double resolved_wavelength(DesignPoint<double> const& bench);

/// Computes the resolved wavelength with the derivatives of a Jet, by the implicit function theorem:
/// transfer(wavelength, design variables) is constant.
template <class T>
T resolved_wavelength(DesignPoint<T> const& bench, DesignPoint<double> const& value) {
  double const wavelength = resolved_wavelength(value), step = 1e-5 * wavelength;
  double const slope = (value.transfer(wavelength + step) - value.transfer(wavelength - step)) / (2 * step);
  return wavelength - (bench.transfer(T(wavelength)) - transfer_at_resolution) / slope;
}

}  // namespace gladstone::inline design
