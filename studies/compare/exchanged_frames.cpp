#include "studies/compare/exchanged_frames.h"

#include <fmt/format.h>

#include <filesystem>

#include "render/files/hdf5_file.h"
#include "studies/case/case_files.h"

namespace gladstone::inline compare {

void warn_of_exchanged_frames(DisplacementField& field, SourceFiles const& sources) {
  namespace fs = std::filesystem;
  fs::path reference, flow;
  for (SourceFiles::Source const& source : sources.all()) {
    if (source.name == "reference") reference = source.path;
    if (source.name == "flow") flow = source.path;
  }
  bool exchanged = reference.filename() == case_file::flow && flow.filename() == case_file::reference;
  std::string const truth = (reference.parent_path() / case_file::truth).string();
  if (std::error_code error; !exchanged && !reference.empty() && fs::exists(truth, error)) {
    Hdf5Reader const file(truth);
    std::string const first = file.attribute("reference_sha256"), second = file.attribute("flow_sha256");
    exchanged =
        !first.empty() && first != second && sources.sha256("reference") == second && sources.sha256("flow") == first;
  }
  if (!exchanged) return;
  field.warnings.push_back({WarningCode::inconsistent, "",
                            fmt::format("the frames are exchanged: {} is the second frame (B) and {} the first (A), so "
                                        "that every displacement has the opposite sign; give frame A first",
                                        reference.string(), flow.string())});
}

}  // namespace gladstone::inline compare
