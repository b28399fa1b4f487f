#include "studies/compare/calibration_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "render/base/error.h"
#include "render/base/median.h"
#include "render/base/units.h"

namespace gladstone::inline compare {
namespace {

// lower bound of the dots' scatter within a plane, used as reference for residuals
constexpr double least_scatter_px = 0.01;
constexpr double suspicious = 5;  // multiple of the dots' scatter above which the cause of a residual is investigated
constexpr double refused = 10;    // multiple of the dots' scatter above which a residual is reported as an error
constexpr double least_refused_px = 0.5;   // residual below which only a warning is given
constexpr double outlier_deviations = 8;   // residual of an outlier, in robust standard deviations
constexpr double least_outlier_px = 0.05;  // residual below which a dot is never an outlier
constexpr double same_place = 3;  // rms distance, in multiples of the dots' scatter, below which two planes coincide
constexpr double principal_share = 0.05;  // allowed error of the principal point, relative to the image's longer side
constexpr double tilted_share = 0.2;      // additional allowed error, relative to its displacement by the sensor's tilt
constexpr double deviations = 6;          // significance limit, in standard errors
constexpr double least_known = 0.2;       // relative standard error of a focal length above which an error is reported
// relative difference from the setup's focal length that causes a warning; nominal focal lengths of lenses hold to 2 %
constexpr double other_focal_length = 0.02;
constexpr double square_pixels = 0.01;  // relative difference of fx and fy that causes a warning

double degrees(double sine) { return std::asin(std::clamp(sine, -1.0, 1.0)) * 180 / pi; }

/// State of a calibration during the fit.
class CalibrationFit {
 public:
  CalibrationFit(Calibration& calibration, PlateDots dots, ExpectedCamera const& expected, std::string const& name)
      : calibration_(calibration), dots_(std::move(dots)), expected_(expected), name_(name) {
    for (CalibratedPlane const& plane : calibration.planes) scatter_ = std::max(scatter_, plane.smoothness_px);
  }

  void run() {
    refuse_planes_in_one_place();
    fit();
    if (has_suspicious_residuals()) explain_residuals();
    if (has_other_principal_point()) explain_principal_point();
    if (!has_suspicious_residuals()) remove_outliers();
    check_residuals();
    check_camera();
    fit_polynomial();
    store();
  }

 private:
  PinholeFit& pinhole() { return calibration_.pinhole; }
  std::string const& file(std::size_t plane) const { return calibration_.planes[plane].file; }
  double z_mm(std::size_t plane) const { return dots_.z[plane] / unit::millimetre; }
  Vec2d middle_px() const { return {0.5 * (calibration_.columns - 1), 0.5 * (calibration_.rows - 1)}; }
  double focal_length() { return 0.5 * (pinhole().camera.fx() + pinhole().camera.fy()); }
  void warn(Warning warning) { calibration_.warnings.push_back(std::move(warning)); }

  /// Throws if dots are at the same pixels in two planes, that is, if the plate was not moved.
  void refuse_planes_in_one_place() const {
    std::vector<std::map<std::array<int, 2>, Vec2d>> seen(dots_.z.size());
    for (std::size_t k = 0; k < dots_.pixel.size(); ++k) seen[dots_.plane_of[k]][dots_.index[k]] = dots_.pixel[k];
    for (std::size_t a = 0; a < seen.size(); ++a) {
      for (std::size_t b = a + 1; b < seen.size(); ++b) {
        double squares = 0, count = 0;
        for (auto const& [place, pixel] : seen[a]) {
          auto const there = seen[b].find(place);
          if (there == seen[b].end()) continue;
          Vec2d const apart = there->second - pixel;
          squares += dot(apart, apart);
          count += 2;
        }
        if (count == 0 || squares > std::pow(same_place * scatter_, 2) * count) continue;
        throw DataError(
            ErrorCode::inconsistent, file(b),
            fmt::format("shows the dots at the same pixels as {}, to within {:.2g} px rms, although it should show Z = "
                        "{:.6g} mm and that one {:.6g} mm (the same image twice, a plate that was not moved, or a "
                        "telecentric lens, which is not a pinhole camera); give the image of its plane",
                        file(a), std::sqrt(squares / count), z_mm(b), z_mm(a)));
      }
    }
  }

