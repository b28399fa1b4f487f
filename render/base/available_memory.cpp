#include "render/base/available_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "render/base/error.h"

namespace gladstone::inline base {

double available_memory() {
  double available = std::numeric_limits<double>::infinity();
  std::ifstream meminfo("/proc/meminfo");
  std::string key, unit_name;
  double kilobytes = 0;
  while (meminfo >> key >> kilobytes) {
    std::getline(meminfo, unit_name);
    if (key == "MemAvailable:") available = kilobytes * 1024;
  }
  std::ifstream limit_file("/sys/fs/cgroup/memory.max"), usage_file("/sys/fs/cgroup/memory.current");
  double limit = 0, usage = 0;
  if (limit_file >> limit && usage_file >> usage) available = std::min(available, limit - usage);
  return available;
}

void require_memory(std::string const& path, std::string const& what, double bytes) {
  constexpr double always_there = 64e6;
  if (bytes <= always_there) return;
  double const available = available_memory();
  if (bytes <= available) return;
  throw DataError(ErrorCode::memory, path,
                  fmt::format("{} needs {:.3g} GB of memory ({:.3g} GB are available); give a smaller file, or "
                              "use a machine with more",
                              what, bytes / 1e9, available / 1e9));
}

}  // namespace gladstone::inline base
