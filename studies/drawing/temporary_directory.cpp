#include "studies/drawing/temporary_directory.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "render/base/error.h"

namespace gladstone::inline drawing {
namespace {

constexpr char const* stem = ".gladstone.";

std::string folder_of_temporaries() {
  std::error_code error;
  std::filesystem::path const folder = std::filesystem::temp_directory_path(error);
  return error ? "/tmp" : folder.string();
}

}  // namespace

TemporaryDirectory::TemporaryDirectory() {
  std::string const above = folder_of_temporaries();
  int problem = 0;
  try {
    remove_abandoned_outputs(above, stem);
    partial_.emplace(above, stem, Partial::Kind::folder);
    path_ = partial_->path() + "/files";
    // Other users may only check the lock, which shows whether this process is running.
    if (::mkdir(path_.c_str(), 0700) != 0) problem = errno;
  } catch (std::system_error const& error) {
    problem = error.code().value();
  }
  if (problem == 0) return;
  throw OutputError(above, std::string("cannot create a temporary folder there (") + std::strerror(problem) +
                               "); set TMPDIR to a writable folder");
}

}  // namespace gladstone::inline drawing
