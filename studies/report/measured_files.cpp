#include "studies/report/measured_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "analysis/vectors/vector_file.h"
#include "analysis/vectors/vector_screening.h"
#include "render/base/error.h"
#include "render/files/hdf5_file.h"
#include "studies/case/case_files.h"
#include "studies/case/warning_log.h"
#include "studies/compare/compared_vectors.h"

namespace gladstone::inline report {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<char const*, char const*>, 2> frame_files{
    {{"reference", case_file::reference}, {"flow", case_file::flow}}};

std::string pixels_of(CameraSetup const& camera) { return fmt::format("{} x {} px", camera.columns, camera.rows); }

/// Rejects vectors that lie or point outside the image.
/// @throws DataError if positions do not match this camera
void screen(VectorFile& file, std::string const& path, std::string const& setup, CameraSetup const& camera) {
  RejectedVectors const left_out = screen_vectors(file.field, file.conventions.offset_px, camera.columns, camera.rows);
  if (left_out.outside_image > 0) {
    throw DataError(
        ErrorCode::inconsistent, path,
        fmt::format("has {} of {} vectors outside the {} of the camera of {} (their x from {:.6g} to {:.6g}, y "
                    "from {:.6g} to {:.6g}); set camera.pixels = [columns, rows] there to the size of the "
                    "correlated frames, or, if positions have another origin, use --conventions offset=NUMBER",
                    left_out.outside_image, left_out.all() + file.field.size(), pixels_of(camera), setup,
                    left_out.low_px.x, left_out.high_px.x, left_out.low_px.y, left_out.high_px.y));
  }
  std::string const refusal = reason_to_reject_positions(file.field, left_out, camera.columns, camera.rows);
  if (!refusal.empty()) throw DataError(ErrorCode::inconsistent, path, refusal);
  if (left_out.without_place() + left_out.displacement_beyond_image > 0) {
    log_warning({WarningCode::excluded, path, "vectors are excluded: " + left_out.text()});
  }
  std::string const doubt = describe_suspect_positions(file.field, camera.columns, camera.rows);
  if (!doubt.empty()) log_warning({WarningCode::implausible, path, doubt});
}

/// Vectors of one file in our conventions.
struct MeasuredVectorFile {
  DisplacementField field;
  bool complete = true;  ///< false: the file's header declares another number of vectors
};

MeasuredVectorFile read_measured(std::string const& path, std::string const& setup, ReportOptions const& options,
                                 CameraSetup const& camera) {
  VectorFile file = read_vectors(path);
  log_remarks(file);
  if (!options.conventions.empty()) override_conventions(file, options.conventions);
  file = convert_to_pixels(std::move(file), path);
  screen(file, path, setup, camera);
  DisplacementField field = file.foreign || !options.conventions.empty()
                                ? apply_conventions(std::move(file.field), file.conventions, camera.rows)
                                : std::move(file.field);
  if (field.columns == 0) arrange_as_grid(field);
  return {std::move(field), file.complete};
}

/// Returns true if all components are bitwise equal, with NaN equal to NaN.
bool same_vectors(DisplacementField const& a, DisplacementField const& b) {
  auto const same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return std::equal(a.displacement_px.begin(), a.displacement_px.end(), b.displacement_px.begin(),
                    b.displacement_px.end(),
                    [&](Vec2d const& x, Vec2d const& y) { return same(x.x, y.x) && same(x.y, y.y); });
}

}  // namespace