  void fit() {
    try {
      pinhole() = fit_pinhole(dots_.points(placement_), middle_px());
    } catch (std::invalid_argument const& reason) {
      refuse_open(reason.what());
    }
    // Planes in reverse order fit a camera on the other side of the plate equally well.
    if (pinhole().camera.value.back() <= 0) {
      throw DataError(ErrorCode::inconsistent, name_,
                      "only fits a camera with the dots behind it; give the images in the order of "
                      "calibration.planes_mm, with Z towards the camera");
    }
  }

  [[noreturn]] void refuse_open(std::string const& why) const {
    throw DataError(ErrorCode::undetermined, name_,
                    fmt::format("cannot be fitted ({}); show more rows, columns and planes of dots", why));
  }

  bool has_suspicious_residuals() { return !(pinhole().rms_px <= suspicious * scatter_); }

  bool has_other_principal_point() {
    if (!expected_.principal_point_px) return false;
    Vec2d const expected = *expected_.principal_point_px, middle = middle_px();
    Vec2d const off{pinhole().camera.cx() - expected.x, pinhole().camera.cy() - expected.y};
    double const share =
        principal_share * std::max(calibration_.columns, calibration_.rows) + tilted_share * length(expected - middle);
    auto const beyond = [&](double by, double standard_error) {
      return std::abs(by) > std::max(share, deviations * standard_error);
    };
    return !std::isfinite(off.x + off.y) || beyond(off.x, pinhole().standard_error[2]) ||
           beyond(off.y, pinhole().standard_error[3]);
  }

  void explain_residuals() {
    if (auto const order = find_image_order(dots_)) {
      std::vector<std::string> names(order->size());
      for (std::size_t k = 0; k < order->size(); ++k) names[(*order)[k]] = file(k);
      throw DataError(ErrorCode::inconsistent, name_,
                      fmt::format("has a residual of {:.3g} px rms, but fits in another order of the images: {}; give "
                                  "the images in the order of calibration.planes_mm, or correct planes_mm",
                                  pinhole().rms_px, fmt::join(names, ", ")));
    }
    try_placement(find_misidentified_centres(dots_, expected_.principal_point_px.value_or(middle_px())));
  }

  void explain_principal_point() {
    if (placement_.moved.empty()) try_placement(find_drift(dots_, *expected_.principal_point_px));
    if (!has_other_principal_point()) return;
    warn({WarningCode::implausible, "",
          fmt::format("the principal point ({:.1f}, {:.1f}) px is far from the setup's, ({:.1f}, {:.1f}) px (the plate "
                      "was tilted relative to its direction of motion, or the sensor is tilted or shifted); check the "
                      "plate, or set the tilt in camera.sensor",
                      pinhole().camera.cx(), pinhole().camera.cy(), expected_.principal_point_px->x,
                      expected_.principal_point_px->y)});
  }

  /// Fits with another placement of the plate; reverts to the previous fit if the residuals increase.
  void try_placement(std::optional<PlatePlacement> const& placement) {
    if (!placement) return;
    PinholeFit const before = pinhole();
    placement_ = *placement;
    fit();
    if (!(pinhole().rms_px <= std::max(suspicious * scatter_, before.rms_px)) || has_other_principal_point()) {
      placement_ = {};
      pinhole() = before;
      return;
    }
    for (std::size_t plane = 0; plane < placement_.moved.size(); ++plane) {
      std::array<int, 2> const by = placement_.moved[plane];
      if (by == std::array<int, 2>{}) continue;
      warn({WarningCode::assumed, file(plane),
            fmt::format(
                "the middle dot was found {} columns and {} rows off and was corrected; the residual is {:.2g} px "
                "rms, and {:.2g} px without the correction, which puts the principal point at ({:.0f}, {:.0f}) "
                "px",
                by[0], by[1], pinhole().rms_px, before.rms_px, before.camera.cx(), before.camera.cy())});
    }
    if (Vec2d const drift = placement_.drift; length(drift) > 0) {
      warn({WarningCode::inconsistent, "",
            fmt::format("the plate was moved at {:.3g} degrees to its normal ({:.3g} towards X, {:.3g} towards Y); "
                        "world coordinates refer to the plate: X and Y in it, Z along its normal (otherwise the "
                        "principal point would be ({:.0f}, {:.0f}) px)",
                        degrees(length(drift)), degrees(drift.x), degrees(drift.y), before.camera.cx(),
                        before.camera.cy())});
    }
  }

