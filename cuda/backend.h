#pragma once

#include <memory>
#include <string>

#include "analysis/correlation/correlator.h"
#include "render/scene/renderer.h"

/// Interface to the GPU for the rest of gladstone: independent of CUDA headers, and identical whether CUDA is compiled
/// in or not.
namespace gladstone::cuda {

/// Returns whether this executable was built with CUDA.
bool compiled_in();

/// Returns one line for `--version`: version of the CUDA toolkit and target architectures.
std::string description();

/// Availability of a device at run time.
struct DeviceState {
  bool usable = false;
  std::string text;  ///< name and memory of the device, or the reason why none is usable
};

/// Tests the first visible device; does not throw.
DeviceState device_state();

/// Returns the number of devices available to this process; 0 without CUDA.
int device_count();

/// Creates the renderer for focused dots on the GPU. @throws DeviceError if no device is usable
std::unique_ptr<Renderer> make_renderer();

/// Creates the general ray-tracing renderer on the GPU. @throws DeviceError if no device is usable
std::unique_ptr<Renderer> make_rays_renderer();

/// Creates the correlator on the GPU, for settings that gladstone::missing_on_gpu() does not list.
/// @throws DeviceError if no device is usable or a setting is not supported
std::unique_ptr<Correlator> make_correlator(CorrelationSettings const& settings);

}  // namespace gladstone::cuda
