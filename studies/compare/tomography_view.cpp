#include "studies/compare/tomography_view.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "analysis/tracking/gaussian_window.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/files/input_file.h"
#include "render/scene/build_camera.h"
#include "studies/case/case_files.h"
#include "studies/case/case_kind.h"
#include "studies/compare/compared_vectors.h"
#include "studies/compare/exported_vectors.h"

namespace gladstone::inline compare {
namespace {

namespace fs = std::filesystem;

/// Files of a view.
struct ViewFiles {
  std::string setup, vectors;
  bool rendered = false;
};

ViewFiles find_view_files(TomographyOptions const& options, std::size_t index) {
  std::string const& place = options.views[index];
  ViewFiles files;
  std::error_code error;
  bool const is_folder = fs::is_directory(place, error);
  if (is_folder) require_case(place);
  files.setup = is_folder ? in_case(place, case_file::setup) : place;
  if (!is_folder) require_input_file(place, "a case folder or a setup");
  if (!is_folder && options.vectors.empty())
    throw DataError(ErrorCode::wrong_format, place,
                    "is a setup, which contains no vectors; give one file for each view with --vectors");
  files.rendered = is_folder && fs::exists(fs::path(place) / case_file::truth, error);
  if (options.ray_truth) {
    files.vectors = in_case(place, case_file::truth);
    require_input_file(files.vectors, "the truth of a rendered case");
    return files;
  }
  files.vectors = options.vectors.empty() ? in_case(place, case_file::vectors) : options.vectors[index];
  if (!fs::exists(files.vectors, error))
    throw DataError(ErrorCode::missing_file, files.vectors,
                    options.vectors.empty() ? "does not exist; create it with: gladstone correlate " + place
                                            : "does not exist; check --vectors");
  require_input_file(files.vectors, "a file of vectors");
  return files;
}

void check_view_setup(Setup const& setup, std::string const& name) {
  require_experiment(setup, bos_experiment, name,
                     "is not a BOS setup (density follows from the displacement of a background); use a setup with "
                     "experiment = \"bos\"");
  if (setup.divides_light())
    throw DataError(ErrorCode::unsupported, name,
                    "has a plenoptic camera, whose lines of sight do not meet in one pupil; use one setup for each "
                    "view");
}

/// Interpolates the true displacement of the dots to a grid with the spacing of the dots.
DisplacementField grid_ray_truth(std::string const& path, Setup const& setup) {
  DisplacementField const dots = load_for_export(path, "", 0).field;
  int const columns = setup.camera.columns, rows = setup.camera.rows;
  double const pixels = static_cast<double>(columns) * rows;
  auto const in_view = std::count_if(dots.position_px.begin(), dots.position_px.end(), [&](Vec2d p) {
    return p.x >= 0 && p.y >= 0 && p.x <= columns - 1 && p.y <= rows - 1;
  });
  if (in_view == 0) throw DataError(ErrorCode::no_valid_vector, path, "has no dot within the image");
  double const spacing =
      std::clamp(std::sqrt(pixels / static_cast<double>(in_view)), 1.0, 0.25 * std::min(columns, rows));
  DisplacementField grid;
  grid.columns = static_cast<int>((columns - 1) / spacing) + 1;
  grid.rows = static_cast<int>((rows - 1) / spacing) + 1;
  Vec2d const first{0.5 * (columns - 1 - spacing * (grid.columns - 1)), 0.5 * (rows - 1 - spacing * (grid.rows - 1))};
  std::vector<Vec2d> points;
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i) points.push_back({first.x + i * spacing, first.y + j * spacing});
  DisplacementField result = tracking::interpolate_vectors(dots, points);
  result.columns = grid.columns;
  result.rows = grid.rows;
  result.sigma_px.clear();  // omit the standard errors of the rays, which do not include the error of the interpolation
  return result;
}

DisplacementField read_view_vectors(ViewFiles const& files, TomographyOptions const& options, CaseSetup const& loaded) {
  if (options.ray_truth) return grid_ray_truth(files.vectors, loaded.setup);
  CompareOptions reading;
  reading.conventions = options.conventions;
  MeasuredVectors vectors = load_vectors(files.vectors, loaded, nullptr, reading);
  if (!vectors.report.empty()) spdlog::info("{}: {}", files.vectors, vectors.report);
  return std::move(vectors.field);
}

/// Finds the point closest to all lines, in which the chief rays of a camera meet: the entrance pupil.
/// @return nullopt for parallel lines
std::optional<Vec3d> find_pupil(std::vector<std::optional<tomography::VectorSight>> const& sights) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (auto const& sight : sights) {
    if (!sight) continue;
    Vec3d const d = sight->line.direction, a = sight->line.origin;
    Eigen::Vector3d const direction(d.x, d.y, d.z), origin(a.x, a.y, a.z);
    Eigen::Matrix3d const across = Eigen::Matrix3d::Identity() - direction * direction.transpose();
    normal += across;
    right += across * origin;
    count += 1.0;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> const solver(normal);
  constexpr double least_angle = 1e-6;  // rms angle between the lines [rad]
  if (!(solver.eigenvalues()[0] > least_angle * least_angle * count)) return std::nullopt;
  Eigen::Vector3d const pupil = normal.ldlt().solve(right);
  return Vec3d{pupil.x(), pupil.y(), pupil.z()};
}

/// Distance that represents an infinitely distant pupil [m].
constexpr double farthest_pupil = 1e4;

/// Sets the distance to the pupil and the weight of each line, which is 1 where the central line passes the origin.
void complete_lines(tomography::ViewOptics& optics, Vec3d volume_origin) {
  std::optional<Vec3d> const pupil = find_pupil(optics.sights);
  tomography::SightLine const* central = nullptr;
  double least = 0.0;
  for (auto& sight : optics.sights) {
    if (!sight) continue;
    tomography::SightLine& line = sight->line;
    line.pupil_distance = pupil ? std::min(length(*pupil - line.origin), farthest_pupil) : farthest_pupil;
    Vec3d const way = volume_origin - line.origin;
    double const miss = length(way - dot(way, line.direction) * line.direction);
    if (!central || miss < least) {
      central = &line;
      least = miss;
    }
  }
  double const s = dot(volume_origin - central->origin, central->direction);
  double const scale = (central->pupil_distance - s) / s;
  for (auto& sight : optics.sights)
    if (sight) sight->line.scale = scale;
}

density::ReferenceDensity make_view_reference(density::PlaneGrid const& grid, Setup const& setup,
                                              std::vector<ReferenceRegion> const& regions) {
  std::optional<density::ReferenceDensity> reference;
  density::ProjectionOptics const optics = make_projection_optics(setup);
  double const px_per_m = optics.medium_magnification() / optics.pixel_pitch;
  Vec2d const axis{optics.axis_px.x, -optics.axis_px.y};  // y = -row
  density::PlaneGrid const in_medium{grid.columns, grid.rows, (grid.origin - axis) / px_per_m,
                                     grid.spacing / px_per_m};  // [m], as the boxes
  for (ReferenceRegion const& region : regions) {
    density::ReferenceDensity one = region.side ? make_side_reference(grid, *region.side, 0.0, region.depth)
                                                : make_box_reference(in_medium, region.low, region.high, 0.0);
    reference = reference ? combine_references(std::move(*reference), one) : std::move(one);
  }
  return *reference;
}

/// Sets the properties of a view that determine the default grid.
void find_extent(TomographyView& view, tomography::ViewOptics const& optics, int columns) {
  auto const middle = [](tomography::SightLine const& line) {
    return line.origin - dot(line.origin, line.direction) * line.direction;
  };
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < optics.sights.size(); ++i) {
    if (!optics.sights[i]) continue;
    tomography::SightLine const& line = optics.sights[i]->line;
    view.middle_points.push_back(middle(line));
    view.view_direction += line.direction;
    bool const has_left = i % static_cast<std::size_t>(columns) != 0 && optics.sights[i - 1];
    if (!has_left) continue;
    sum += length(middle(line) - middle(optics.sights[i - 1]->line));
    ++count;
  }
  view.view_direction = normalized(view.view_direction);
  view.spacing = count > 0 ? sum / count : 0.0;
}

}  // namespace

