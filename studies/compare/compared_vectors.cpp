#include "studies/compare/compared_vectors.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "analysis/errors/scattered_grid.h"
#include "analysis/vectors/convention_report.h"
#include "render/base/error.h"
#include "render/files/hdf5_file.h"
#include "render/files/source_files.h"
#include "studies/case/correlation_setup.h"
#include "studies/case/warning_log.h"

namespace gladstone::inline compare {
namespace {

/// Ray truth of the dots interpolated on a regular lattice, for fast evaluation anywhere in the view.
class TruthMap {
 public:
  TruthMap(GroundTruth const& truth, CameraSetup const& camera)
      : grid_{camera.columns / spacing + 1, camera.rows / spacing + 1, {0, 0}, spacing},
        maps_(map_scattered(near_view(truth.reference_px, camera), truth.displacement_px, grid_)) {}

  /// Interpolates bilinearly, so that offsets of half a pixel are detectable. Returns NaN outside the view, beyond a
  /// margin for the different pixel conventions of codes.
  Vec2d at(Vec2d c) const {
    Vec2d const last{spacing * (grid_.columns - 1.0), spacing * (grid_.rows - 1.0)};
    Vec2d const inside{std::clamp(c.x, 0.0, last.x), std::clamp(c.y, 0.0, last.y)};
    if (!(length(c - inside) <= 2 * outside_margin_px)) return {std::nan(""), std::nan("")};
    int const column = std::clamp(static_cast<int>(inside.x / spacing), 0, std::max(0, grid_.columns - 2));
    int const row = std::clamp(static_cast<int>(inside.y / spacing), 0, std::max(0, grid_.rows - 2));
    double const fx = inside.x / spacing - column, fy = inside.y / spacing - row;
    int const right = std::min(column + 1, grid_.columns - 1), below = std::min(row + 1, grid_.rows - 1);
    auto const blend = [&](Image<double> const& map) {
      return (1 - fy) * ((1 - fx) * map(column, row) + fx * map(right, row)) +
             fy * ((1 - fx) * map(column, below) + fx * map(right, below));
    };
    return {blend(maps_.u_px), blend(maps_.v_px)};
  }

 private:
  /// Replaces positions far from the view by NaN: a few distant dots would coarsen the smoothing of the whole map.
  static std::vector<Vec2d> near_view(std::vector<Vec2d> places, CameraSetup const& camera) {
    double const margin = std::max(camera.columns, camera.rows);
    for (Vec2d& p : places) {
      bool const near = std::abs(p.x - 0.5 * camera.columns) <= 0.5 * camera.columns + margin &&
                        std::abs(p.y - 0.5 * camera.rows) <= 0.5 * camera.rows + margin;
      if (!near) p = {std::nan(""), std::nan("")};
    }
    return places;
  }

