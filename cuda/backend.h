#pragma once

#include <memory>
#include <string>

#include "analysis/correlation/correlator.h"
#include "render/scene/renderer.h"

/// The GPU as the rest of gladstone sees it: no CUDA header, the same with and without CUDA compiled in.
namespace gladstone::cuda {

/// Whether this executable can render and correlate on a CUDA device at all.
bool compiled_in();

/// One line for `--version`: the CUDA toolkit that the build saw, and what it was used for.
std::string description();

/// Whether a device can be used here and now.
struct DeviceState {
  bool usable = false;
  std::string text;  ///< the device's name and memory, or why there is none
};

/// Looks at the first visible device; never throws.
DeviceState device_state();

/// Number of devices that this process may use; 0 where there is none or no CUDA.
int device_count();

/// The renderer on the GPU. @throws DeviceError where device_state() is not usable
std::unique_ptr<Renderer> make_renderer();

/// The general renderer on the GPU. @throws DeviceError where device_state() is not usable
std::unique_ptr<Renderer> make_rays_renderer();

/// The correlator on the GPU, for what gladstone::missing_on_gpu() does not name.
/// @throws DeviceError where device_state() is not usable, or for another method
std::unique_ptr<Correlator> make_correlator(CorrelationSettings const& settings);

}  // namespace gladstone::cuda
