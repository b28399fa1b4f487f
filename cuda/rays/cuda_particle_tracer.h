#pragma once

#include "cuda/rays/particles_on_device.h"
#include "render/scene/renderer.h"

namespace gladstone::cuda::inline rays {

/// Renders images and truth of particles on the device, with the results of trace_particles(). Aiming is also done on
/// the device, one thread per particle; particles whose rays cannot be restricted to the stop (filled_stop.h) are aimed
/// by the host. Particles are processed in batches of at most 256 MB, in addition to the images, the medium and the
/// scattering table.
/// @param kept  scattering table on the device, reused between scenes
/// @param staging  page-locked buffer for transfers
Rendering trace_particles_on_device(Scene const& scene, RenderPlan const& plan, Particles const& particles,
                                    ParticleLight light, RenderImages images, DeviceMedium const& medium,
                                    ScatteringCache& kept, PinnedBuffer& staging);

}  // namespace gladstone::cuda::inline rays
