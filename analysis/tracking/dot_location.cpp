#include "analysis/tracking/dot_location.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "analysis/preparation/illumination.h"
#include "analysis/tracking/dot_candidates.h"
#include "analysis/tracking/dot_groups.h"
#include "analysis/tracking/overlap_resolution.h"
#include "analysis/tracking/photon_noise.h"
#include "render/base/median.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "render/base/point_cells.h"
#include "render/base/units.h"

namespace gladstone::inline tracking {
namespace {

constexpr std::array<int, 4> additions_per_sweep{0, 4, 4, 0};  // largest number of dots added to a group in each sweep
constexpr double least_spread = 0.02;     // smallest standard deviation of the prior, relative to its mean
constexpr double least_mismatch = 0.005;  // deviation of real dot images from the Gaussian, relative to their levels
// Minimum ratio of a fitted dot's flux, in standard uncertainties, to the detection threshold. The ratio is below 1
// because the uncertainty of a fitted flux also contains the effects of width and background, which do not affect the
// detection.
constexpr double least_flux_share = 0.6;
constexpr std::size_t enough_isolated = 10;  // number of isolated dots that suffices to determine the prior

/// State of the dot location in one frame.
class FrameFit {
 public:
  /// @param places  approximate centres of all dots [px]; nullopt: the dots are searched in the frame
  FrameFit(Image<double> const& frame, DotSettings const& settings,
           std::optional<std::span<Vec2d const>> places = std::nullopt)
      : settings_(settings), frame_(prepare_dot_frame(frame, settings)), places_known_(places.has_value()) {
    whole_levels_ = std::all_of(frame.begin(), frame.end(),
                                [](double level) { return !std::isfinite(level) || level == std::floor(level); });
    double const sigma = settings.diameter_px > 0 ? 0.25 * settings.diameter_px : estimate_dot_sigma(frame_.above);
    frame_.noise = std::max(frame_.noise, whole_levels_ ? 0.29 : 0.0);
    model_.shape = settings.shape;
    model_.detection_threshold = settings.detection_threshold;
    double const variance = sigma * sigma;
    double const loose = settings.diameter_px > 0 ? 0.5 * variance : variance;
    model_.prior = {{variance, 0, variance}, {loose, loose, loose}, 0, 0, {}};
    std::vector<GaussianDot> const start =
        places ? dots_at(*places, variance) : find_dot_candidates(frame_, sigma, settings.detection_threshold);
    for (GaussianDot const& dot : start) located_.push_back({.image = dot});
  }

  LocatedDots run() {
    std::size_t const candidates = located_.size();
    for (std::size_t sweep = 0; sweep < additions_per_sweep.size() && !located_.empty(); ++sweep) {
      fit_groups(additions_per_sweep[sweep]);
      if (sweep + 1 == additions_per_sweep.size()) break;
      merge_coincident();
      if (sweep == 0) update_prior();
      update_profile();
      update_background();
      if (frame_.bright) gain_ = estimate_conversion_gain(samples_, frame_.noise);
    }
    LocatedDots result;
    result.light = sum_light();
    result.residual = residual_of(result.light);
    std::erase_if(located_, [&](LocatedDot const& dot) { return !valid(dot); });
    std::sort(located_.begin(), located_.end(), [](LocatedDot const& a, LocatedDot const& b) {
      auto const key = [](LocatedDot const& dot) {
        Vec2d const c = dot.image.centre;
        return std::tuple(std::lround(c.y), std::lround(c.x), c.y, c.x);
      };
      return key(a) < key(b);
    });
    result.rejected = candidates > located_.size() ? candidates - located_.size() : 0;
    result.dots = std::move(located_);
    result.bright = frame_.bright;
    result.noise = frame_.noise;
    result.gain = gain_;
    result.diameter_px = 4 * std::sqrt(model_.prior.mean[0]);
    return result;
  }

 private:
  /// Returns dots at those of the given places that are within the frame, with fluxes estimated from the nearest
  /// pixels.
  std::vector<GaussianDot> dots_at(std::span<Vec2d const> places, double variance) const {
    std::vector<GaussianDot> dots;
    for (Vec2d const place : places) {
      if (!is_finite(place) || !inside(place)) continue;
      double const level = frame_.above(static_cast<int>(std::lround(place.x)), static_cast<int>(std::lround(place.y)));
      if (!std::isfinite(level)) continue;
      double const height = std::max(level, frame_.noise);
      dots.push_back({place, height * (2 * pi) * (variance + 1.0 / 12), variance, 0, variance});
    }
    return dots;
  }

  double typical_sigma() const { return std::sqrt(model_.prior.mean[0] + 1.0 / 12); }

