#include "studies/compare/calibrate.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "render/base/units.h"
#include "render/files/hdf5_file.h"
#include "render/files/image_file.h"
#include "render/light/calibration_target.h"
#include "render/scene/build_camera.h"
#include "render/scene/calibration_planes.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/cameras.h"
#include "studies/case/case.h"
#include "studies/case/case_kind.h"
#include "studies/compare/calibration_fit.h"

namespace gladstone::inline compare {
namespace {

constexpr std::size_t least_dots = 12;  // minimum number of dots on a plane

/// Computes the expected image of the grid on a plane from the setup's camera: middle dot and spacing vectors [px].
ExpectedView expected_view(Setup const& setup, double z, std::string const& name) {
  Camera const camera = build_camera(plane_setup(setup, z));
  auto const middle = camera.project({0, 0, z});
  auto const seen = camera.see({}, Pose<double>{{0, 0, z}});
  if (!middle || !seen) {
    throw DataError(ErrorCode::invalid_value, name,
                    fmt::format("the camera of its setup does not see the middle of the grid at Z = {:.6g} mm, "
                                "which is required to identify the dots; check camera.pose and lens",
                                z / unit::millimetre));
  }
  return {*middle, setup.target.spacing * seen->by_x, setup.target.spacing * seen->by_y};
}

CalibrationGrid make_calibration_grid(Setup const& setup) {
  Lattice const lattice(setup.target);
  return {lattice.half_columns, lattice.half_rows, lattice.spacing, setup.dot_diameter()};
}

/// Returns the entrance pupil of the setup's lens and the object plane conjugate to its sensor.
CalibratedLens lens_of(Setup const& setup) {
  ImagingGeometry const imaging = setup.imaging();
  Pose<double> const pose = setup.camera_pose();
  CalibratedLens lens;
  if (!std::isfinite(setup.focus_distance()) || !std::isfinite(imaging.entrance_pupil)) return lens;
  lens.pupil_radius = imaging.entrance_pupil / 2;
  lens.focus_point = pose.origin - setup.focus_distance() * pose.z;
  // A sensor at z' = z_i - M a . (x', y') is conjugate to the plane z = -Z + a . (x, y), see sensor_tilt().
  Vec2d const tilt = sensor_tilt(setup);
  Vec3d const sensor = Pose<double>{}.turned({tilt.x, tilt.y, 0}).z;
  double const per_slope = imaging.magnification * setup.z_b() / setup.focus_distance() * sensor.z;
  lens.focus_normal = normalized(pose.z - (sensor.x / per_slope) * pose.x - (sensor.y / per_slope) * pose.y);
  return lens;
}

/// Returns the camera properties known from the setup, for comparison with the fitted camera.
ExpectedCamera expected_camera(Setup const& setup) {
  ExpectedCamera expected;
  expected.is_pinhole = !setup.has_refracting_elements();
  if (!expected.is_pinhole) return expected;
  if (auto const pinhole = equivalent_pinhole(setup, build_camera(plane_setup(setup, 0)))) {
    expected.principal_point_px = Vec2d{pinhole->cx, pinhole->cy};
    expected.focal_length_px = pinhole->fx;
  } else if (sensor_tilt(setup) == Vec2d{}) {
    expected.principal_point_px = Vec2d{0.5 * (setup.camera.columns - 1), 0.5 * (setup.camera.rows - 1)};
  }
  return expected;
}

/// Reads the image of a plane; throws if its size differs or its pixels equal those of an earlier plane.
Image<double> read_plane(Calibration& calibration, Setup const& setup, std::string const& file, std::size_t plane) {
  ImageMetadata metadata;
  Image<double> picture = read_image(file, &metadata);
  std::string const name = std::filesystem::path(case_file::plane(plane)).stem().string();
  std::string const hash = pixel_sha256(picture, metadata.sample_bits);
  for (std::size_t before = 0; before < calibration.planes.size(); ++before) {
    CalibratedPlane const& other = calibration.planes[before];
    if (hash != other.sha256) continue;
    throw DataError(ErrorCode::inconsistent, file,
                    fmt::format("is the same image as {}, pixel by pixel, although it should show Z = {:.6g} mm "
                                "and that one {:.6g} mm; give the image of its plane",
                                other.file, setup.planes[plane] / unit::millimetre, other.z / unit::millimetre));
  }
  calibration.sources.add(name, file, SourceFiles::Holds::pixels, hash);
  bool const first = calibration.planes.empty();
  if (!first && (picture.columns() != calibration.columns || picture.rows() != calibration.rows)) {
    throw DataError(
        ErrorCode::wrong_shape, file,
        fmt::format("is {} x {} px, but the images of the previous planes are {} x {}; use images of one camera",
                    picture.columns(), picture.rows(), calibration.columns, calibration.rows));
  }
  if (picture.columns() != setup.camera.columns || picture.rows() != setup.camera.rows) {
    throw DataError(ErrorCode::wrong_shape, file,
                    fmt::format("is {} x {} px, but camera.pixels of the setup is [{}, {}]; correct camera.pixels",
                                picture.columns(), picture.rows(), setup.camera.columns, setup.camera.rows));
  }
  if (count_not_finite(picture) > 0)
    throw DataError(ErrorCode::invalid_value, file, "has pixels that are nan or infinite; export it again");
  if (metadata.orientation != 1) {
    calibration.warnings.push_back({WarningCode::assumed, file,
                                    fmt::format("is stored rotated or mirrored (Orientation {}), and was rotated "
                                                "upright; if that entry is wrong, write the image without it",
                                                metadata.orientation)});
  }
  calibration.columns = picture.columns();
  calibration.rows = picture.rows();
  CalibratedPlane& calibrated = calibration.planes.emplace_back();
  calibrated.file = file;
  calibrated.z = setup.planes[plane];
  calibrated.sha256 = hash;
  return picture;
}

/// Warns if the middle dot is uncertain by one spacing, and if the detected grid is larger than the setup's.
void warn_of_assignment(Calibration& calibration, AssignedDots const& assigned, CalibrationGrid const& grid,
                        std::string const& file) {
  constexpr double doubtful = 0.3;  // in dot spacings
  int const columns = 2 * grid.half_columns + 1, rows = 2 * grid.half_rows + 1;
  if (assigned.columns > columns || assigned.rows > rows) {
    calibration.warnings.push_back(
        {WarningCode::inconsistent, file,
         fmt::format("{} x {} dots are seen, but calibration.extent_mm and spacing_mm define {} x {}; correct these, "
                     "since the edges determine the middle of the grid",
                     assigned.columns, assigned.rows, columns, rows)});
  }
  if (assigned.middle_by == CentreDotMethod::expected_view && assigned.middle_offset > doubtful) {
    calibration.warnings.push_back(
        {WarningCode::assumed, file,
         fmt::format("the middle dot is a guess: the camera of the setup sees the middle {:.2f} spacings from it; give "
                     "the position of the camera more accurately, or show the whole grid",
                     assigned.middle_offset)});
  }
}

/// Detects the dots in a plane's image and appends them.
void add_plane(Calibration& calibration, PlateDots& all, Setup const& setup, std::string const& file,
               std::size_t plane) {
  DetectedDots const detected = detect_dots(read_plane(calibration, setup, file, plane));
  CalibrationGrid const grid = make_calibration_grid(setup);
  AssignedDots const assigned = assign_to_grid(detected.dots, grid, expected_view(setup, setup.planes[plane], file));
  CalibratedPlane& added = calibration.planes.back();
  added.found = detected.dots.size();
  added.used = assigned.dots.size();
  added.not_dots = detected.not_dots.size();
  added.strangers = assigned.strangers;
  added.middle_by = assigned.middle_by;
  added.smoothness_px = assigned.smoothness_px;
  if (added.used < least_dots) {
    throw DataError(
        ErrorCode::undetermined, file,
        fmt::format("shows {} dots of the grid, but {} are required ({} detected spots look like dots, {} differ "
                    "in size or shape); check focus, light and contrast, and [calibration] in setup.toml",
                    added.used, least_dots, added.found, added.not_dots));
  }
  warn_of_assignment(calibration, assigned, grid, file);
  for (GridDot const& dot : assigned.dots) {
    all.pixel.push_back(dot.pixel);
    all.plane_of.push_back(plane);
    all.index.push_back({dot.i, dot.j});
  }
}

/// Reads the true pinhole camera from a truth.h5; nullopt if the file or the camera does not exist.
std::optional<PinholeCamera> rendered_camera(std::string const& path, PinholeCamera const& fitted) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::nullopt;
  Hdf5Reader const file(path);
  if (!file.has("/pinhole/camera_matrix")) return std::nullopt;
  auto const read = [&](char const* name, std::size_t count) {
    std::vector<double> values = file.read(name);
    if (values.size() != count)
      throw DataError(ErrorCode::wrong_shape, path, std::string(name) + " has a wrong shape; render the case again");
    return values;
  };
  std::vector<double> const matrix = read("/pinhole/camera_matrix", 9), brown = read("/pinhole/distortion", 4),
                            t = read("/pinhole/tvec", 3);
  std::vector<double> r = read("/pinhole/rvec", 3);
  // The vectors r and r (1 - 2 pi / |r|) describe the same rotation; use the one closer to the fitted vector.
  double const angle = std::hypot(r[0], r[1], r[2]);
  double along = 0;
  for (std::size_t i = 0; i < 3; ++i) along += r[i] * fitted.value[8 + i];
  if (along < 0 && angle > 0) {
    for (double& component : r) component *= 1 - 2 * pi / angle;
  }
  return PinholeCamera{{matrix[0], matrix[4], matrix[2], matrix[5], brown[0], brown[1], brown[2], brown[3], r[0], r[1],
                        r[2], t[0], t[1], t[2]}};
}

}  // namespace

