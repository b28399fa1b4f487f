#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "analysis/correlation/correlator.h"
#include "analysis/tomography/sart_volume.h"
#include "render/base/image_samples.h"
#include "render/ideal_images/pair_batch.h"
#include "render/scene/renderer.h"

namespace gladstone::inline cases {

/// Renderer and correlator of the device on which a command runs: the CPU's cores or a GPU.
struct Backend {
  std::unique_ptr<Renderer> renderer;
  std::function<std::unique_ptr<Correlator>(CorrelationSettings const&)> correlator;

  std::string name() const { return renderer->device(); }
  /// Returns the name of the device that correlates with these settings: "cpu" if the GPU does not support all of them.
  std::string correlates_on(CorrelationSettings const& settings) const {
    return missing_on_gpu(settings).empty() ? name() : "cpu";
  }
};

/// Returns the settings that a GPU does not support, e.g. `uncertainty = "image_matching"`; empty if all are supported.
std::string settings_requiring_cpu(CorrelationSettings const& settings);

/// Opens a device and logs which one is used.
/// @param wanted  "cpu", "cuda", or "auto": the GPU if one is usable
/// @throws DeviceError if "cuda" is not available, with the reason
Backend open_device(std::string const& wanted);

/// Opens the GPU for batches of pairs of ideal particle images. @param models  one or several, with frames of equal
/// size
/// @throws DeviceError if no GPU is usable, DataError if the models cannot be rendered together
std::unique_ptr<PairBatchRenderer> open_pair_batches(std::vector<OwnedPairModel> const& models);

/// Copies images of equal size that another library stores in the memory of the first GPU.
/// @throws DeviceError if no GPU is usable
CopiedFrames copy_frames_on_gpu(ImageSamples const& reference, ImageSamples const& flow);

/// Opens a device for tomographic reconstructions, like open_device().
tomography::SartVolumeMaker open_volume_device(std::string const& wanted);

/// Returns the number of GPUs of this process.
int gpu_count();
/// Returns whether the first GPU is usable.
bool gpu_is_usable();

/// Returns the index of the GPU whose memory contains an address, as this process counts GPUs; -1: host memory.
int gpu_of_memory(void const* address);

/// Returns version and commit of this build, "0.1.0 (a5503eb9ee49)".
std::string build_text();

/// Returns the text of --version: version, commit and backends.
std::string version_text();

/// Returns version, commit and backends as a JSON object.
std::string version_json();

}  // namespace gladstone::inline cases
