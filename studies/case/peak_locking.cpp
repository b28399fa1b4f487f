#include "studies/case/peak_locking.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "studies/case/case_kind.h"
#include "studies/case/image_statistics.h"
#include "studies/case/random_error.h"

namespace gladstone::inline cases {
namespace {

constexpr double usual_dots = 20;      // dots per window assumed for the expected error
constexpr double smallest_seen = 0.5;  // smallest recognised diameter [px]; a narrower autocorrelation peak is caused
                                       // by noise, not by dots

constexpr double warned_image_px = 0.995 * min_image_px;  // diameter below which the warning is given: images that
                                                          // follow its rounded advice do not cause it again
constexpr int most_judged_px = 256;                       // size of the evaluated central part of a frame

double square(double x) { return x * x; }

/// Rounds up to three significant digits, so that a wider image is not below the required width.
double round_up(double value) {
  double const step = std::pow(10.0, std::floor(std::log10(value)) - 2);
  return std::ceil(value / step * (1 - 1e-9)) * step;
}

/// Returns the changes of the setup that prevent peak locking, as keys with values.
std::string cures(Setup const& setup, ImageDiameters const& images) {
  std::string text;
  auto const add = [&text](std::string const& cure) { text += (text.empty() ? "" : " or ") + cure; };
  if (double const factor = images.f_number_factor(min_image_px); std::isfinite(factor * setup.lens.f_number)) {
    add(fmt::format("lens.f_number = {:.3g}", round_up(factor * setup.lens.f_number)));
  }
  double const focus = defocus_distance(setup, min_image_px);
  if (std::isfinite(focus) && !setup.has_ideal_particles()) {  // ideal images assume particles in focus
    add(fmt::format("lens.focus_distance_mm = {:.6g}", focus / unit::millimetre));
  }
  if (setup.experiment().sources.on_target) {
    double const needed = std::sqrt(square(min_image_px) - square(images.spot_px) - square(images.blur_px));
    add(fmt::format("target.dot_diameter_mm = {:.4g}", needed * setup.pixel_size() / unit::millimetre));
  }
  return text;
}

Image<double> middle_of(Image<double> const& frame) {
  int const columns = std::min(frame.columns(), most_judged_px), rows = std::min(frame.rows(), most_judged_px);
  int const left = (frame.columns() - columns) / 2, top = (frame.rows() - rows) / 2;
  Image<double> middle(columns, rows);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) middle(column, row) = frame(left + column, top + row);
  }
  return middle;
}

}  // namespace

double ImageDiameters::diameter_px() const { return std::hypot(geometric_px, spot_px, blur_px); }

double ImageDiameters::locking_error_px() const {
  return pattern_error_px(geometric_px, std::hypot(spot_px, blur_px) / 4, usual_dots);
}

double ImageDiameters::f_number_factor(double diameter_px) const {
  // larger root k of g^2 + k^2 spot^2 + blur^2 / k^2 = d^2
  double const room = square(diameter_px) - square(geometric_px);
  double const root = square(room) - 4 * square(spot_px * blur_px);
  if (!(spot_px > 0) || !(root >= 0)) return std::nan("");
  double const factor = std::sqrt((room + std::sqrt(root)) / (2 * square(spot_px)));
  return factor > 1 ? factor : std::nan("");
}

ImageDiameters expected_images(Setup const& setup) { return case_kind(setup).expected_images(setup); }

double defocus_distance(Setup const& setup, double diameter_px) {
  if (setup.lens.prescription || !setup.elements.empty()) return std::nan("");
  ImageDiameters const images = expected_images(setup);
  double const blur = std::sqrt(square(diameter_px) - square(images.geometric_px) - square(images.spot_px));
  double const pupil = setup.lens.focal_length / setup.lens.f_number;
  if (!(blur > 0) || !(pupil > 0)) return std::nan("");
  double const sharp = 1 / (1 / setup.lens.focal_length - 1 / images.distance);
  Setup focused = setup;
  focused.lens.focus = Focus::distance;
  double wanted = blur;
  for (int step = 0; step < 3; ++step) {
    // On a sensor behind the image plane, a point is imaged to a disc of diameter D_a (z_i - z_sharp) / z_sharp.
    double const sensor = sharp * (1 + wanted * setup.camera.pixel_pitch / pupil);
    focused.lens.focus_distance = 1 / (1 / setup.lens.focal_length - 1 / sensor);
    // The magnification, and with it the rest of the image, changes with the focus.
    ImageDiameters const there = expected_images(focused);
    wanted *= std::sqrt(square(diameter_px) - square(there.geometric_px) - square(there.spot_px)) / there.blur_px;
  }
  return focused.lens.focus_distance;
}

std::optional<Warning> locking_advice(Setup const& setup) {
  if (setup.target.kind == TargetKind::image) return {};  // dot sizes of an image target are unknown
  ImageDiameters const images = expected_images(setup);
  double const diameter = images.diameter_px();
  if (!(diameter < warned_image_px)) return {};
  Warning warning{WarningCode::unsuitable, "",
                  fmt::format("{} images are {:.2f} px wide (e^-2 diameter): below {:g} px peak locking occurs, an "
                              "error of about {:.2g} px",
                              setup.experiment().sources.one, diameter, min_image_px, images.locking_error_px())};
  std::string const cure = cures(setup, images);
  if (cure.empty()) {
    warning.text += "; widen them";
    return warning;
  }
  ImageDiameters const wide{images.geometric_px,
                            std::sqrt(square(min_image_px) - square(images.geometric_px) - square(images.blur_px)),
                            images.blur_px};
  warning.text +=
      fmt::format("; {} widens them to {:g} px (about {:.2g} px)", cure, min_image_px, wide.locking_error_px());
  return warning;
}

std::optional<Warning> locking_advice(Image<double> const& frame) {
  double const seen = measure_dot_diameter_px(middle_of(frame));
  double const diameter = std::sqrt(square(seen) - 16.0 / 12);
  if (!(diameter > smallest_seen && diameter < warned_image_px)) return {};
  ImageDiameters const images{0, diameter, 0}, wide{0, min_image_px, 0};
  return Warning{WarningCode::unsuitable, "",
                 fmt::format("dot images are about {:.2f} px wide (e^-2 diameter, by their autocorrelation): below "
                             "{:g} px peak locking occurs, an error of about {:.2g} px; an f-number {:.2g} times as "
                             "large, or a little defocus, widens them to {:g} px (about {:.2g} px)",
                             diameter, min_image_px, images.locking_error_px(), images.f_number_factor(min_image_px),
                             min_image_px, wide.locking_error_px())};
}

}  // namespace gladstone::inline cases
