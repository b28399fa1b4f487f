#include "render/files/visible_files.h"

#include <system_error>

namespace gladstone::inline files {

namespace fs = std::filesystem;

bool contains_visible_files(fs::path const& folder) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (!entry->path().filename().string().starts_with('.')) return true;
  return false;
}

}  // namespace gladstone::inline files
