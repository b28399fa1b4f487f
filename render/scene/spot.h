#pragma once

#include <optional>

#include "render/optics/lens_setup.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone {

struct Scene;

/// The spot that every ray leaves on the sensor; one model a launch.
struct SpotView {
  SpotModel model = SpotModel::none;
  GaussianSpot<double> gaussian;  ///< for the three Gaussian models
  AiryTable::View airy;           ///< for SpotModel::airy

  /// Pixels a ray's light reaches to each side of its own.
  GLADSTONE_HD int half_width() const {
    if (model == SpotModel::none) return 0;
    return model == SpotModel::airy ? airy.half_width : gaussian.half_width();
  }
};

/// The spot of a scene's lens; an Airy table is built into `airy`, which must outlive the view.
SpotView make_spot(Scene const& scene, std::optional<AiryTable>& airy);

}  // namespace gladstone
