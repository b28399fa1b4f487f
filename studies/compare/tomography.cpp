#include "studies/compare/tomography.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/files/stop_point.h"
#include "render/medium/field_volume.h"
#include "studies/case/warning_log.h"
#include "studies/compare/tomography_view.h"

namespace gladstone::inline compare {
namespace {

constexpr std::size_t most_views = 16;

void check_tomography_options(TomographyOptions const& options) {
  std::vector<SetupProblem> problems;
  std::size_t const count = options.views.size();
  if (count < tomography::least_views || count > most_views)
    problems.push_back({"views",
                        fmt::format("expected {} to {} views, got {}", tomography::least_views, most_views, count), "",
                        ErrorCode::arguments});
  if (!options.vectors.empty() && options.vectors.size() != count)
    problems.push_back(
        {"--vectors", fmt::format("expected one file for each of the {} views, got {}", count, options.vectors.size()),
         "", ErrorCode::arguments});
  if (!options.vectors.empty() && options.ray_truth)
    problems.push_back({"--ray-truth", "conflicts with --vectors; remove one of them", "", ErrorCode::arguments});
  if (!options.angles.empty() && options.angles.size() != count)
    problems.push_back(
        {"--angles", fmt::format("expected one angle for each of the {} views, got {}", count, options.angles.size()),
         "", ErrorCode::arguments});
  auto const finite = [](double angle) { return std::isfinite(angle); };
  if (!finite(options.arc) || !std::all_of(options.angles.begin(), options.angles.end(), finite))
    problems.push_back({options.angles.empty() ? "--arc" : "--angles", "expected finite angles in degrees"});
  if (std::set<std::string>(options.views.begin(), options.views.end()).size() != count && options.vectors.empty())
    problems.push_back({"views", "contain the same case twice; give each view once", "", ErrorCode::arguments});
  if (options.reference.empty())
    problems.push_back({"--reference",
                        "is required (displacement determines each projection only up to a constant); give a side of "
                        "the images (left, right, top or bottom) or a box X0,Y0,X1,Y1 in mm that the flow does not "
                        "reach in any view",
                        "", ErrorCode::arguments});
  if (options.spacing && !(*options.spacing > 0.0 && std::isfinite(*options.spacing)))
    problems.push_back({"--spacing", "expected a positive distance in mm"});
  if (options.bounds)
    for (int axis = 0; axis < 3; ++axis)
      if (!((*options.bounds)[0][axis] < (*options.bounds)[1][axis]))
        problems.push_back(
            {"--bounds", fmt::format("expected {0} of the first corner below {0} of the second one", "XYZ"[axis])});
  if (options.support && !(options.support->radius > 0.0))
    problems.push_back({"--support", "expected a positive radius"});
  if (!(options.least_density < options.largest_density))
    problems.push_back({"--least-density", "expected a density below --largest-density"});
  if (!problems.empty()) throw SetupError(std::move(problems));
}

/// Throws if the views look along fewer lines than a volume requires; two opposite views look along one line.
void require_distinct_lines(std::vector<TomographyView> const& views) {
  double const nearly_parallel = std::cos(0.5 * unit::degree);
  std::vector<Vec3d> lines;
  for (TomographyView const& view : views) {
    bool const known = std::any_of(lines.begin(), lines.end(), [&](Vec3d line) {
      return std::abs(dot(line, view.view_direction)) > nearly_parallel * length(line) * length(view.view_direction);
    });
    if (!known) lines.push_back(view.view_direction);
  }
  if (lines.size() < tomography::least_views)
    throw DataError(ErrorCode::undetermined, "tomography",
                    fmt::format("the views look along {} different lines only, and a volume requires {}; "
                                "check --angles, --arc and the poses of the cameras",
                                lines.size(), tomography::least_views));
}

std::vector<double> choose_angles(TomographyOptions const& options) {
  if (!options.angles.empty()) return options.angles;
  std::vector<double> angles;
  for (std::size_t i = 0; i < options.views.size(); ++i)
    angles.push_back(options.arc * static_cast<double>(i) / static_cast<double>(options.views.size()));
  return angles;
}

void require_equal_media(std::vector<TomographyView> const& views) {
  MediumSetup const& first = views.front().loaded.setup.medium;
  for (TomographyView const& view : views) {
    MediumSetup const& medium = view.loaded.setup.medium;
    if (std::abs(medium.ambient_density - first.ambient_density) <= 1e-9 * first.ambient_density &&
        std::abs(medium.gladstone_dale - first.gladstone_dale) <= 1e-9 * first.gladstone_dale)
      continue;
    throw DataError(ErrorCode::inconsistent, view.projected.name,
                    fmt::format("has another ambient density or Gladstone-Dale constant than {}; give views of one "
                                "experiment",
                                views.front().projected.name));
  }
}

/// Returns the part of the axis that all views across it see: the common part of their ranges.
std::array<double, 2> find_common_range(std::vector<TomographyView> const& views, int axis, double default_half) {
  double low = -HUGE_VAL, high = HUGE_VAL;
  for (TomographyView const& view : views) {
    double const along = view.view_direction[axis], across2 = 1.0 - along * along;
    if (across2 < 0.75) continue;  // the view is more than 30 degrees oblique to the axis
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (Vec3d const& point : view.middle_points) {
      least = std::min(least, point[axis] / across2);
      most = std::max(most, point[axis] / across2);
    }
    low = std::max(low, least);
    high = std::min(high, most);
  }
  if (!std::isfinite(low)) return {-default_half, default_half};
  if (!(low < high))
    throw DataError(ErrorCode::undetermined, "tomography",
                    "the views have no common part; check their cameras, or give --bounds");
  return {low, high};
}

RegularGrid make_grid(std::vector<TomographyView> const& views, TomographyOptions const& options) {
  double spacing = HUGE_VAL;
  for (TomographyView const& view : views)
    if (view.spacing > 0.0) spacing = std::min(spacing, view.spacing);
  if (options.spacing) spacing = *options.spacing;
  double const half = 0.5 * views.front().loaded.setup.medium.thickness;
  RegularGrid grid;
  grid.spacing = {spacing, spacing, spacing};
  for (int axis = 0; axis < 3; ++axis) {
    std::array<double, 2> const range = options.bounds
                                            ? std::array{(*options.bounds)[0][axis], (*options.bounds)[1][axis]}
                                            : find_common_range(views, axis, half);
    double const cells = std::floor((range[1] - range[0]) / spacing * (1.0 + 1e-9));
    if (!(cells >= 1.0 && cells < 1e5))
      throw SetupError({SetupProblem{
          "--spacing", fmt::format("{:.4g} mm does not divide the range of {:.4g} mm along {} into 1 to 100000 cells",
                                   spacing / unit::mm, (range[1] - range[0]) / unit::mm, "XYZ"[axis])}});
    grid.nodes[static_cast<std::size_t>(axis)] = static_cast<int>(cells) + 1;
    grid.origin[axis] = 0.5 * (range[0] + range[1] - cells * spacing);
  }
  return grid;
}

/// Calls body(node index, position [m]) for every node of a grid.
template <class Body>
void visit_nodes(RegularGrid const& grid, Body const& body) {
  std::size_t node = 0;
  for (int k = 0; k < grid.nodes[2]; ++k)
    for (int j = 0; j < grid.nodes[1]; ++j)
      for (int i = 0; i < grid.nodes[0]; ++i)
        body(node++, grid.origin + Vec3d{i * grid.spacing.x, j * grid.spacing.y, k * grid.spacing.z});
}

std::vector<std::uint8_t> make_support(RegularGrid const& grid, VolumeSupport const& support) {
  std::vector<std::uint8_t> inside(grid.size());
  visit_nodes(grid, [&](std::size_t node, Vec3d p) {
    if (support.shape == VolumeSupport::Shape::cylinder) p.y = 0.0;
    inside[node] = length(p) <= support.radius ? 1 : 0;
  });
  return inside;
}

/// Evaluates the true density in the frame of the volume: that of the medium of a view, ambient outside.
std::vector<double> sample_truth(MediumSetup const& setup, double angle, RegularGrid const& grid) {
  std::vector<double> density(grid.size(), setup.ambient_density);
  Pose<double> const volume = turned_volume(angle);
  BuiltMedium const built = build_medium(setup);
  std::visit(
      [&](auto const& medium) {
        Bounds<double> const box = medium.bounds();
        visit_nodes(grid, [&](std::size_t node, Vec3d p) {
          Vec3d const q = volume.point_to_outer(p);
          bool const inside = q.x >= box.low.x && q.x <= box.high.x && q.y >= box.low.y && q.y <= box.high.y &&
                              q.z >= box.low.z && q.z <= box.high.z;
          if (inside) density[node] = medium.sample(q).refractivity / setup.gladstone_dale;
        });
      },
      built.view);
  return density;
}

void add_tomography_warnings(Tomography& result, std::vector<TomographyView> const& views) {
  // residuals of 0.5 leave a quarter of the squared line integrals unexplained
  constexpr double largest_residual = 0.5;
  for (TomographyView const& view : views) {
    std::string const& name = view.projected.name;
    if (view.loaded.setup.has_refracting_elements())
      result.warnings.push_back({WarningCode::approximated, name,
                                 "windows and other optical elements are neglected: lines of sight are straight"});
    if (view.unreferenced > 0)
      result.warnings.push_back({WarningCode::excluded, name,
                                 fmt::format("{} vectors are not used, since masks separate them from the reference "
                                             "region; add a --reference on their side if the flow does not reach it",
                                             view.unreferenced)});
  }
  for (auto const& [view, ratio] : tomography::find_contradicting_views(result.view_residual))
    result.warnings.push_back(
        {WarningCode::unreliable, result.views[view],
         fmt::format("contradicts the other views: the residual of its line integrals is {:.0f} %, {:.1f} times that "
                     "of the others; check the order of the views, --angles, the camera and geometry of its setup "
                     "(calibration), and the sign, position and reference of its vectors",
                     100.0 * result.view_residual[view], ratio)});
  if (result.residual.back() > largest_residual)
    result.warnings.push_back(
        {WarningCode::unreliable, "",
         fmt::format("the volume does not explain the line integrals (residual of {:.0f} %); check --angles, "
                     "--support, --bounds, --reference and the limits of the density",
                     100.0 * result.residual.back())});
  if (result.outside > 0.01)
    result.warnings.push_back(
        {WarningCode::unsuitable, "",
         fmt::format("the views show density outside of the reconstructed volume: {:.0f} % of the sum of the squared "
                     "line integrals belong to lines of sight that miss it; enlarge the volume with --bounds, or "
                     "choose --reference where the density is that of the ambient",
                     100.0 * result.outside)});
  auto const unseen = std::count_if(result.seen.begin(), result.seen.end(), [](std::int64_t views_of_node) {
    return views_of_node < static_cast<std::int64_t>(tomography::least_views);
  });
  double const fraction = static_cast<double>(unseen) / static_cast<double>(result.seen.size());
  if (fraction > 0.01)
    result.warnings.push_back(
        {WarningCode::unsuitable, "",
         fmt::format(
             "{:.0f} % of the volume are seen by fewer than {} views, where the density is not determined; reduce the "
             "volume with --bounds, or, if its nodes are closer than the vectors, increase --spacing",
             100.0 * fraction, tomography::least_views)});
}

}  // namespace

double compute_relative_error(Tomography const& result) {
  std::vector<double> value = result.density, truth = result.truth;
  for (double& v : value) v -= result.reference_density;
  for (double& v : truth) v -= result.reference_density;
  return tomography::compute_relative_error(value, truth);
}

Pose<double> turned_volume(double angle) { return Pose<double>{}.turned({0.0, angle, 0.0}); }

Tomography reconstruct_views(TomographyOptions const& options, tomography::SartVolumeMaker const& make_volume) {
  check_tomography_options(options);
  Tomography result;
  result.angles = choose_angles(options);
  result.views = options.views;
  std::vector<TomographyView> views;
  for (std::size_t i = 0; i < options.views.size(); ++i) {
    views.push_back(read_tomography_view(options, i, result.angles[i], result.sources));
    auto const& values = views.back().projected.value;
    result.vectors.push_back(static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [](double value) { return std::isfinite(value); })));
  }
  stop_point("reconstructing");
  require_equal_media(views);
  require_distinct_lines(views);
  MediumSetup const& medium = views.front().loaded.setup.medium;
  result.reference_density = options.reference_density.value_or(medium.ambient_density);
  if (!(result.reference_density >= options.least_density && result.reference_density <= options.largest_density))
    throw SetupError({SetupProblem{
        "--reference-density", fmt::format("is {} kg/m^3, outside --least-density and --largest-density ({} to {})",
                                           result.reference_density, options.least_density, options.largest_density)}});
  result.settings = options.sart;
  result.settings.lowest = std::min(0.0, options.least_density - result.reference_density);
  result.settings.highest = std::max(0.0, options.largest_density - result.reference_density);
  RegularGrid const grid = make_grid(views, options);
  if (options.support) result.settings.support = make_support(grid, *options.support);

  std::vector<tomography::ProjectedView> projections;
  for (TomographyView& view : views) projections.push_back(std::move(view.projected));
  tomography::VolumeReconstruction volume = reconstruct_volume(projections, grid, result.settings, make_volume);
  for (std::size_t i = 0; i < views.size(); ++i) views[i].projected.name = projections[i].name;
  result.grid = grid;
  result.density = std::move(volume.value);
  for (double& density : result.density) density += result.reference_density;
  result.seen = std::move(volume.views);
  result.residual = std::move(volume.residual);
  result.view_residual = std::move(volume.view_residual);
  result.outside = volume.outside;
  result.tv_weight = volume.tv_weight;
  result.device = volume.device;
  bool const is_known = views.front().rendered && medium.field.kind != FieldKind::none;
  if (is_known) result.truth = sample_truth(medium, result.angles.front(), grid);
  result.setup = views.front().loaded.document.resolved();
  result.seed = views.front().loaded.setup.render.seed;
  result.sources.on_change("run gladstone tomography again");
  add_tomography_warnings(result, views);
  log_warnings(result.warnings);
  return result;
}

}  // namespace gladstone::inline compare
