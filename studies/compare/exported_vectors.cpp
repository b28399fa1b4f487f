#include "studies/compare/exported_vectors.h"

#include <cmath>

#include "render/base/error.h"
#include "studies/case/truth_file.h"
#include "studies/compare/compared_vectors.h"

namespace gladstone {
namespace {

/// Adds the attributes that vectors.h5 and truth.h5 have in common: settings, device, and hashes of the frames.
void copy_provenance(Hdf5Reader const& file, FileOrigin& origin) {
  origin.setup = file.attribute("setup");
  origin.device = file.attribute("device");
  for (char const* const name : {"reference", "flow"}) {
    std::string const hash = file.attribute(std::string(name) + "_sha256");
    if (!hash.empty()) origin.sources.add_known(name, hash);
  }
}

DisplacementField vectors_of_truth(GroundTruth const& truth) {
  DisplacementField field;
  field.position_px = truth.reference_px;
  field.displacement_px = truth.displacement_px;
  field.sigma_px = truth.displacement_error_px;
  for (Vec2d const& shift : truth.displacement_px) {
    bool const seen = std::isfinite(shift.x) && std::isfinite(shift.y);
    field.status.push_back(seen ? VectorStatus::valid : VectorStatus::invalid);
  }
  return field;
}

}  // namespace

ExportedComponents load_components_for_export(std::string const& path) {
  ExportedComponents exported;
  exported.origin.filetype = "gladstone three components";
  exported.origin.sources.add("stereo", path, SourceFiles::Holds::datasets);
  copy_provenance(Hdf5Reader(path), exported.origin);
  exported.field = read_three_components(path);
  return exported;
}

ExportedVectors load_for_export(std::string const& path, std::string const& conventions, int image_rows) {
  ExportedVectors vectors;
  vectors.origin.filetype = "gladstone vectors";
  bool const hdf5 = path.ends_with(".h5") || path.ends_with(".hdf5");
  vectors.origin.sources.add("", path, hdf5 ? SourceFiles::Holds::datasets : SourceFiles::Holds::bytes);
  if (hdf5) {
    Hdf5Reader const file(path);
    copy_provenance(file, vectors.origin);
    if (file.attribute("filetype") == "gladstone truth") {
      vectors.field = vectors_of_truth(read_truth(path));
      vectors.format = "gladstone truth";
      return vectors;
    }
  }
  VectorFile file = read_vectors(path);
  log_remarks(file);
  if (!conventions.empty()) override_conventions(file, conventions);
  file = convert_to_pixels(std::move(file), path);
  if (file.conventions.y_up && file.conventions.mirror == VectorConventions::Mirror::image && image_rows <= 0) {
    throw DataError(ErrorCode::undetermined, path,
                    "counts y upwards from the last row of the image, whose number of rows is unknown; specify it with "
                    "--image-rows");
  }
  vectors.format = file.format;
  vectors.foreign = file.foreign;
  vectors.complete = file.complete;
  vectors.conventions = describe(file.conventions);
  vectors.field = apply_conventions(std::move(file.field), file.conventions, image_rows);
  if (hdf5 && !file.foreign) {
    Hdf5Reader const own(path);
    vectors.field.verdict = own.attribute("verdict");
    std::string const warnings = own.attribute("warnings");
    if (!warnings.empty()) vectors.field.warnings = {warnings};
  }
  return vectors;
}

}  // namespace gladstone
