#pragma once

#include <string>
#include <vector>

#include "studies/agreement.h"

namespace gladstone {

/// What the demo finds at one instant of the turbulence field.
struct DemoInstant {
  std::string time;     ///< "t = 2.56"
  std::string heading;  ///< "t = 2.56, just after the peak of kinetic energy"
  /// The paper's case, over the valid vectors.
  struct Paper {
    AgreementSums sums;
    double cone_minus_rays_px = 0;  ///< rms per component, as those below
    double measured_minus_rays_px = 0;
    double measured_minus_window_px = 0;
    std::string report;  ///< error_report() of the comparison
  } paper;
  /// The whole plane at one spacing, coarsest first.
  struct Plane {
    int nodes = 0;              ///< in 32.7 mm
    double size_over_cone = 0;  ///< GradientSpectrum::structure_size() over cone_width()
    PlaneAgreement traced;
    Agreement predicted;
  };
  std::vector<Plane> planes;
};

/// What the demo shows, in five sentences with Eq. 9, both figures and the paper's case as a table: README's passage.
/// @param setup of the paper's case
std::string demo_story(Setup const& setup, std::vector<DemoInstant> const& instants);

/// Table of every point of the agreement figure, and the error reports of the paper's case.
std::string demo_details(std::vector<DemoInstant> const& instants);

}  // namespace gladstone
