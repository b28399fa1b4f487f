#include "tests/fuzz/input.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "render/base/error.h"

namespace gladstone::fuzz {
namespace {

namespace fs = std::filesystem;

class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "gladstone_fuzz_XXXXXX").string();
    if (!::mkdtemp(name.data())) throw std::runtime_error("no folder for inputs can be made at " + name);
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  fs::path const& path() const { return path_; }

 private:
  fs::path path_;
};

void check_text(std::string_view message, std::string_view input) {
  for (std::string_view const foreign : {"std::", "basic_", "[json.exception", "filesystem error"}) {
    if (message.find(foreign) == std::string_view::npos || input.find(foreign) != std::string_view::npos) continue;
    std::fprintf(stderr, "a library's text reaches the user: %.*s\n", static_cast<int>(message.size()), message.data());
    std::abort();
  }
}

}  // namespace

void read(std::string_view input, std::function<void()> const& reader) {
  try {
    reader();
  } catch (SetupError const& error) {
    check_text(error.what(), input);
  } catch (DataError const& error) {
    check_text(error.what(), input);
  }
}

std::string file_of(std::string_view content, std::string const& name) {
  static Folder const folder;
  std::string const path = (folder.path() / name).string();
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file.write(content.data(), static_cast<std::streamsize>(content.size())).flush()) {
    throw std::runtime_error("an input cannot be written to " + path);
  }
  return path;
}

}  // namespace gladstone::fuzz
