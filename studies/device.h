#pragma once

#include <functional>
#include <memory>
#include <string>

#include "analysis/correlation/correlator.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// Where a command computes: both halves of the chain on the CPU's cores, or both on a GPU.
struct Device {
  std::unique_ptr<Renderer> renderer;
  std::function<std::unique_ptr<Correlator>(CorrelationSettings const&)> correlator;

  std::string name() const { return renderer->device(); }
  /// The same of what correlates with these settings: the CPU where the GPU does not have all that they ask for.
  std::string correlates_on(CorrelationSettings const& settings) const {
    return missing_on_gpu(settings).empty() ? name() : "cpu";
  }
};

/// What of these settings a GPU leaves to the CPU, as `uncertainty = "image_matching"`; empty: nothing.
std::string left_to_cpu(CorrelationSettings const& settings);

/// @param wanted "cpu", "cuda", or "auto": the GPU where one can be used. Says on the log which it is.
/// @throws DeviceError where "cuda" cannot be had, with the reason
Device open_device(std::string const& wanted);

/// Number of GPUs that can be used here; 0: none.
int gpu_count();

}  // namespace gladstone