  /// Returns the largest distance of the pixels of a fit from the nearest of its dots [px].
  double fit_reach() const { return std::max(2.5, 3.2 * typical_sigma() + 0.5); }

  /// Returns the light of all dots on every pixel.
  Image<double> sum_light() const {
    Image<double> light(frame_.above.columns(), frame_.above.rows());
    for (LocatedDot const& one : located_) {
      DotLight const dot(one.image, settings_.shape, model_.prior.profile);
      for (int row = std::max(0, dot.first_row()); row < std::min(light.rows(), dot.first_row() + dot.rows()); ++row)
        for (int column = std::max(0, dot.first_column());
             column < std::min(light.columns(), dot.first_column() + dot.columns()); ++column)
          light(column, row) += dot.at(column, row).value;
    }
    return light;
  }

  /// Returns the levels above the background minus the given light.
  Image<double> residual_of(Image<double> const& light) const {
    Image<double> residual = frame_.above;
    for (std::size_t i = 0; i < residual.size(); ++i) residual.data()[i] -= light.data()[i];
    return residual;
  }

  double noise_at(double light) const { return noise_with_light(frame_.noise, gain_, light); }

  /// Returns the pixels within reach of a group's dots, without the light of the dots of other groups.
  std::vector<FitPixel> collect_pixels(std::vector<GaussianDot> const& group, Image<double> const& light) const {
    double const reach = fit_reach();
    int const columns = frame_.above.columns(), rows = frame_.above.rows();
    double left = columns, right = -1, top = rows, low = -1;
    for (GaussianDot const& dot : group) {
      left = std::min(left, dot.centre.x - reach);
      right = std::max(right, dot.centre.x + reach);
      top = std::min(top, dot.centre.y - reach);
      low = std::max(low, dot.centre.y + reach);
    }
    PixelBox const box{
        std::max(0, static_cast<int>(std::ceil(left))), std::min(columns - 1, static_cast<int>(std::floor(right))),
        std::max(0, static_cast<int>(std::ceil(top))), std::min(rows - 1, static_cast<int>(std::floor(low)))};
    std::vector<DotLight> own;
    for (GaussianDot const& dot : group) own.emplace_back(dot, settings_.shape, model_.prior.profile, box);
    std::vector<FitPixel> pixels;
    for (int row = box.top; row <= box.bottom; ++row)
      for (int column = box.left; column <= box.right; ++column) {
        bool const near = std::any_of(group.begin(), group.end(), [&](GaussianDot const& one) {
          return length(one.centre - Vec2d{1.0 * column, 1.0 * row}) < reach;
        });
        double const above = frame_.above(column, row);
        if (!near || !std::isfinite(above)) continue;
        double of_group = 0;
        for (DotLight const& dot : own) of_group += dot.at(column, row).value;
        pixels.push_back({column, row, above - light(column, row) + of_group, 1 / noise_at(light(column, row))});
      }
    return pixels;
  }

  /// Fits all dots in groups. Up to `additions` dots are added to each group.
  void fit_groups(int additions) {
    std::vector<Vec2d> centres;
    for (LocatedDot const& dot : located_) centres.push_back(dot.image.centre);
    auto const groups = group_dots(centres, 6.2 * typical_sigma() + 0.5);
    Image<double> const light = sum_light();
    std::vector<std::vector<LocatedDot>> fitted(groups.size());
    std::vector<double> mismatch(groups.size(), not_a_number);
    std::vector<std::vector<ResidualSample>> samples(groups.size());
    std::vector<std::vector<ProfileSample>> profile_samples(groups.size());
    parallel_for(groups.size(), [&](std::size_t g) {
      std::vector<GaussianDot> start;
      for (std::size_t const i : groups[g]) start.push_back(located_[i].image);
      std::vector<FitPixel> const pixels = collect_pixels(start, light);
      if (pixels.size() < start.size() * (3 + shape_parameters(settings_.shape)) + 1) return;
      DotFit const fit = fit_overlapping_dots(pixels, start, model_, places_known_ ? 0 : additions);
      if (!std::isfinite(fit.cost)) {
        // Retain the dots of a failed fit: a later sweep has better start values and a narrower prior.
        for (GaussianDot const& dot : start)
          fitted[g].push_back({.image = dot,
                               .sigma_px = {not_a_number, not_a_number},
                               .flux_sigma = not_a_number,
                               .reduced_chi2 = 1,
                               .group_size = 0});
        return;
      }
      if (fit.dots.size() == 1) {
        mismatch[g] = estimate_mismatch(fit, pixels);
        samples[g] = sample_residuals(fit, pixels);
        profile_samples[g] = sample_profile(fit, pixels);
      }
      for (std::size_t k = 0; k < fit.dots.size(); ++k) {
        LocatedDot dot{.image = fit.dots[k],
                       .reduced_chi2 = fit.freedom > 0 ? fit.chi2 / fit.freedom : 1.0,
                       .background = fit.background,
                       .freedom_share = std::max(0, fit.freedom) / static_cast<double>(pixels.size()),
                       .group_size = fit.dots.size()};
        dot.sigma_px = misfit_factor(dot) * fit.sigma[k];
        dot.flux_sigma = misfit_factor(dot) * fit.flux_sigma[k];
        fitted[g].push_back(dot);
      }
    });
    located_.clear();
    for (std::vector<LocatedDot> const& group : fitted)
      for (LocatedDot const& dot : group)
        if (inside(dot.image.centre)) located_.push_back(dot);
    samples_.clear();
    for (std::vector<ResidualSample> const& group : samples)
      samples_.insert(samples_.end(), group.begin(), group.end());
    std::erase_if(profile_samples, [](std::vector<ProfileSample> const& dot) { return dot.empty(); });
    profile_samples_ = std::move(profile_samples);
    std::erase_if(mismatch, [](double value) { return !std::isfinite(value); });
    model_.mismatch = std::max(least_mismatch, std::sqrt(std::max(0.0, upper_median(std::move(mismatch)))));
  }