  void remove_outliers() {
    std::vector<double> sizes;
    for (Vec2d const residual : pinhole().residual_px) sizes.push_back(length(residual));
    double const deviation = upper_median(sizes) / 1.1774;  // ratio for the median of a Rayleigh distribution
    double const limit = std::max(outlier_deviations * deviation, least_outlier_px);
    PlateDots kept = dots_;
    kept.pixel.clear();
    kept.index.clear();
    kept.plane_of.clear();
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      CalibratedPlane& plane = calibration_.planes[dots_.plane_of[k]];
      if (sizes[k] > limit) {
        plane.strangers.push_back(dots_.pixel[k]);
        --plane.used;
        continue;
      }
      kept.pixel.push_back(dots_.pixel[k]);
      kept.index.push_back(dots_.index[k]);
      kept.plane_of.push_back(dots_.plane_of[k]);
    }
    if (kept.pixel.size() == dots_.pixel.size()) return;
    dots_ = std::move(kept);
    fit();
  }

  /// Returns the plane with the largest rms residual.
  std::size_t worst_plane() {
    std::vector<double> squares(dots_.z.size()), count(dots_.z.size());
    for (std::size_t k = 0; k < dots_.pixel.size(); ++k) {
      squares[dots_.plane_of[k]] += dot(pinhole().residual_px[k], pinhole().residual_px[k]);
      count[dots_.plane_of[k]] += 1;
    }
    std::size_t worst = 0;
    for (std::size_t k = 1; k < squares.size(); ++k) {
      if (squares[k] * count[worst] > squares[worst] * count[k]) worst = k;
    }
    return worst;
  }

  void check_residuals() {
    if (!has_suspicious_residuals()) return;
    double const rms = pinhole().rms_px;
    std::string const text = fmt::format(
        "the residual of the camera is {:.3g} px rms, but within their planes the dots scatter by only {:.2g} px; it "
        "is largest at Z = {:.6g} mm",
        rms, scatter_, z_mm(worst_plane()));
    if (rms > least_refused_px && rms > refused * scatter_) {
      throw DataError(
          ErrorCode::inconsistent, file(worst_plane()),
          text +
              "; so the images do not belong to one camera and parallel planes (a wrong Z in calibration.planes_mm, or "
              "plate, camera or lens were turned or moved between images); correct planes_mm, or record the images "
              "again");
    }
    warn({WarningCode::low_accuracy, "",
          text + (expected_.is_pinhole ? " (a lens or windows that no pinhole camera with distortion describes, or "
                                         "planes at other positions than calibration.planes_mm); prefer the polynomial"
                                       : " (a pinhole camera does not describe windows); prefer the polynomial")});
  }

