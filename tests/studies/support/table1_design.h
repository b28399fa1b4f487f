#pragma once

#include "studies/design/design_point.h"

namespace gladstone {

/// Medium and camera of Table 1 (Rajendran et al., 2019): K = 2.26e-4 m^3/kg, n0 = 1.00027685, L_z = 10 mm, pixels of
/// 10 um, 532 nm.
inline FixedDesignParameters table1_given() {
  FixedDesignParameters given;
  given.camera.columns = given.camera.rows = 512;
  given.camera.pixel_pitch = 10e-6;
  given.window = WindowTransfer(WindowWeighting::gaussian, 16);
  return given;
}

/// Set-up of Table 1: f = 105 mm, f/11, Z_A = 750 mm, Z_D = 250 mm, dots of 3 px.
inline DesignPoint<double> table1_design(FixedDesignParameters const& given) {
  DesignPoint<double> bench{&given, 0.105, 11, 0.75, 0.25, 0};
  bench.dot_diameter = 3 * bench.pixel_at_dots();
  return bench;
}

}  // namespace gladstone
