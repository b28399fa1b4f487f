#pragma once

#include "render/base/host_device.h"
#include "render/base/vec.h"
#include "render/scene/ideal_projection.h"

namespace gladstone {

/// Position and light of a particle's image in one frame.
struct ParticleImage {
  Vec2d at;          ///< position on the sensor [px]
  double light = 0;  ///< photons, or light in units of photon_unit(); 0: no image
};

}  // namespace gladstone
