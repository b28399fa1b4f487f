#pragma once

#include <optional>

#include "render/optics/lens_setup.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone::inline scene {

struct Scene;

/// Point spread function of a ray on the sensor; the same for all rays of a rendering.
struct SpotView {
  SpotModel model = SpotModel::none;
  GaussianSpot<double> gaussian;  ///< parameters of the three Gaussian models
  AiryTable::View airy;           ///< table for SpotModel::airy

  /// Number of pixels that the PSF covers on each side of its centre pixel.
  GLADSTONE_HD int half_width() const {
    if (model == SpotModel::none) return 0;
    return model == SpotModel::airy ? airy.half_width : gaussian.half_width();
  }
};

/// Returns the PSF of a scene's lens. An Airy table is built into `airy`, which must outlive the view.
SpotView make_spot(Scene const& scene, std::optional<AiryTable>& airy);

}  // namespace gladstone::inline scene
