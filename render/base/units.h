#pragma once

namespace gladstone::inline base {

inline constexpr double pi = 3.14159265358979323846;

/// Units in SI. Values from text are converted to SI once, when they are read.
namespace unit {
inline constexpr double metre = 1.0;
inline constexpr double millimetre = 1e-3;
inline constexpr double micrometre = 1e-6;
inline constexpr double nanometre = 1e-9;
inline constexpr double mm = millimetre, um = micrometre;  // short, for tables of values
inline constexpr double microsecond = 1e-6;
inline constexpr double millijoule = 1e-3;
inline constexpr double degree = pi / 180.0;
}  // namespace unit

namespace constant {
/// Ratio of specific heats of dry air near room temperature [1] (NACA Report 1135, 1953).
inline constexpr double gamma_air = 1.4;
/// Speed of light in vacuum [m/s] and Planck's constant [J s], exact by definition (BIPM, SI Brochure, 9th ed., 2019).
inline constexpr double speed_of_light = 299792458.0;
inline constexpr double planck = 6.62607015e-34;
}  // namespace constant

}  // namespace gladstone::inline base
