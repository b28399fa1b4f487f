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
  if (device == "cuda") {
    throw DeviceError("--device cuda: this gladstone has no GPU renderer (" + cuda::description() +
                      "); use --device cpu or auto");
  }
  spdlog::info("device: cpu, {} threads", thread_count());
  return std::make_unique<CpuRenderer>();
}

std::string version_text() {
  return fmt::format("gladstone {} ({})\nbackends: cpu\nCUDA: {}", version, git_sha1, cuda::description());
}

std::string version_json() {
  return nlohmann::json{
      {"version", version}, {"commit", git_sha1}, {"backends", {"cpu"}}, {"cuda", cuda::description()}}
      .dump(2);
}

}  // namespace gladstone
