#pragma once

#include <string>

#include "render/scene/setup.h"
#include "studies/design/bench.h"

namespace gladstone {

/// Lines and distances of a bench's layout, in its plane through the axis [m]: Z along the axis from the medium's
/// middle towards the camera, Y across it.
struct BenchLayout {
  double dots_z, lens_z, sensor_z;
  double medium_half_thickness;
  double pupil_radius;
  double sensor_half, medium_half, dots_half;              ///< half heights of the sensor and of what it sees
  double cone_radius;                                      ///< in the medium's mid-plane, of the dot on the axis
  double sheet_half_thickness = 0, sheet_half_height = 0;  ///< of a laser sheet; 0: there are dots
};

BenchLayout bench_layout(Bench<double> const& bench);

/// Draws a bench from the side: target, medium, lens, sensor, the cone of light of the dot on the axis, the field of
/// view and the distances; above to scale, below with heights stretched.
/// @throws GnuplotMissing, OutputError
void write_layout_figure(std::string const& path, Bench<double> const& bench);

/// Those of a PIV setup: the sheet is in the medium's mid-plane. @pre setup.piv
BenchLayout piv_layout(Setup const& setup);

/// The same drawing with the laser sheet and a particle on the axis. @throws GnuplotMissing, OutputError
void write_piv_layout(std::string const& path, Setup const& setup);

}  // namespace gladstone