namespace {

/// Detects the dots of all planes and fits the camera models.
/// @param setup_path  path of the setup file, read as `loaded`
/// @param name        name of the case or setup, for messages
Calibration calibrate(CaseSetup const& loaded, std::string const& setup_path, std::vector<std::string> const& pictures,
                      std::string const& name) {
  Setup const& setup = loaded.setup;
  Calibration calibration;
  calibration.sources.on_change("run gladstone calibrate " + name + " again");
  calibration.sources.add("", setup_path, SourceFiles::Holds::bytes);
  if (setup.planes.size() < 2) {
    throw DataError(ErrorCode::undetermined, setup_path,
                    "calibration.planes_mm has one plane (which does not determine both the distance and the focal "
                    "length of a camera); give two planes or more, three for the polynomial's terms with Z^2");
  }
  calibration.setup = loaded.document.resolved();
  calibration.seed = setup.render.seed;
  PlateDots dots;
  dots.z = setup.planes;
  dots.spacing = make_calibration_grid(setup).spacing;
  dots.dot_radius = setup.dot_diameter() / 2;
  dots.lens = lens_of(setup);
  for (std::size_t plane = 0; plane < setup.planes.size(); ++plane) {
    add_plane(calibration, dots, setup, pictures[plane], plane);
  }
  fit_calibration(calibration, std::move(dots), expected_camera(setup), name);
  return calibration;
}

}  // namespace