  bool inside(Vec2d c) const {
    return c.x > -0.5 && c.y > -0.5 && c.x < frame_.above.columns() - 0.5 && c.y < frame_.above.rows() - 0.5;
  }

  /// Returns whether the flux of a fitted dot is significant and its size agrees with that of the other dots: within a
  /// factor of four, or within four times the spread of the sizes in the frame, since the width of a dot of few pixels
  /// is uncertain.
  bool valid(LocatedDot const& dot) const {
    double const typical = model_.prior.mean[0], size = dot.image.xx;
    bool const usual =
        (size > 0.25 * typical && size < 4 * typical) || std::abs(size - typical) < 4 * model_.prior.sigma[0];
    return inside(dot.image.centre) && usual &&
           dot.image.flux > least_flux_share * settings_.detection_threshold * dot.flux_sigma &&
           length(dot.sigma_px) < 1;
  }

  /// Removes the fainter of two dots at nearly the same place, which may have been added to two groups.
  void merge_coincident() {
    double const closest = closest_over_sigma * typical_sigma();
    std::vector<Vec2d> centres;
    for (LocatedDot const& dot : located_) centres.push_back(dot.image.centre);
    PointCells const cells(centres, std::max(closest, 1.0));
    std::vector<bool> gone(centres.size());
    for (std::size_t i = 0; i < centres.size(); ++i)
      cells.for_near(centres[i], closest, [&](std::size_t k) {
        if (k == i || gone[i] || gone[k] || !(length(centres[k] - centres[i]) < closest)) return;
        bool const fainter = located_[k].image.flux < located_[i].image.flux;
        gone[fainter ? k : i] = true;
      });
    std::size_t next = 0;
    for (std::size_t i = 0; i < centres.size(); ++i)
      if (!gone[i]) located_[next++] = located_[i];
    located_.resize(next);
  }

  /// Determines the distribution of shape and flux from the dots that were fitted individually.
  void update_prior() {
    std::array<std::vector<double>, 3> values;
    std::vector<double> fluxes;
    for (LocatedDot const& dot : located_) {
      if (dot.group_size != 1 || !(dot.image.flux > settings_.detection_threshold * dot.flux_sigma)) continue;
      values[0].push_back(dot.image.xx);
      values[1].push_back(dot.image.xy);
      values[2].push_back(dot.image.yy);
      fluxes.push_back(dot.image.flux);
    }
    if (values[0].size() < enough_isolated) return;
    double const size = upper_median(values[0]);
    for (int s = 0; s < 3; ++s) {
      double const mean = upper_median(values[s]);
      for (double& value : values[s]) value = std::abs(value - mean);
      model_.prior.mean[s] = mean;
      model_.prior.sigma[s] = std::max(sigma_per_median_deviation * upper_median(values[s]), least_spread * size);
    }
    model_.prior.flux_mean = upper_median(fluxes);
    for (double& flux : fluxes) flux = std::abs(flux - model_.prior.flux_mean);
    model_.prior.flux_sigma =
        std::max(sigma_per_median_deviation * upper_median(fluxes), least_spread * model_.prior.flux_mean);
  }