  static constexpr int spacing = 2;
  MapGrid grid_;
  DisplacementMaps maps_;
};

/// Rejects vectors that lie or point outside the image.
/// @throws DataError if no vector remains, or if the positions cannot be in px
RejectedVectors screen(VectorFile& file, std::string const& path, CameraSetup const& camera) {
  bool const turned = file.conventions.exchanges_places();  // the file's x then points down
  int const columns = turned ? camera.rows : camera.columns, rows = turned ? camera.columns : camera.rows;
  RejectedVectors const left_out = screen_vectors(file.field, file.conventions.offset_px, columns, rows);
  std::string const refusal = reason_to_reject_positions(file.field, left_out, columns, rows);
  if (!refusal.empty()) throw DataError(ErrorCode::inconsistent, path, refusal);
  if (left_out.all() > 0) {
    log_warning({WarningCode::excluded, path,
                 fmt::format("{} of {} vectors are excluded: {}", left_out.all(),
                             file.field.size() + left_out.without_place(), left_out.text())});
  }
  std::string const doubt = describe_suspect_positions(file.field, columns, rows);
  if (!doubt.empty()) log_warning({WarningCode::implausible, path, doubt});
  return left_out;
}

/// Throws if masks or backgrounds, which are read again, differ from those of the measurement.
void check_preparation(Hdf5Reader const& measured, std::string const& path, CorrelationSettings const& settings) {
  std::size_t number = 0;
  for (std::string const& file : settings.preparation.files) {
    std::string const hash = measured.attribute(fmt::format("preparation_{}_sha256", ++number));
    if (hash.empty() || hash == pixel_sha256(file)) continue;
    throw DataError(ErrorCode::changed, file,
                    fmt::format("has changed since {} was measured with it (another SHA-256 of its pixels); "
                                "restore the old file, or run gladstone correlate again",
                                path));
  }
}

/// Returns true if the format allows two readings that the truth cannot distinguish.
bool has_rival_of_its_own(VectorFile const& file, DetectedConventions const& detected) {
  VectorConventions const& taken = detected.conventions;
  auto const axes = [](VectorConventions const& c) { return std::tuple(c.y_up, c.v_up, c.swapped, c.exchange); };
  return std::any_of(detected.tried.begin(), detected.tried.end(), [&](ConventionFit const& fit) {
    auto const is_it = [&](VectorConventions const& own) { return axes(own) == axes(fit.conventions); };
    bool const own = is_it(file.conventions) || std::any_of(file.also.begin(), file.also.end(), is_it);
    return own && axes(fit.conventions) != axes(taken) && !(detected.fit.rms_px < 0.9 * fit.rms_px);
  });
}

/// Determines the conventions of the vectors, starting from those of the format.
/// @throws DataError if no convention fits the truth, and `check` requires it
DetectedConventions detect(VectorFile const& file, std::string const& path, GroundTruth const& truth,
                           CameraSetup const& camera, ConventionCheck check) {
  using Verdict = DetectedConventions::Verdict;
  TruthMap const map(truth, camera);
  DetectedConventions detected = detect_conventions(
      file, [&map](Vec2d c) { return map.at(c); }, camera.rows);
  bool const misfits = detected.verdict == Verdict::no_convention_fits;
  if (misfits && check == ConventionCheck::require) {
    throw DataError(
        ErrorCode::inconsistent, path,
        convention_report(detected) + ", or specify its reading with --conventions if the file cannot be corrected");
  }
  if (misfits) {
    log_warning({WarningCode::implausible, path,
                 fmt::format("the vectors do not follow the true displacement, also with other axes, signs or units: "
                             "they differ from it by {:.3g} px rms, and it is {:.3g} px rms itself; if their estimator "
                             "is more accurate than this, check the order of the frames, the axes and the units",
                             detected.fit.rms_px, detected.fit.signal_px)});
  } else if (detected.mistake.found()) {
    log_warning({WarningCode::implausible, path, "likely mistake: " + mistake_warning(detected.mistake)});
  } else if (detected.verdict == Verdict::cannot_be_told || has_rival_of_its_own(file, detected)) {
    log_warning({WarningCode::assumed, path, convention_report(detected) + "; specify it with --conventions"});
  }
  return detected;
}

}  // namespace

void log_remarks(VectorFile const& file) {
  log_warnings(file.warnings);
  for (std::string const& note : file.notes) spdlog::info("{}", note);
}

MeasuredVectors accept_vectors(VectorFile file, std::string const& name, CaseSetup const& loaded,
                               GroundTruth const* truth, CompareOptions const& options, ConventionCheck check) {
  if (options.conventions) override_conventions(file, *options.conventions);
  file = convert_to_pixels(std::move(file), name);
  CameraSetup const& camera = loaded.setup.camera;
  RejectedVectors const left_out = screen(file, name, camera);
  // rejected vectors count as valid unless their displacement was not finite
  bool any_valid = left_out.all() > left_out.displacement_not_finite;
  for (std::size_t i = 0; i < file.field.size() && !any_valid; ++i) any_valid = file.field.counts(i);
  if (!any_valid)
    throw DataError(
        ErrorCode::no_valid_vector, name,
        fmt::format("all of its {} vectors are invalid; check the frames and the settings of the correlation",
                    file.field.size()));
  MeasuredVectors vectors{{}, loaded.correlate, file.foreign, {}, name, left_out, {}};
  if (options.conventions && specifies_reading(*options.conventions)) {
    vectors.report = file.format + " vectors, as specified: " + describe(file.conventions);
  } else if (check != ConventionCheck::none && truth) {
    vectors.detected = detect(file, name, *truth, camera, check);
    vectors.report = convention_report(*vectors.detected);
    file.conventions = vectors.detected->conventions;
  } else if (check != ConventionCheck::none) {
    vectors.report =
        fmt::format("{} vectors, read as {} (the conventions of this format; there is no truth to test them)",
                    file.format, describe(file.conventions));
  }
  vectors.complete = file.complete;
  vectors.field = apply_conventions(std::move(file.field), file.conventions, camera.rows);
  return vectors;
}

MeasuredVectors load_vectors(std::string const& path, CaseSetup const& loaded, GroundTruth const* truth,
                             CompareOptions const& options) {
  VectorFile file = read_vectors(path);
  log_remarks(file);
  bool const foreign = file.foreign, hdf5 = has_hdf5_ending(path);
  bool const certain = !foreign && hdf5;  // our .h5 files name their frames
  MeasuredVectors vectors = accept_vectors(std::move(file), path, loaded, truth, options,
                                           certain ? ConventionCheck::none : ConventionCheck::require);
  if (certain) {
    Hdf5Reader const measured(path);
    std::string const text = measured.attribute("setup");
    if (!text.empty()) {
      SetupDocument document = SetupDocument::from_text(text, path);
      vectors.settings = read_correlation_settings(document.root().table("correlate"));
      check_preparation(measured, path, vectors.settings);
    }
  } else if (!foreign) {
    vectors.foreign = true;  // a CSV file does not contain the correlation settings
  }
  return vectors;
}

}  // namespace gladstone::inline compare