Calibration calibrate_case(std::string const& folder) {
  require_case(folder);
  auto const in_folder = [&folder](std::string const& name) { return (std::filesystem::path(folder) / name).string(); };
  CaseSetup const loaded = load_case_setup(in_folder(case_file::setup), {});
  require_experiment(loaded.setup, calibration_experiment, folder,
                     "is a BOS case, which cannot calibrate a camera; render a setup with experiment = \"calibration\" "
                     "and a table [calibration]");
  std::vector<std::string> pictures;
  for (std::size_t plane = 0; plane < loaded.setup.planes.size(); ++plane) {
    pictures.push_back(in_folder(case_file::plane(plane)));
  }
  Calibration calibration = calibrate(loaded, in_folder(case_file::setup), pictures, folder);
  calibration.rendered = rendered_camera(in_folder(case_file::truth), calibration.pinhole.camera);
  return calibration;
}

Calibration calibrate_images(std::string const& setup, std::vector<std::string> const& pictures) {
  SetupDocument document = read_setup_document(setup);
  if (std::vector<std::string> const cameras = camera_names(document); !cameras.empty()) {
    throw DataError(ErrorCode::wrong_format, setup,
                    fmt::format("has {} cameras ({}), but the images belong to one; keep only its [[camera]], "
                                "and calibrate the others in the same way",
                                cameras.size(), fmt::join(cameras, ", ")));
  }
  CaseSetup const loaded = load_case_setup(std::move(document));
  require_experiment(
      loaded.setup, calibration_experiment, setup,
      "is not the setup of a calibration; set experiment = \"calibration\" and describe in [calibration] "
      "what the images show");
  if (pictures.size() != loaded.setup.planes.size()) {
    throw DataError(ErrorCode::inconsistent, setup,
                    fmt::format("calibration.planes_mm has {} planes, but {} images are given; give one image "
                                "for each plane, in that order",
                                loaded.setup.planes.size(), pictures.size()));
  }
  return calibrate(loaded, setup, pictures, setup);
}

}  // namespace gladstone::inline compare
