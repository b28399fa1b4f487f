#pragma once

#include <memory>
#include <string>

#include "analysis/correlation/correlator.h"
#include "analysis/tomography/sart_volume.h"
#include "render/base/image_samples.h"
#include "render/ideal_images/ideal_images.h"
#include "render/ideal_images/pair_batch.h"
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

/// Returns the index of the device whose memory contains an address, as this process counts devices; -1: host memory.
int device_of_memory(void const* address);

/// Creates the renderer for focused dots on the GPU. @throws DeviceError if no device is usable
std::unique_ptr<Renderer> make_renderer();

/// Creates the general ray-tracing renderer on the GPU. @throws DeviceError if no device is usable
std::unique_ptr<Renderer> make_rays_renderer();

/// Creates the drawer of ideal particle images on the GPU. @throws DeviceError if no device is usable
std::unique_ptr<ImageDrawer> make_image_drawer();

/// Creates a renderer of batches of pairs on the GPU. @param models  one or several, with frames of equal size
/// @throws DeviceError if no device is usable, DataError if the models cannot be rendered together
std::unique_ptr<PairBatchRenderer> make_pair_batches(std::vector<OwnedPairModel> const& models);

/// Creates the correlator on the GPU, for settings that gladstone::missing_on_gpu() does not list.
/// @throws DeviceError if no device is usable or a setting is not supported
std::unique_ptr<Correlator> make_correlator(CorrelationSettings const& settings);

/// Copies images of equal size that another library stores on the first device, on the default stream, and waits for
/// it. @throws DeviceError if no device is usable
CopiedFrames copy_frames(ImageSamples const& reference, ImageSamples const& flow);

/// Creates the volume of a tomographic reconstruction on the GPU. @throws DeviceError if no device is usable
std::unique_ptr<SartVolume> make_volume(SartProblem const& problem);

}  // namespace gladstone::cuda