tomography::ViewOptics trace_sight_lines(Setup const& setup, std::vector<Vec2d> const& at_px,
                                         Pose<double> const& volume) {
  Camera const camera = build_camera(setup);
  Pose<double> const target{{0.0, 0.0, -setup.z_d}};
  tomography::ViewOptics optics;
  optics.gladstone_dale = setup.medium.gladstone_dale;
  optics.ambient_index = setup.ambient_index();
  optics.sights.resize(at_px.size());
  parallel_for(at_px.size(), [&](std::size_t i) {
    std::optional<ImagedPoint> const seen = camera.unproject(at_px[i], target);
    if (!seen) return;
    double const determinant = seen->by_x.x * seen->by_y.y - seen->by_y.x * seen->by_x.y;
    if (determinant == 0.0) return;
    // Invert the derivatives of the pixel by the position of the dot
    Vec3d const by_column{seen->by_y.y / determinant, -seen->by_x.y / determinant, 0.0};
    Vec3d const by_row{-seen->by_y.x / determinant, seen->by_x.x / determinant, 0.0};
    tomography::VectorSight sight;
    sight.line.origin = volume.point_to_local(target.point_to_outer({seen->place.x, seen->place.y, 0.0}));
    sight.line.direction = volume.direction_to_local(normalized(seen->chief.direction));
    sight.by_column = volume.direction_to_local(by_column);
    sight.by_row = volume.direction_to_local(by_row);
    optics.sights[i] = sight;
  });
  if (std::none_of(optics.sights.begin(), optics.sights.end(), [](auto const& sight) { return sight.has_value(); }))
    throw DataError(ErrorCode::undetermined, "camera",
                    "no chief ray of a vector reaches the dots; check the setup of the view");
  complete_lines(optics, volume.point_to_local({}));
  return optics;
}

TomographyView read_tomography_view(TomographyOptions const& options, std::size_t index, double angle,
                                    SourceFiles& sources) {
  ViewFiles const files = find_view_files(options, index);
  std::string const prefix = fmt::format("view_{:02}_", index);
  sources.add(prefix + "setup", files.setup, SourceFiles::Holds::bytes);
  sources.add(prefix + "vectors", files.vectors);

  TomographyView view{load_case_setup(files.setup, {})};
  Setup const& setup = view.loaded.setup;
  check_view_setup(setup, files.setup);
  view.rendered = files.rendered;
  DisplacementField const field = read_view_vectors(files, options, view.loaded);
  try {
    tomography::ViewOptics const optics = trace_sight_lines(setup, field.position_px, turned_volume(angle));
    density::GradientMap const gradient = tomography::compute_pixel_gradient(field, optics);
    view.projected =
        tomography::integrate_view(gradient, optics, make_view_reference(gradient.grid, setup, options.reference));
    auto const& values = view.projected.value;
    auto const integrated = std::count_if(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
    view.unreferenced =
        static_cast<std::size_t>(std::count(gradient.valid.begin(), gradient.valid.end(), 1) - integrated);
    find_extent(view, optics, field.columns);
  } catch (DataError const& error) {
    throw DataError(error.code(), files.vectors, error.message());
  }
  view.projected.name = options.views[index];
  return view;
}

}  // namespace gladstone::inline compare
