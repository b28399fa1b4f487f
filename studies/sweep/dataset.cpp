#include "studies/sweep/dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "render/base/error.h"
#include "render/base/progress.h"
#include "render/files/hdf5_axes.h"
#include "render/files/hdf5_file.h"
#include "render/files/image_file.h"
#include "render/files/output_destination.h"
#include "render/files/text_file.h"
#include "studies/case/case.h"
#include "studies/case/case_files.h"
#include "studies/compare/compared_files.h"
#include "studies/compare/displacement_truth.h"
#include "studies/sweep/run.h"
#include "studies/sweep/study_columns.h"

namespace gladstone::inline sweep {
namespace {

namespace fs = std::filesystem;

/// Spacing of the displacement maps [px]. PIV maps have every pixel, since the flow is known everywhere; BOS maps have
/// every fourth, since every node is a dot that must be traced through the medium.
constexpr int piv_spacing_px = 1, bos_spacing_px = 4;
/// Number of rows per HDF5 chunk of the lists.
constexpr std::size_t list_chunk = 8192;

/// Case with a stored folder, and its number of sources (dots or particles).
struct CaseWithImages {
  std::string folder;
  std::string sources;  ///< "/dots" or "/particles"
  std::size_t count = 0;
};

std::optional<CaseWithImages> case_with_images(std::string const& folder) {
  std::error_code error;
  if (!fs::exists(fs::path(folder) / case_file::setup, error)) return std::nullopt;
  Hdf5Reader const truth(in_case(folder, case_file::truth));
  for (char const* sources : {"/dots", "/particles"}) {
    std::string const name = std::string(sources) + "/displacement_px";
    if (truth.has(name)) return CaseWithImages{folder, sources, truth.shape(name)[0]};
  }
  throw DataError(ErrorCode::missing_content, (fs::path(folder) / case_file::truth).string(),
                  "contains neither the truth of dots nor that of particles");
}

/// Reads the grey levels of both frames of a case. @throws DataError if their size differs from that of the first case
std::vector<std::uint16_t> read_frames(CaseWithImages const& one, std::vector<std::size_t> const& size) {
  std::vector<std::uint16_t> both;
  for (char const* name : {case_file::reference, case_file::flow}) {
    std::string const path = in_case(one.folder, name);
    Image<std::uint16_t> const image = integer_levels(read_levels(path));
    if (static_cast<std::size_t>(image.rows()) != size[0] || static_cast<std::size_t>(image.columns()) != size[1]) {
      throw DataError(ErrorCode::wrong_shape, path,
                      fmt::format("has {} x {} px, but the first case's images {} x {}; a data set contains images of "
                                  "one size: pack a study whose camera.pixels are the same in all cases",
                                  image.columns(), image.rows(), size[1], size[0]));
    }
    both.insert(both.end(), image.begin(), image.end());
  }
  return both;
}

/// Displacement map of the data set: name, image to which its positions refer, and a description of the positions.
struct DisplacementMapName {
  char const* name;
  TruthAt at;
  char const* place;
};
constexpr std::array maps{
    DisplacementMapName{"/displacement_px", TruthAt::reference,
                        "frame A: displacement of the point that the first frame shows at this pixel"},
    DisplacementMapName{
        "/displacement_mid_px", TruthAt::mid_position,
        "mid-time: displacement of the point whose images in both frames have this pixel as their midpoint"},
};

std::vector<double> numbers_of(Image<Vec2d> const& map) {
  std::vector<double> numbers;
  numbers.reserve(2 * map.size());
  for (Vec2d const& d : map) numbers.insert(numbers.end(), {d.x, d.y});
  return numbers;
}

/// Cases of a study whose images were kept.
struct KeptCases {
  std::vector<CaseWithImages> cases;
  StudyTable table;         ///< table of the study with the rows of these cases only
  std::size_t without = 0;  ///< number of cases without images

  std::string const& sources() const { return cases.front().sources; }
};

/// Finds the finished cases of a study whose images are on disk (`sweep run --keep-images`).
/// @throws DataError if no case has images
KeptCases find_kept(std::string const& run) {
  KeptCases kept{{}, read_study_table(run)};
  std::vector<StudyRow> rows;
  for (StudyRow const& row : kept.table.rows) {
    if (row.status != CaseStatus::ok) continue;
    if (std::optional<CaseWithImages> one = case_with_images(images_folder(run, row.index))) {
      kept.cases.push_back(std::move(*one));
      rows.push_back(row);
    }
  }
  kept.without = kept.table.rows.size() - kept.cases.size();
  if (kept.cases.empty()) {
    throw DataError(ErrorCode::missing_content, run,
                    "contains no images of cases; compute them with gladstone sweep run --keep-images");
  }
  kept.table.rows = std::move(rows);
  return kept;
}

/// Sizes of the arrays of a data set.
struct DatasetSizes {
  std::vector<std::size_t> pixels;  ///< rows and columns of an image
  std::size_t spacing = 1;          ///< distance between the nodes of the displacement maps [px]
  std::vector<std::int64_t> begin;  ///< first source of each case, and the number of all sources

