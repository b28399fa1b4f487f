#include "studies/compare/reconstruct.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "analysis/density/aperture_deconvolution.h"
#include "analysis/density/density_uncertainty.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"
#include "studies/compare/density_warnings.h"
#include "studies/compare/reconstruct_axisymmetric.h"

namespace gladstone::inline compare {
namespace {

void check_reconstruct_options(ReconstructOptions const& options) {
  std::vector<SetupProblem> problems;
  auto const conflict = [&](char const* option, char const* reason) {
    problems.push_back({option, std::string("conflicts with --axisymmetric (") + reason + "); remove one of them", "",
                        ErrorCode::arguments});
  };
  if (options.axis) {
    if (!options.reference.empty()) conflict("--reference", "the density beyond the largest radius is the reference");
    if (options.deconvolution_gain) conflict("--deconvolve", "a radial density is not deconvolved");
  } else if (options.reference.empty()) {
    problems.push_back(
        {"--reference",
         "is required (a gradient determines the density only up to a constant); give a side of the image (left, "
         "right, top or bottom) or a box X0,Y0,X1,Y1 in mm, where the density is known",
         "", ErrorCode::arguments});
  }
  if (options.overlap && !(*options.overlap >= 0.0 && *options.overlap < 1.0))
    problems.push_back({"--overlap", fmt::format("expected 0 to below 1, got {}", *options.overlap)});
  if (!(options.scale_uncertainty >= 0.0 && options.scale_uncertainty < 1.0))
    problems.push_back(
        {"--scale-uncertainty", fmt::format("expected 0 to below 1, got {}", options.scale_uncertainty)});
  if (options.reference_density && !(*options.reference_density >= 0.0 && std::isfinite(*options.reference_density)))
    problems.push_back(
        {"--reference-density", fmt::format("expected a density of 0 or more, got {}", *options.reference_density)});
  if (options.deconvolution_gain && !(*options.deconvolution_gain > 1.0 && std::isfinite(*options.deconvolution_gain)))
    problems.push_back({"--deconvolve", fmt::format("expected a gain above 1, got {}", *options.deconvolution_gain)});
  if (!problems.empty()) throw SetupError(std::move(problems));
}

/// Throws for setups whose displacement is not proportional to the density gradient along the axes of the image.
void check_reconstructed_setup(Setup const& setup) {
  std::vector<SetupProblem> problems;
  if (!setup.experiment().measures_density)
    problems.push_back({"experiment", "is not \"bos\": only the displacement of a background contains the density"});
  if (setup.pose || setup.camera.tilted() || setup.divides_light())
    problems.push_back({"camera",
                        "has a pose, a tilt or lenslets: density is reconstructed for a camera on the Z axis "
                        "with its sensor perpendicular to it; dewarp the vectors to such a view first"});
  if (!problems.empty()) throw SetupError(std::move(problems));
}

density::ReferenceDensity make_reference(density::PlaneGrid const& grid, ReconstructOptions const& options,
                                         double value) {
  std::optional<density::ReferenceDensity> reference;
  for (ReferenceRegion const& region : options.reference) {
    density::ReferenceDensity one =
        region.side ? make_side_reference(grid, *region.side, value, region.depth, options.reference_sigma)
                    : make_box_reference(grid, region.low, region.high, value, options.reference_sigma);
    reference = reference ? combine_references(std::move(*reference), one) : std::move(one);
  }
  return *reference;
}

density::ApertureDeconvolution make_deconvolution(density::DensityIntegrator const& integrator, Setup const& setup,
                                                  double gain) {
  density::ApertureCone const cone{setup.imaging().entrance_pupil, setup.z_a, setup.z_d, setup.medium.thickness};
  if (!(cone.pupil_diameter > 0.0))
    throw SetupError({SetupProblem{"--deconvolve",
                                   "the setup has no aperture (f_number = inf: chief rays only); remove the option"}});
  return {integrator.grid(), integrator.determined(), cone, gain};
}

/// Combines the uncertainty due to the vectors with those of the reference density and of the scale.
std::vector<double> combine_uncertainties(Reconstruction const& result, ReconstructOptions const& options) {
  std::vector<double> combined = result.sigma_random;
  for (double& sigma : combined) sigma = std::hypot(sigma, options.reference_sigma);
  return density::add_scale_uncertainty(std::move(combined), result.density, result.reference_density,
                                        options.scale_uncertainty);
}

/// Warns if the averaging over the aperture, which sigma does not contain, is larger than sigma. Its effect is
/// estimated from the change of the density by a deconvolution with a gain of 2, which at most doubles any wave: the
/// change contains no more noise than the density does.
void warn_of_aperture(Reconstruction& result, density::DensityIntegrator const& integrator, Setup const& setup) {
  constexpr double gain = 2, largest_ratio = 2;
  if (!(setup.imaging().entrance_pupil > 0) || setup.medium.thickness > 2 * setup.z_d) return;
  std::vector<double> const deconvolved = make_deconvolution(integrator, setup, gain).apply(result.density);
  double changes = 0, variances = 0, count = 0;
  for (std::size_t i = 0; i < deconvolved.size(); ++i) {
    double const change = deconvolved[i] - result.density[i], sigma = result.sigma_random[i];
    if (!std::isfinite(change) || !(sigma > 0)) continue;
    changes += change * change;
    variances += sigma * sigma;
    ++count;
  }
  if (!(changes > largest_ratio * largest_ratio * variances) || count == 0) return;
  result.warnings.push_back(
      {WarningCode::low_accuracy, "lens.f_number",
       fmt::format("the aperture cone dominates the error of the density (averaging over it changes the density by at "
                   "least {:.2g} kg/m^3 rms, {:.2g} times the standard uncertainty, which does not contain it); use "
                   "--deconvolve {:g}, or a larger f-number",
                   std::sqrt(changes / count), std::sqrt(changes / variances), gain)});
}

/// Returns the borders of the image across an axis, in the mid-plane of the medium [m].
std::array<double, 2> find_axis_range(Setup const& setup, AxisOption const& axis) {
  density::ProjectionOptics const optics = make_projection_optics(setup);
  bool const is_vertical = axis.direction == density::AxisDirection::vertical;
  double const pixels = is_vertical ? setup.camera.columns : setup.camera.rows;
  double const half = 0.5 * pixels * optics.pixel_pitch / optics.medium_magnification();
  return {-half, half};
}

/// Integrates a mean gradient with the reference density, and propagates the uncertainty of the vectors.
/// @param result  reconstruction whose overlap and reference_density are set
Reconstruction integrate_plane(Reconstruction result, density::GradientMap const& map, Setup const& setup,
                               ReconstructOptions const& options) {
  using namespace density;
  IntegrationSettings settings;
  settings.method = options.method;
  settings.unreferenced = UnreferencedRegions::leave_out;
  DensityIntegrator const integrator(map, make_reference(map.grid, options, result.reference_density), settings);
  result.grid = map.grid;
  result.gradient = map.gradient;
  for (std::size_t i = 0; i < map.grid.size(); ++i)
    if (map.valid[i] == 0) result.gradient[i] = {not_a_number, not_a_number};
  result.region.assign(integrator.region_labels().begin(), integrator.region_labels().end());
  result.reference.assign(integrator.reference_nodes().begin(), integrator.reference_nodes().end());
  warn_of_regions(result, integrator.regions());
  warn_of_reference_gradient(result);

  result.density = integrator.integrate(map.gradient);
  DensityFilter filter;
  std::optional<ApertureDeconvolution> deconvolution;
  if (options.deconvolution_gain) {
    deconvolution.emplace(make_deconvolution(integrator, setup, *options.deconvolution_gain));
    result.density = deconvolution->apply(result.density);
    result.white_noise_gain = deconvolution->white_noise_gain();
    filter = [&](std::span<double const> error) { return deconvolution->apply(error); };
  }
  result.sigma_random.assign(map.grid.size(), not_a_number);
  if (map.sigma.empty() || !options.propagate) return result;
  PropagationSettings propagation;
  propagation.samples = options.samples;
  DensityUncertainty const uncertainty =
      propagate_uncertainty(integrator, map.sigma, result.overlap, 0.0, propagation, filter);
  result.sigma_random = uncertainty.sigma;
  result.samples = uncertainty.samples;
  if (!deconvolution) warn_of_aperture(result, integrator, setup);
  return result;
}

}  // namespace

density::WindowOverlap determine_overlap(DisplacementField const& field, double window_px) {
  Vec2d const extent = field.position_px.back() - field.position_px.front();
  auto const relative = [&](double length, int nodes) {
    return std::clamp(window_px * (nodes - 1) / length, 1.0, static_cast<double>(nodes));
  };
  return {relative(extent.x, field.columns), relative(extent.y, field.rows)};
}

density::ProjectionOptics make_projection_optics(Setup const& setup) {
  return {setup.imaging().magnification,
          setup.z_a,
          setup.z_d,
          setup.camera.pixel_pitch,
          setup.medium.gladstone_dale,
          setup.ambient_index(),
          {0.5 * (setup.camera.columns - 1), 0.5 * (setup.camera.rows - 1)}};
}

Reconstruction reconstruct_density(DisplacementField const& field, Setup const& setup, double window_px,
                                   ReconstructOptions const& options) {
  check_reconstruct_options(options);
  check_reconstructed_setup(setup);
  density::ProjectionOptics const optics = make_projection_optics(setup);
  density::ProjectedGradient const projected = compute_projected_gradient(field, optics);
  Reconstruction result;
  result.overlap =
      options.overlap ? density::WindowOverlap::from_fraction(*options.overlap) : determine_overlap(field, window_px);
  result.reference_density = options.reference_density.value_or(setup.medium.ambient_density);
  if (projected.map.sigma.empty())
    result.warnings.push_back({WarningCode::incomplete, "correlate.uncertainty",
                               "the vectors have no uncertainty, so that the density has none; correlate with an "
                               "uncertainty method, e.g. --set correlate.uncertainty=correlation_statistics"});
  if (projected.without_sigma > 0)
    result.warnings.push_back({WarningCode::incomplete, "correlate.uncertainty",
                               fmt::format("{} vectors have no uncertainty; the largest of the others is used for them",
                                           projected.without_sigma)});
  if (setup.camera.distorted())
    result.warnings.push_back({WarningCode::approximated, "lens",
                               "the distortion of the lens is neglected; undistort the images for accurate positions"});
  if (options.deconvolution_gain && setup.lens.focus != Focus::target)
    result.warnings.push_back({WarningCode::approximated, "lens.focus",
                               "the deconvolution assumes focus on the dots, but the focus is on another plane"});
  warn_of_displacement_gradient(result, projected.map, optics);
  result = options.axis ? invert_flow(std::move(result), projected.map, find_axis_range(setup, *options.axis), options)
                        : integrate_plane(std::move(result),
                                          compute_mean_gradient(projected.map, setup.medium.thickness), setup, options);
  result.sigma = combine_uncertainties(result, options);
  warn_of_window(result);
  return result;
}

DensityErrors compute_density_errors(Reconstruction const& reconstruction) {
  DensityErrors errors;
  double sum = 0.0, squares = 0.0, truth_sum = 0.0, truth_squares = 0.0;
  std::size_t with_sigma = 0, covered = 0;
  for (std::size_t i = 0; i < reconstruction.truth.size(); ++i) {
    double const truth = reconstruction.truth[i], error = reconstruction.density[i] - truth;
    if (!std::isfinite(error)) continue;
    ++errors.count;
    sum += error;
    squares += error * error;
    errors.largest = std::max(errors.largest, std::abs(error));
    double const excess = truth - reconstruction.reference_density;  // avoids loss of digits
    truth_sum += excess;
    truth_squares += excess * excess;
    double const sigma = reconstruction.sigma[i];
    if (!std::isfinite(sigma) || sigma == 0.0) continue;
    ++with_sigma;
    if (std::abs(error) <= sigma) ++covered;
  }
  double const n = static_cast<double>(errors.count);
  errors.bias = sum / n;
  errors.rms = std::sqrt(squares / n);
  errors.contrast = std::sqrt(std::max(0.0, truth_squares / n - (truth_sum / n) * (truth_sum / n)));
  errors.coverage = with_sigma > 0 ? static_cast<double>(covered) / static_cast<double>(with_sigma) : not_a_number;
  return errors;
}

}  // namespace gladstone::inline compare
