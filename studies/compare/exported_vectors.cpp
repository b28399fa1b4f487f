#include "studies/compare/exported_vectors.h"

#include <cmath>
#include <filesystem>

#include "render/base/error.h"
#include "studies/case/truth_file.h"
#include "studies/compare/compared_files.h"
#include "studies/compare/compared_vectors.h"
#include "studies/compare/displacement_truth.h"

namespace gladstone::inline compare {
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

/// Marks vectors without a displacement as invalid.
void judge_visibility(DisplacementField& field) {
  for (Vec2d const& shift : field.displacement_px) {
    bool const seen = std::isfinite(shift.x) && std::isfinite(shift.y);
    field.status.push_back(seen ? VectorStatus::valid : VectorStatus::invalid);
  }
}

DisplacementField vectors_of_truth(GroundTruth const& truth) {
  DisplacementField field;
  field.position_px = truth.reference_px;
  field.displacement_px = truth.displacement_px;
  field.sigma_px = truth.displacement_error_px;
  judge_visibility(field);
  return field;
}

DisplacementField vectors_of_map(Image<Vec2d> const& map, int spacing_px) {
  DisplacementField field;
  field.columns = map.columns();
  field.rows = map.rows();
  for (int row = 0; row < map.rows(); ++row)
    for (int column = 0; column < map.columns(); ++column)
      field.position_px.push_back({static_cast<double>(column) * spacing_px, static_cast<double>(row) * spacing_px});
  field.displacement_px.assign(map.begin(), map.end());
  judge_visibility(field);
  return field;
}

}  // namespace

bool is_truth_file(std::string const& path) {
  return has_hdf5_ending(path) && Hdf5Reader(path).attribute("filetype") == "gladstone truth";
}

ExportedVectors compute_map_for_export(std::string const& path, Renderer& renderer, TruthAt at, int spacing_px,
                                       TracedPixels traced) {
  ExportedVectors vectors;
  vectors.origin.filetype = "gladstone vectors";
  vectors.origin.sources.add("", path, SourceFiles::Holds::datasets);
  copy_provenance(Hdf5Reader(path), vectors.origin);
  std::string const folder = std::filesystem::path(path).parent_path().string();
  PreparedCase const prepared = prepare_stored_case(folder.empty() ? "." : folder);
  vectors.field =
      vectors_of_map(displacement_truth(prepared.scene, prepared.plan, renderer, at, spacing_px, traced), spacing_px);
  vectors.format = "gladstone truth";
  return vectors;
}

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
  vectors.origin.sources.add("", path);
  if (has_hdf5_ending(path)) {
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
  if (has_hdf5_ending(path) && !file.foreign) vectors.field.warnings = read_warnings(Hdf5Reader(path));
  return vectors;
}

}  // namespace gladstone::inline compare