  std::size_t cases() const { return begin.size() - 1; }
  /// Rows and columns of a displacement map.
  std::vector<std::size_t> nodes() const {
    return {(pixels[0] + spacing - 1) / spacing, (pixels[1] + spacing - 1) / spacing};
  }
};

/// @throws DataError if the truth of the cases differs in kind
DatasetSizes determine_sizes(KeptCases const& kept, std::string const& run) {
  DatasetSizes sizes;
  sizes.begin = {0};
  for (CaseWithImages const& one : kept.cases) {
    sizes.begin.push_back(sizes.begin.back() + static_cast<std::int64_t>(one.count));
  }
  Image<std::uint16_t> const sample =
      integer_levels(read_levels(in_case(kept.cases.front().folder, case_file::reference)));
  sizes.pixels = {static_cast<std::size_t>(sample.rows()), static_cast<std::size_t>(sample.columns())};
  for (CaseWithImages const& one : kept.cases) {
    if (one.sources == kept.sources()) continue;
    throw DataError(ErrorCode::inconsistent, run,
                    "has cases of BOS and of PIV, whose truth differs in kind; pack studies of one experiment");
  }
  sizes.spacing = static_cast<std::size_t>(kept.sources() == "/particles" ? piv_spacing_px : bos_spacing_px);
  return sizes;
}

/// Creates the arrays of images and truth, which write_packed_case() fills.
void make_arrays(Hdf5Writer& file, DatasetSizes const& sizes) {
  std::vector<std::size_t> const& size = sizes.pixels;
  std::vector<std::size_t> const nodes = sizes.nodes();
  std::size_t const cases = sizes.cases();
  auto const all = static_cast<std::size_t>(sizes.begin.back());
  file.make_rows<std::uint16_t>("/images", {cases, 2, size[0], size[1]}, {1, 1, size[0], size[1]}, "1",
                                "grey levels as in reference.tif and flow.tif", "case, frame, row, column");
  for (DisplacementMapName const& map : maps) {
    file.make_rows<double>(map.name, {cases, nodes[0], nodes[1], 2}, {1, nodes[0], nodes[1], 2}, "px",
                           "true displacement from flow, medium and camera, on a lattice of pixels",
                           "case, row, column, component (u right, v down)");
    file.attribute(map.name, "spacing_px", static_cast<double>(sizes.spacing));
    file.attribute(map.name, "place", map.place);
  }
  std::size_t const chunk = std::clamp<std::size_t>(all, 1, list_chunk);
  for (char const* name : {"/truth/reference_px", "/truth/displacement_px"}) {
    file.make_rows<double>(name, {all, 2}, {chunk, 2}, "px", "of every dot or particle, case by case",
                           "source, component (x right, y down)");
  }
  file.make_rows<double>("/truth/flux", {all, 2}, {chunk, 2}, "fully lit px; for particles photons",
                         "light of every dot or particle, case by case", "source, frame");
  file.write("/truth/begin", sizes.begin, {sizes.begin.size()}, "1",
             "sources of case i are rows begin[i] to begin[i + 1] - 1", "case");
}

/// Writes images and truth of case i. @throws DataError if its files have changed meanwhile
void write_packed_case(Hdf5Writer& file, std::size_t i, CaseWithImages const& one, DatasetSizes const& sizes,
                       Renderer& renderer) {
  file.write_rows<std::uint16_t>("/images", i, read_frames(one, sizes.pixels));
  Hdf5Reader const truth(in_case(one.folder, case_file::truth));
  std::vector<double> const place = truth.read(one.sources + "/reference_px");
  std::vector<double> const displacement = truth.read(one.sources + "/displacement_px");
  std::vector<double> const flux = truth.read(one.sources + "/flux");
  if (place.size() != 2 * one.count || displacement.size() != place.size() || flux.size() != place.size()) {
    throw DataError(ErrorCode::changed, in_case(one.folder, case_file::truth),
                    "was replaced while it was read; pack the study again");
  }
  auto const row = static_cast<std::size_t>(sizes.begin[i]);
  file.write_rows<double>("/truth/reference_px", row, place);
  file.write_rows<double>("/truth/displacement_px", row, displacement);
  file.write_rows<double>("/truth/flux", row, flux);
  PreparedCase const prepared = prepare_stored_case(one.folder);
  for (DisplacementMapName const& map : maps) {
    file.write_rows<double>(map.name, i,
                            numbers_of(displacement_truth(prepared.scene, prepared.plan, renderer, map.at,
                                                          static_cast<int>(sizes.spacing))));
  }
}

}  // namespace

void refuse_files_of_study(std::string const& run, std::string const& path) {
  std::vector<std::string> inputs;
  for (char const* file :
       {run_file::study, run_file::manifest, run_file::table, run_file::table_text, run_file::points_text})
    inputs.push_back((fs::path(run) / file).string());
  refuse_inputs_as_outputs({path}, inputs);
}

PackedDataset pack_dataset(std::string const& run, std::string const& path, Renderer& renderer) {
  refuse_files_of_study(run, path);
  KeptCases const kept = find_kept(run);
  DatasetSizes const sizes = determine_sizes(kept, run);
  std::string const study = (fs::path(run) / run_file::study).string();
  std::error_code error;
  SourceFiles sources;
  sources.add("manifest", (fs::path(run) / run_file::manifest).string(), SourceFiles::Holds::bytes);
  StudyRow const& first = kept.table.rows.front();
  Hdf5Writer file(path,
                  {"gladstone dataset", 2, fs::exists(study, error) ? read_text_file(study) : "", first.seed,
                   first.device(), sources},
                  Hdf5Growth::on_disk);
  Hdf5Axes axes(file);
  write_columns(file, axes, "/parameters/", "case", kept.table, axis_columns(kept.table));
  axes.attach();
  make_arrays(file, sizes);
  Progress progress("packing", sizes.cases());
  for (std::size_t i = 0; i < sizes.cases(); ++i) {
    write_packed_case(file, i, kept.cases[i], sizes, renderer);
    progress.advance(1);
  }
  file.close();
  return {kept.cases.size(), kept.without};
}

}  // namespace gladstone::inline sweep
