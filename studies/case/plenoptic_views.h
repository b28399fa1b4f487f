#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/base/image.h"
#include "render/optics/elements/lenslets.h"
#include "render/scene/setup.h"

namespace gladstone::inline cases {

/// Geometry of a plenoptic camera: ideal thin lens, lenslets in its image plane, and the sensor behind them.
struct PlenopticCamera {
  double focal_length = 0;    ///< [m]
  double stop_diameter = 0;   ///< [m]
  double image_distance = 0;  ///< distance from lens to lenslets [m]
  LensletSetup lenslets;
  double pixel_pitch = 0;  ///< [m]

  /// @throws DataError, naming `where`, for cameras without lenslets, with a lens prescription or without a stop
  static PlenopticCamera of(Setup const& setup, std::string const& where);

  /// Returns the diameter of the image of the stop behind a lenslet [px].
  double picture_px() const { return lenslets.to_sensor * stop_diameter / image_distance / pixel_pitch; }
  /// Returns the parallax of a point at a distance from the lens: shift of its image, in pixels of a view (lenslet
  /// pitches), per distance between the views' positions in the stop: (1 - z_i / v) / pitch, with v the distance at
  /// which the lens images the point [px/m].
  double parallax(double distance) const;
};

/// Extracts views and refocused images from a plenoptic image (Ng et al., Stanford Tech Report CTSR 2005-02). Light
/// that passed the stop at `s` and reached the array at `a` lies on the sensor at axis + d (a - s) / z_i, where `axis`
/// is that of its lenslet and the sensor is in the lenslets' focal plane. The pixels at one position behind every
/// lenslet form the view from a small stop at s; views shifted by their parallax and averaged form an image focused at
/// another distance.
class PlenopticViews {
 public:
  /// @param raw  grey levels as recorded; must outlive this object
  PlenopticViews(PlenopticCamera const& camera, Image<double> const& raw);

  /// Computes the view from the position `s` in the stop, X right and Y up as the camera sees them [m]. The view is
  /// oriented as the raw image and has one pixel per lenslet pitch, with the optical axis at the centre of its middle
  /// pixel. Interpolates linearly between pixels, and between lenslets of a hexagonal array.
  Image<double> view(Vec2d s) const;
  /// Averages views, shifted so that points at `distance` from the lens [m] coincide. Scale and perspective are those
  /// of the central view.
  Image<double> refocused(std::vector<Vec2d> const& stops, double distance) const;

 private:
  double raw_at(Vec2d pixel) const;
  /// Returns the interpolated level at a position in the array, seen from s [m].
  double level(Vec2d place, Vec2d s) const;
  /// Returns the level behind the lenslet with this axis, seen from s [m].
  double of_lenslet(Vec2d axis, Vec2d s) const;
  template <class Level>
  Image<double> picture(Level const& level) const;

  PlenopticCamera camera_;
  Image<double> const& raw_;
  int half_columns_, half_rows_;  ///< number of lenslets on either side of the middle one, along each axis
};

/// Returns the positions within a stop of a square grid with `across` points per diameter [m].
std::vector<Vec2d> stop_positions(double diameter, int across);

/// Result of write_views().
struct ViewsWritten {
  std::string folder;
  std::size_t views = 0;
  int columns = 0, rows = 0;
  PlenopticCamera camera;
  std::string json;
};

/// Extracts the views of both frames of a CASE into FOLDER/FRAME/view_ROW_COLUMN.tif, numbered from the stop's upper
/// left as the camera sees it, and optionally images focused on the plane Z = refocus_z into FRAME_refocused.tif.
/// views.json lists the files with their positions in the stop.
/// @param across     number of views over the stop's diameter
/// @param refocus_z  plane of focus [m]
/// @throws DataError if the case has no plenoptic camera
ViewsWritten write_views(std::string const& case_folder, std::string const& folder, int across,
                         std::optional<double> refocus_z);

}  // namespace gladstone::inline cases
