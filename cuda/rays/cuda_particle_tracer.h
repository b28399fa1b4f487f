#pragma once

#include "cuda/rays/particles_on_device.h"
#include "render/scene/renderer.h"

namespace gladstone::cuda {

/// Images and truth of particles as trace_particles() gives them, on the device: where their rays go is found there,
/// too, a thread a particle; those that do not fill the stop (filled_stop.h) the host aims. Particles pass in batches
/// that take 256 MB at most, to which come images, medium and the table of what spheres scatter.
/// @param kept of the device, from scene to scene @param staging that the device copies to
Rendering trace_particles_on_device(Scene& scene, Particles const& particles, ParticleLight light, RenderImages images,
                                    DeviceMedium<double> const& medium, ScatteringCache& kept, PinnedBuffer& staging);

}  // namespace gladstone::cuda
