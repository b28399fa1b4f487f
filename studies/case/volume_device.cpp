#include "studies/case/volume_device.h"

#include <spdlog/spdlog.h>

#include "cuda/backend.h"
#include "render/base/error.h"
#include "render/base/parallel.h"

namespace gladstone {

tomography::SartVolumeMaker open_volume_device(std::string const& wanted) {
  std::string instead;
  if (wanted != "cpu") {
    cuda::DeviceState const state = cuda::device_state();
    if (state.usable) {
      spdlog::info("device: cuda, {}", state.text);
      return cuda::make_volume;
    }
    if (wanted == "cuda") throw DeviceError("--device cuda: " + state.text + "; use --device cpu or auto");
    instead = " (" + state.text + ")";
  }
  spdlog::info("device: cpu, {} threads{}", thread_count(), instead);
  return tomography::make_host_volume;
}

}  // namespace gladstone
