#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

#include "cuda/backend.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/version.h"
#include "studies/commands/command.h"
#include "studies/version_text.h"

namespace gladstone {

std::unique_ptr<Renderer> GlobalOptions::renderer() const {
  if (device != "cpu") {
    cuda::DeviceState const state = cuda::device_state();
    if (state.usable) {
      spdlog::info("device: cuda, {}", state.text);
      return cuda::make_renderer();
    }
    if (device == "cuda") throw DeviceError("--device cuda: " + state.text + "; use --device cpu or auto");
    spdlog::info("device: cpu, {} threads ({})", thread_count(), state.text);
  } else {
    spdlog::info("device: cpu, {} threads", thread_count());
  }
  return std::make_unique<CpuRenderer>();
}

std::string version_text() {
  return fmt::format("gladstone {} ({})\nbackends: {}\nCUDA: {}", version, git_sha1,
                     cuda::compiled_in() ? "cpu, cuda" : "cpu", cuda::description());
}

std::string version_json() {
  return nlohmann::json{{"version", version},
                        {"commit", git_sha1},
                        {"backends", cuda::compiled_in() ? nlohmann::json{"cpu", "cuda"} : nlohmann::json{"cpu"}},
                        {"cuda", cuda::description()}}
      .dump(2);
}

}  // namespace gladstone
