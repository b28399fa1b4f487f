#include <iostream>
#include <vector>

#include "analysis/errors/error_summary.h"
#include "render/base/version.h"
#include "render/scene/setup.h"

int main() {
  gladstone::SetupDocument document =
      gladstone::SetupDocument::from_text("[lens]\nfocal_length_mm = 105.0\n", "consumer");
  std::vector<gladstone::Vec2d> const measured{{3, 4}}, truth{{0, 0}};
  std::cout << "gladstone " << gladstone::version
            << ", f = " << gladstone::read_setup(document.root()).lens.focal_length
            << " m, rms = " << gladstone::summarize_errors(measured, truth, {})["rms_px"] << " px\n";
}