MeasuredFiles measured_files(ReportOptions const& options) {
  MeasuredFiles files;
  files.setup = (fs::path(options.source) / case_file::setup).string();
  files.vectors = options.vectors.empty() ? in_case(options.source, case_file::vectors) : options.vectors;
  files.repeats = options.repeats;
  if (!fs::exists(files.vectors)) {
    throw DataError(ErrorCode::missing_file, files.vectors,
                    options.vectors.empty()
                        ? "does not exist; measure the displacement with gladstone correlate REFERENCE FLOW -o " +
                              files.vectors + ", or name a file with --vectors"
                        : "does not exist; check --vectors");
  }
  files.sources.on_change("write the report again");
  files.sources.add("setup", files.setup, SourceFiles::Holds::bytes);
  bool const frames = std::all_of(frame_files.begin(), frame_files.end(), [&](auto const& frame) {
    return fs::exists(fs::path(options.source) / frame.second);
  });
  auto const read = [&](std::size_t i) {
    auto const& [name, file] = frame_files[i];
    return files.sources.add_image(name, (fs::path(options.source) / file).string());
  };
  if (frames) files.frames = FramePair<double>{read(0), read(1)};
  files.sources.add("vectors", files.vectors);
  for (std::size_t i = 0; i < files.repeats.size(); ++i)
    files.sources.add(fmt::format("repeat {}", i + 2), files.repeats[i]);
  return files;
}

void check_frames_match_camera(MeasuredFiles const& files, ReportOptions const& options, CameraSetup const& camera) {
  if (!files.frames) return;
  for (std::size_t i = 0; i < frame_files.size(); ++i) {
    auto const& [name, file] = frame_files[i];
    std::string const path = (fs::path(options.source) / file).string();
    Image<double> const& frame = i == 0 ? files.frames->reference : files.frames->flow;
    if (frame.columns() != camera.columns || frame.rows() != camera.rows) {
      throw DataError(
          ErrorCode::wrong_shape, path,
          fmt::format("has {} x {} px, the camera of {} has {}; set camera.pixels = [{}, {}] there, "
                      "or use frames of this camera",
                      frame.columns(), frame.rows(), files.setup, pixels_of(camera), frame.columns(), frame.rows()));
    }
    std::string const told = has_hdf5_ending(files.vectors)
                                 ? Hdf5Reader(files.vectors).attribute(std::string(name) + "_sha256")
                                 : std::string();
    if (told.empty() || told == files.sources.sha256(name)) continue;
    throw DataError(
        ErrorCode::changed, files.vectors,
        fmt::format("was measured on another {} frame than {} (the SHA-256 of its pixels is {:.12}..., not {:.12}...); "
                    "correlate the frames of the folder again, or restore the frames of the vectors",
                    name, path, told, files.sources.sha256(name)));
  }
}

RepeatedVectors read_repeats(MeasuredFiles const& files, ReportOptions const& options, CameraSetup const& camera) {
  RepeatedVectors read;
  std::vector<DisplacementField>& all = read.fields;
  auto const read_one = [&](std::string const& path) {
    MeasuredVectorFile one = read_measured(path, files.setup, options, camera);
    if (!one.complete) read.incomplete.push_back(path);
    return std::move(one.field);
  };
  all.push_back(read_one(files.vectors));
  for (std::string const& file : files.repeats) {
    DisplacementField one = read_one(file);
    bool same = one.size() == all.front().size();
    for (std::size_t i = 0; same && i < one.size(); ++i) {
      same = length(one.position_px[i] - all.front().position_px[i]) < 1e-3;
    }
    if (!same) {
      throw DataError(
          ErrorCode::inconsistent, file,
          "has its vectors at other positions than " + files.vectors +
              " (the scatter of repeats is determined at every vector); correlate all of them with one configuration");
    }
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (!same_vectors(all[k], one)) continue;
      throw DataError(ErrorCode::inconsistent, file,
                      "has the same vectors as " + (k == 0 ? files.vectors : files.repeats[k - 1]) +
                          " (a repeat must be another measurement); remove it");
    }
    all.push_back(std::move(one));
  }
  return read;
}

double spanned_share(DisplacementField const& field, CameraSetup const& camera) {
  if (field.size() == 0) return 0;
  Vec2d low = field.position_px.front(), high = low;
  for (Vec2d const& p : field.position_px) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  return (high.x - low.x) * (high.y - low.y) / (static_cast<double>(camera.columns) * camera.rows);
}

}  // namespace gladstone::inline report