  /// Determines the profile of round dots from the dots that were fitted individually.
  void update_profile() {
    if (settings_.shape != DotShape::round || profile_samples_.size() < enough_isolated) return;
    FittedProfile const fitted = fit_dot_profile(profile_samples_);
    model_.prior.profile = fitted.profile;
    model_.prior.flux_mean *= fitted.flux_factor;
    model_.prior.flux_sigma *= fitted.flux_factor;
    for (LocatedDot& dot : located_) dot.image.flux *= fitted.flux_factor;
  }

  /// Updates background and noise from the residual of the frame.
  void update_background() {
    Image<double> residual = residual_of(sum_light());
    // The fitted parameters absorb a part of the noise, for which the estimate is corrected.
    double const pixels = static_cast<double>(residual.size()), parameters = 4.0 * static_cast<double>(located_.size());
    frame_.noise =
        estimate_noise(residual, whole_levels_) * std::sqrt(pixels / std::max(pixels - parameters, 0.5 * pixels));
    for (double& level : residual)
      if (!std::isfinite(level)) level = 0;
    Image<double> const correction = estimate_background(residual);
    for (std::size_t i = 0; i < residual.size(); ++i) frame_.above.data()[i] -= correction.data()[i];
  }

  /// Returns the residuals of the pixels with a leverage below 0.9; at pixels of higher leverage, the fit follows the
  /// measured level too closely.
  static std::vector<ResidualSample> sample_residuals(DotFit const& fit, std::vector<FitPixel> const& pixels) {
    constexpr double most_leverage = 0.9;
    std::vector<ResidualSample> samples;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (!(fit.leverage[i] < most_leverage)) continue;
      samples.push_back({pixels[i].level - fit.residual[i] - fit.background, fit.dots.front().flux,
                         fit.residual[i] * fit.residual[i] / (1 - fit.leverage[i])});
    }
    return samples;
  }

  /// Returns the pixels of a dot that was fitted individually.
  std::vector<ProfileSample> sample_profile(DotFit const& fit, std::vector<FitPixel> const& pixels) const {
    GaussianDot const& dot = fit.dots.front();
    PixelBox const box = bounding_box(pixels);
    std::vector<DotLight> parts;
    for (double const scale : DotProfile::scale)
      parts.emplace_back(GaussianDot{dot.centre, 1, scale * dot.xx, 0, scale * dot.yy}, settings_.shape, DotProfile{},
                         box);
    DotLight const light(dot, settings_.shape, model_.prior.profile, box);
    std::vector<ProfileSample> samples;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      DotLevel const level = light.at(pixels[i].column, pixels[i].row);
      ProfileSample sample{(level.value + fit.residual[i]) / dot.flux,
                           std::pow(dot.flux * pixels[i].per_sigma, 2),
                           {},
                           {level.by_x / dot.flux, level.by_y / dot.flux}};
      for (std::size_t k = 0; k < parts.size(); ++k)
        sample.gaussian[k] = parts[k].at(pixels[i].column, pixels[i].row).value;
      samples.push_back(sample);
    }
    return samples;
  }

  /// Returns the ratio of the squared residual of an individually fitted dot, after subtraction of the noise, to the
  /// squared level.
  static double estimate_mismatch(DotFit const& fit, std::vector<FitPixel> const& pixels) {
    double excess = 0, power = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      excess += std::pow(fit.residual[i], 2) - std::pow(pixels[i].per_sigma, -2);
      power += std::pow(pixels[i].level - fit.residual[i] - fit.background, 2);
    }
    return power > 0 ? excess / power : 0.0;
  }

  DotSettings settings_;
  DotFrame frame_;
  bool places_known_;  // true: the places of all dots are given, and no dots are added
  bool whole_levels_ = false;
  DotModel model_;
  double gain_ = 0;  // variance of the shot noise per grey level of light
  std::vector<ResidualSample> samples_;
  std::vector<std::vector<ProfileSample>> profile_samples_;  // samples of the dots that were fitted individually
  std::vector<LocatedDot> located_;
};

}  // namespace

double misfit_factor(LocatedDot const& dot) { return std::sqrt(std::max(1.0, dot.reduced_chi2)); }

double noise_with_light(double background_noise, double gain, double light) {
  return std::max(std::sqrt(background_noise * background_noise + gain * std::max(0.0, light)), 1e-9);
}

LocatedDots locate_dots(Image<double> const& frame, DotSettings const& settings) {
  if (frame.columns() < 5 || frame.rows() < 5) return {};
  return FrameFit(frame, settings).run();
}

LocatedDots locate_dots_near(Image<double> const& frame, DotSettings const& settings, std::span<Vec2d const> places) {
  if (frame.columns() < 5 || frame.rows() < 5) return {};
  return FrameFit(frame, settings, places).run();
}

}  // namespace gladstone::inline tracking
