#include "studies/compare/compared_files.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/error.h"
#include "render/files/hdf5_file.h"
#include "render/files/input_file.h"
#include "studies/case/log_silencer.h"

namespace gladstone::inline compare {
namespace {

/// Returns the path of a file that the case must contain.
/// @param command  command that creates it, for the message
/// @throws DataError if it does not exist
std::string made_file(std::string const& folder, char const* name, std::string const& command) {
  std::string path = in_case(folder, name);
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    throw DataError(ErrorCode::missing_file, path, "does not exist; create it with: " + command);
  return path;
}

/// Returns the path of the vectors.
/// @throws DataError if it does not exist
std::string vectors_path(std::string const& folder, std::string const& given) {
  if (given.empty()) return made_file(folder, case_file::vectors, "gladstone correlate " + folder);
  std::error_code error;
  if (!std::filesystem::exists(given, error))
    throw DataError(ErrorCode::missing_file, given, "does not exist; check --vectors");
  require_input_file(given, "a file of vectors");
  return given;
}

/// Adds the files named in the setup, which are read again.
/// @throws DataError if one differs from the file used for rendering
void add_inputs(SourceFiles& sources, std::string const& truth, std::string const& folder) {
  nlohmann::json const inputs = nlohmann::json::parse(Hdf5Reader(truth).attribute("inputs_sha256"), nullptr, false);
  if (!inputs.is_object()) return;
  for (auto const& [path, hash] : inputs.items()) {
    if (!std::filesystem::exists(path)) continue;  // reported by its reader
    sources.add("", path, SourceFiles::Holds::bytes);
    if (hash == sources.all().back().sha256) continue;
    throw DataError(ErrorCode::changed, path,
                    fmt::format("has changed since {} was rendered from it (another SHA-256 of its bytes); "
                                "restore the old file, or render the case again",
                                folder));
  }
}

}  // namespace

void require_unchanged_inputs(std::string const& folder) {
  SourceFiles sources;
  add_inputs(sources, in_case(folder, case_file::truth), folder);
}

ComparedFiles compared_files(std::string const& folder, std::string const& vectors) {
  ComparedFiles files;
  files.setup = in_case(folder, case_file::setup);
  files.truth = made_file(folder, case_file::truth, "gladstone render SETUP.toml -o " + folder);
  files.vectors = vectors_path(folder, vectors);
  bool const hdf5 = has_hdf5_ending(files.vectors);
  SourceFiles& sources = files.sources;
  sources.on_change("compare again, after gladstone correlate " + folder + " if the case was rendered again");
  sources.add("", files.setup, SourceFiles::Holds::bytes);
  sources.add("truth", files.truth, SourceFiles::Holds::datasets);
  sources.add("vectors", files.vectors);
  add_inputs(sources, files.truth, folder);
  if (!hdf5) files.unverified = files.vectors;
  if (!hdf5) return files;
  Hdf5Reader const truth(files.truth), measured(files.vectors);
  std::string const first = truth.attribute("reference_sha256"), second = truth.attribute("flow_sha256");
  bool const exchanged = !first.empty() && first != second && measured.attribute("reference_sha256") == second &&
                         measured.attribute("flow_sha256") == first;
  if (exchanged) {
    throw DataError(ErrorCode::inconsistent, files.vectors,
                    fmt::format("was measured from flow.tif to reference.tif of {0} (the frames were exchanged, and "
                                "every displacement has the opposite sign); run gladstone correlate {0} again",
                                folder));
  }
  for (std::string const frame : {"reference", "flow"}) {
    std::string const mine = truth.attribute(frame + "_sha256"), theirs = measured.attribute(frame + "_sha256");
    if (mine.empty() || theirs.empty()) {
      files.unverified = theirs.empty() ? files.vectors : files.truth;
    } else if (mine != theirs) {
      throw DataError(ErrorCode::inconsistent, files.vectors,
                      fmt::format("was measured on other frames than those of {} (the SHA-256 of the pixels of its {} "
                                  "frame is {:.12}..., not {:.12}...); run gladstone correlate {} again, or give "
                                  "vectors of deliberately changed frames as .csv",
                                  files.truth, frame, theirs, mine, folder));
    }
    if (!theirs.empty()) sources.add_known(frame, theirs);
  }
  return files;
}

PreparedCase prepare_stored_case(std::string const& folder) {
  require_unchanged_inputs(folder);
  LogSilencer const quiet;  // the warnings of the case are already in its summary.json
  CaseSetup loaded = load_case_setup(in_case(folder, case_file::setup), {});
  StrainMap const unused{};
  ReusableParts known;
  known.strain = &unused;
  return prepare_case(loaded, known);
}

}  // namespace gladstone::inline compare
