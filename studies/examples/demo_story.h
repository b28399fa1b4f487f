#pragma once

#include <string>
#include <vector>

#include "studies/compare/agreement.h"

namespace gladstone::inline examples {

/// Results of the demo at one instant of the turbulence field.
struct DemoInstant {
  std::string time;     ///< "t = 2.56"
  std::string heading;  ///< "t = 2.56, just after the peak of kinetic energy"
  /// Results of the paper's case over the valid vectors.
  struct Paper {
    AgreementSums sums;
    double cone_minus_rays_px = 0;  ///< rms difference of aperture-averaged theory and rays, per component [px]
    /// rms differences of the measurement from the ray truth and from the window-averaged truth, per component [px]
    double measured_minus_rays_px = 0;
    double measured_minus_window_px = 0;
    std::string report;  ///< error_report() of the comparison
  } paper;
  /// Results for the whole plane at one spacing; planes are sorted from coarse to fine.
  struct Plane {
    int nodes = 0;              ///< number of nodes across 32.7 mm
    double size_over_cone = 0;  ///< GradientSpectrum::structure_size() over cone_width() [1]
    PlaneAgreement traced;
    Agreement predicted;
  };
  std::vector<Plane> planes;
};

/// Formats the demo's results for docs/demo.md: Eq. 9, five findings, both figures and a table of the paper's case.
/// @param setup  setup of the paper's case
std::string demo_story(Setup const& setup, std::vector<DemoInstant> const& instants);

/// Formats a table of every point of the agreement figure and the error reports of the paper's case.
std::string demo_details(std::vector<DemoInstant> const& instants);

}  // namespace gladstone::inline examples
