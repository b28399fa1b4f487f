#include "render/optics/lens_setup.h"

#include <cmath>

#include "render/base/units.h"

namespace gladstone {

LensSetup read_lens_setup(SetupTable table) {
  LensSetup setup;
  if (table.kind_word("model", "thin", {"thin", "prescription"}) == "prescription") {
    table.excuse();
    table.problem("model", "\"prescription\" is not available yet (this version has the thin lens only); use \"thin\"");
  }
  table.refuse("file", "is not available yet (lens prescriptions are not part of this version); use model = \"thin\"");
  setup.focal_length = table.number("focal_length_mm", 105.0, Range::positive(1e5)) * unit::millimetre;
  Range aperture = Range::positive();
  aperture.allow_inf = true;
  setup.f_number = table.number("f_number", 11.0, aperture);
  if (table.has("focus_distance_mm")) {
    if (table.has("focus")) {
      table.problem("focus_distance_mm", "stands beside focus (one of them is enough); remove one");
      table.word("focus", "target", {"target", "medium"});
    }
    setup.focus = Focus::distance;
    setup.focus_distance = table.number("focus_distance_mm", 1000.0, Range::positive()) * unit::millimetre;
  } else if (table.word("focus", "target", {"target", "medium"}) == "medium") {
    setup.focus = Focus::medium;
  }
  std::string const psf =
      table.word("psf", "gaussian", {"gaussian", "airy", "gaussian_first_zero", "seed_eq8", "none"});
  if (psf == "airy") setup.spot = SpotModel::airy;
  if (psf == "gaussian_first_zero") setup.spot = SpotModel::gaussian_first_zero;
  if (psf == "seed_eq8") setup.spot = SpotModel::seed_eq8;
  if (psf == "none") setup.spot = SpotModel::none;
  return setup;
}

ImagingGeometry thin_lens_imaging(double focal_length, double f_number, double focus_distance, double target_distance) {
  double const image_distance = 1 / (1 / focal_length - 1 / focus_distance);
  return {image_distance, image_distance / target_distance, std::isinf(f_number) ? 0.0 : focal_length / f_number};
}

}  // namespace gladstone
