#include "studies/case/backend.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

#include "analysis/tracking/tracking_correlator.h"
#include "analysis/uncertainty/uncertainty.h"
#include "cuda/backend.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/text.h"
#include "render/base/version.h"
#include "render/render.h"

namespace gladstone::inline cases {
namespace {

std::string threads_text() { return count_text(static_cast<std::size_t>(thread_count()), "thread"); }

/// Creates the correlator of a GPU; for settings it does not support, that of the CPU, unless only the GPU is allowed.
std::unique_ptr<Correlator> correlator_on_gpu(CorrelationSettings const& settings, bool only_gpu) {
  std::string const unsupported = settings_requiring_cpu(settings);
  if (unsupported.empty()) return cuda::make_correlator(settings);
  if (only_gpu)
    throw DeviceError(
        fmt::format("--device cuda: correlate.{} is computed on the CPU alone; use --device auto", unsupported));
  if (!missing_on_gpu(settings).empty()) {
    spdlog::info("correlate.{} is computed on the CPU, {}", unsupported, threads_text());
    return tracking::make_cpu_correlator(settings);
  }
  spdlog::info("correlate.{} is estimated on the CPU, {}", unsupported, threads_text());
  return cuda::make_correlator(settings);
}

/// Returns whether to use the GPU, and logs which device is used.
/// @throws DeviceError if "cuda" is wanted and not available
bool choose_gpu(std::string const& wanted) {
  if (wanted != "auto" && wanted != "cpu" && wanted != "cuda")
    throw DeviceError(fmt::format("device \"{}\" is not \"auto\", \"cpu\" or \"cuda\"", wanted));
  std::string instead;
  if (wanted != "cpu") {
    cuda::DeviceState const state = cuda::device_state();
    if (state.usable) {
      spdlog::info("device: cuda, {}", state.text);
      return true;
    }
    if (wanted == "cuda") throw DeviceError("--device cuda: " + state.text + "; use --device cpu or auto");
    instead = " (" + state.text + ")";
  }
  spdlog::info("device: cpu, {}{}", threads_text(), instead);
  return false;
}

}  // namespace

std::string settings_requiring_cpu(CorrelationSettings const& settings) {
  std::string const missing = missing_on_gpu(settings);
  if (!missing.empty() || uncertainty_on_gpu(settings.uncertainty)) return missing;
  return fmt::format("uncertainty = \"{}\"", settings.uncertainty);
}

Backend open_device(std::string const& wanted) {
  if (choose_gpu(wanted)) {
    return {std::make_unique<Device>(cuda::make_renderer(), cuda::make_rays_renderer(), cuda::make_image_drawer()),
            [wanted](CorrelationSettings const& settings) { return correlator_on_gpu(settings, wanted == "cuda"); }};
  }
  return {std::make_unique<Device>(cpu()), tracking::make_cpu_correlator};
}

CopiedFrames copy_frames_on_gpu(ImageSamples const& reference, ImageSamples const& flow) {
  return cuda::copy_frames(reference, flow);
}

tomography::SartVolumeMaker open_volume_device(std::string const& wanted) {
  if (choose_gpu(wanted)) return cuda::make_volume;
  return tomography::make_host_volume;
}

std::unique_ptr<PairBatchRenderer> open_pair_batches(std::vector<OwnedPairModel> const& models) {
  return cuda::make_pair_batches(models);
}

int gpu_count() { return cuda::device_count(); }

bool gpu_is_usable() {
  static bool const usable = cuda::device_state().usable;  // asking takes a millisecond
  return usable;
}

int gpu_of_memory(void const* address) { return cuda::device_of_memory(address); }

std::string build_text() { return fmt::format("{} ({})", version, git_sha1); }

std::string version_text() {
  return fmt::format("gladstone {}\nbackends: {}\nCUDA: {}", build_text(), cuda::compiled_in() ? "cpu, cuda" : "cpu",
                     cuda::description());
}

std::string version_json() {
  return nlohmann::json{{"version", version},
                        {"commit", git_sha1},
                        {"backends", cuda::compiled_in() ? nlohmann::json{"cpu", "cuda"} : nlohmann::json{"cpu"}},
                        {"cuda", cuda::description()}}
      .dump(2);
}

}  // namespace gladstone::inline cases
