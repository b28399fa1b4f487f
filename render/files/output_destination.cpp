#include "render/files/output_destination.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "render/base/error.h"

namespace gladstone::inline files {
namespace {

namespace fs = std::filesystem;

/// Resolves all symbolic links of a path, including a last one whose target does not exist yet.
/// @param asked  path for messages
fs::path resolved(fs::path place, std::string const& asked) {
  std::error_code error;
  for (int links = 0; links < 40; ++links) {
    fs::path const folder = fs::weakly_canonical(place.parent_path(), error);
    if (!error && place.has_filename()) place = folder / place.filename();
    // A process that has the file open would not see its replacement.
    if (place.string().starts_with("/proc/") && place.string().find("/fd/") != std::string::npos) {
      throw OutputError(asked, "is a file or pipe that a process has open; name another file");
    }
    fs::path const target = fs::read_symlink(place, error);
    if (error) return place;
    place = target.is_absolute() ? target : folder / target;
    if (!place.has_filename()) place = place.parent_path();
  }
  throw OutputError(asked, "cannot be written (its symbolic links form a circle); choose another path");
}

}  // namespace

OutputDestination::OutputDestination(std::string path) : asked_(std::move(path)) {
  if (asked_.empty()) throw OutputError("output", "has an empty name; give a name");
  std::error_code error;
  fs::path place = fs::absolute(asked_, error);
  if (error) throw OutputError(asked_, "cannot be written (the working folder is gone); change to another one");
  while (asked_.size() > 1 && asked_.back() == '/') asked_.pop_back();
  if (!place.has_filename()) place = place.parent_path();
  if (place.filename() == "." || place.filename() == "..") place = fs::weakly_canonical(place, error);
  place = resolved(place, asked_);
  if (!place.has_filename()) throw OutputError(asked_, "cannot be written; name a file or folder in it");
  path_ = place.string();
}

std::string OutputDestination::folder() const { return fs::path(path_).parent_path().string(); }
std::string OutputDestination::name() const { return fs::path(path_).filename().string(); }

void OutputDestination::make_parents() {
  std::vector<fs::path> missing;
  std::error_code ignored;
  for (fs::path above = folder(); !fs::exists(above, ignored) && above.has_filename(); above = above.parent_path()) {
    missing.push_back(above);
  }
  for (auto above = missing.rbegin(); above != missing.rend(); ++above) {
    if (::mkdir(above->c_str(), 0777) == 0) {
      made_.push_back(above->string());
    } else if (errno != EEXIST) {
      int const error = errno;
      remove_made_parents();
      asked_ = above->string();
      fail("the folder cannot be created", error);
    }
  }
}

void OutputDestination::remove_made_parents() const {
  for (auto above = made_.rbegin(); above != made_.rend(); ++above) ::rmdir(above->c_str());
}

void OutputDestination::fail(std::string const& what, int error) const {
  std::string hint;
  if (error == ENOSPC || error == EDQUOT) hint = "; free some space or choose another folder";
  if (error == EACCES || error == EPERM || error == EROFS) hint = "; choose a folder that you may write to";
  if (error == ENOENT) hint = "; choose a path where a folder can be created";
  if (error == ENOTDIR) hint = "; a part of the path is a file";
  if (error == EFBIG) hint = "; raise the limit on the size of files (ulimit -f)";
  if (error == ENAMETOOLONG) hint = "; choose a shorter name";
  throw OutputError(asked_, what + " (" + std::strerror(error) + ')' + hint);
}

std::string special_file(std::string const& path) {
  struct stat there {};
  if (::stat(path.c_str(), &there) != 0 || S_ISREG(there.st_mode) || S_ISDIR(there.st_mode)) return "";
  if (S_ISFIFO(there.st_mode)) return "a pipe";
  return S_ISSOCK(there.st_mode) ? "a socket" : "a device";
}

void refuse_overwriting(std::string const& input, std::string const& output) {
  throw OutputError(ErrorCode::overwrites_input, output,
                    "would be overwritten, but is an input of this command" +
                        (output == input ? std::string() : " (as " + input + ')') + "; choose another output");
}

void refuse_inputs_as_outputs(std::vector<std::string> const& outputs, std::vector<std::string> const& inputs) {
  std::error_code error;
  for (std::string const& output : outputs) {
    for (std::string const& input : inputs) {
      bool const same = fs::equivalent(output, input, error) && !error;
      if (!same) continue;
      refuse_overwriting(input, output);
    }
  }
}

}  // namespace gladstone::inline files