  void check_camera() {
    PinholeFit const& fit = pinhole();
    double const f = focal_length();
    double const f_error = std::max(fit.standard_error[0], fit.standard_error[1]);
    bool const finite = std::all_of(fit.standard_error.begin(), fit.standard_error.end(),
                                    [](double error) { return std::isfinite(error); });
    if (!finite || !(f_error < least_known * f)) {
      throw DataError(ErrorCode::undetermined, name_,
                      fmt::format("does not determine the camera: fx = {:.6g} px with a standard error of "
                                  "{:.2g} px, which is {} (planes that hardly differ, few dots, or an image "
                                  "given twice); show planes farther apart, and more rows and columns of dots",
                                  fit.camera.fx(), f_error, finite ? "too large" : "not finite"));
    }
    if (!fit.converged)
      warn({WarningCode::low_accuracy, "",
            "the fit of the pinhole camera has not converged; show more planes, rows and columns of dots"});
    if (expected_.is_pinhole &&
        std::abs(fit.camera.fx() - fit.camera.fy()) > std::max(square_pixels * f, deviations * f_error)) {
      refuse_guessed_middles();
      warn({WarningCode::implausible, "",
            fmt::format("fx = {:.6g} and fy = {:.6g} px differ, although pixels are square (a plate that is tilted or "
                        "stretched); check calibration.spacing_mm along both axes",
                        fit.camera.fx(), fit.camera.fy())});
    }
    if (expected_.focal_length_px &&
        std::abs(f - *expected_.focal_length_px) > std::max(other_focal_length * f, deviations * f_error)) {
      warn({WarningCode::implausible, "",
            fmt::format("the focal length of {:.6g} px differs by {:.2g} % from the {:.6g} px of the setup's lens and "
                        "pixels, more than the tolerance of {:.0f} % of nominal focal lengths; check "
                        "calibration.planes_mm and spacing_mm, the order of the images, and the lens",
                        f, 100 * std::abs(f / *expected_.focal_length_px - 1), *expected_.focal_length_px,
                        100 * other_focal_length)});
    }
  }

  /// Throws if the plate seems to have moved obliquely and the middle dot of a plane is a guess. For a camera with
  /// unequal fx and fy, the guess is more likely wrong than the motion oblique.
  void refuse_guessed_middles() const {
    if (length(placement_.drift) == 0) return;
    std::vector<std::string> guessed;
    for (CalibratedPlane const& plane : calibration_.planes) {
      if (plane.middle_by == CentreDotMethod::expected_view) guessed.push_back(plane.file);
    }
    if (guessed.empty()) return;
    PinholeCamera const& camera = calibration_.pinhole.camera;
    throw DataError(
        ErrorCode::inconsistent, name_,
        fmt::format(
            "cannot be calibrated: the best fit is implausible (fx = {:.6g} and fy = {:.6g} px differ, and the "
            "plate moves at {:.3g} degrees to its normal), probably since the middle dot was guessed wrongly in "
            "{}, which shows a part of the grid only; show the whole grid in every image, or set camera.pose "
            "to the actual position and direction of the camera",
            camera.fx(), camera.fy(), degrees(length(placement_.drift)), fmt::join(guessed, ", ")));
  }

  void fit_polynomial() {
    try {
      calibration_.soloff = fit_soloff(dots_.points(placement_));
    } catch (std::invalid_argument const& reason) {
      refuse_open(reason.what());
    }
  }

  void store() {
    calibration_.points = dots_.points(placement_);
    calibration_.plane_of = dots_.plane_of;
    calibration_.index = dots_.index;
    calibration_.drift = placement_.drift;
    for (std::size_t k = 0; k < dots_.index.size() && !placement_.moved.empty(); ++k) {
      for (std::size_t axis = 0; axis < 2; ++axis) {
        calibration_.index[k][axis] += placement_.moved[dots_.plane_of[k]][axis];
      }
    }
    for (CalibratedPlane const& plane : calibration_.planes) {
      if (plane.strangers.empty()) continue;
      warn({WarningCode::excluded, plane.file,
            fmt::format("{} spots on the grid differ from its dots in position or size (dirt, letters), the first at "
                        "({:.1f}, {:.1f}) px, and were excluded",
                        plane.strangers.size(), plane.strangers[0].x, plane.strangers[0].y)});
    }
  }

  Calibration& calibration_;
  PlateDots dots_;
  ExpectedCamera const& expected_;
  std::string const& name_;
  PlatePlacement placement_;
  double scatter_ = least_scatter_px;  ///< scatter of the dots within their planes [px]
};

}  // namespace

void fit_calibration(Calibration& calibration, PlateDots dots, ExpectedCamera const& expected,
                     std::string const& name) {
  CalibrationFit(calibration, std::move(dots), expected, name).run();
}

}  // namespace gladstone::inline compare
