#include "studies/compare/sequence_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/error.h"
#include "render/base/version.h"
#include "render/files/file_kind.h"
#include "render/files/file_lock.h"
#include "render/files/output_destination.h"
#include "render/files/output_file.h"
#include "render/files/visible_files.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_json.h"
#include "studies/case/warning_log.h"

namespace gladstone::inline compare {
namespace {

namespace fs = std::filesystem;

/// Returns the name of a state in sequence.json.
char const* state_name(PairState state) {
  switch (state) {
    case PairState::pending:
      return "pending";
    case PairState::done:
      return "done";
    case PairState::no_valid_vector:
      return "no valid vector";
    case PairState::failed:
      break;
  }
  return "failed";
}

/// Returns the name of a pairing, as in --pairing.
char const* pairing_name(Pairing pairing) {
  switch (pairing) {
    case Pairing::pairs:
      return "pairs";
    case Pairing::reference:
      return "reference";
    case Pairing::consecutive:
      break;
  }
  return "consecutive";
}

nlohmann::json describe_frame(SequenceFrame const& frame, std::string const& sha256) {
  if (frame.path.empty()) return nullptr;
  nlohmann::json json{{"file", frame.path}};
  if (frame.pages > 1) json["page"] = frame.page + 1;
  if (!sha256.empty()) json["sha256"] = sha256;
  return json;
}

}  // namespace

SequenceFolder::SequenceFolder(std::string const& path) {
  OutputDestination const place(path);
  path_ = place.path();
  std::error_code error;
  if (fs::exists(path_, error) && !fs::is_directory(path_, error))
    throw OutputError(path, "is a file (a sequence has one file of vectors per pair); name a folder");
  if (contains_visible_files(path_) && !fs::exists(file(sequence_file::state), error))
    throw OutputError(path, "contains other files (it has no sequence.json); name a new folder");
  fs::create_directories(path_, error);
  if (error) place.fail("cannot be created", error.value());
  lock_path_ = file(".lock");
  lock();
}

SequenceFolder::~SequenceFolder() {
  ::unlink(lock_path_.c_str());
  ::close(lock_);
}

void SequenceFolder::lock() {
  // The previous owner removes the file when it ends: repeat until the locked file is the one in the folder.
  for (int attempt = 0; attempt < 5; ++attempt) {
    lock_ = ::open(lock_path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (int const error = errno; lock_ < 0) OutputDestination(path_).fail("cannot be written", error);
    // Other errors mean that the file system has no locks: then the folder is used without one.
    if (lock_bytes(lock_, 0, 1) == EAGAIN) {
      ::close(lock_);
      throw OutputError(path_, "is being written by another gladstone correlate; wait until it ends");
    }
    if (leads_to(lock_path_, lock_)) return;
    ::close(lock_);
  }
  throw OutputError(path_, "cannot be locked (other processes replace its file .lock); name another folder");
}

std::string SequenceFolder::file(std::string const& name) const { return (fs::path(path_) / name).string(); }

void SequenceFolder::make_folder(std::string const& name) const {
  std::error_code error;
  fs::create_directories(file(name), error);
  if (error) OutputDestination(file(name)).fail("cannot be created", error.value());
}

void remove_damaged_result(std::string const& path) {
  if (file_kind(path) != damaged_hdf5) return;
  log_warning({WarningCode::incomplete, path, "the file is damaged, and is computed again"});
  std::error_code ignored;  // the file that replaces it reports the error
  fs::remove(path, ignored);
}

void write_sequence_state(std::string const& path, SequenceState const& state, std::vector<PairRecord> const& pairs) {
  nlohmann::json list = nlohmann::json::array();
  for (PairRecord const& record : pairs) {
    nlohmann::json entry{{"vectors", record.has_vectors() ? nlohmann::json(record.pair.vectors) : nullptr},
                         {"reference", describe_frame(record.pair.reference, record.reference_sha256)},
                         {"flow", describe_frame(record.pair.flow, record.flow_sha256)},
                         {"state", state_name(record.state)},
                         {"warnings", to_strings(record.warnings)},
                         {"warning_records", record.warnings}};
    if (!record.error.empty()) entry["error"] = record.error;
    list.push_back(std::move(entry));
  }
  nlohmann::json const json{{"filetype", "gladstone sequence"},
                            {"version", 1},
                            {"software_version", version},
                            {"git_sha1", git_sha1},
                            {"pairing", pairing_name(state.pairing)},
                            {"complete", state.complete},
                            {"pixels", {state.columns, state.rows}},
                            {"settings", state.settings},
                            {"settings_sha256", state.settings_sha256},
                            {"pairs", std::move(list)}};
  OutputFile::write_text(path, json_text(json) + '\n');
}

}  // namespace gladstone::inline compare
