#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/base/image.h"
#include "render/optics/lenslet_array.h"
#include "render/scene/setup.h"

namespace gladstone {

/// What a plenoptic picture was taken with: an ideal thin lens, lenslets in its image plane, the sensor behind them.
struct PlenopticCamera {
  double focal_length = 0;    ///< [m]
  double stop_diameter = 0;   ///< [m]
  double image_distance = 0;  ///< from the lens to the lenslets [m]
  LensletSetup lenslets;
  double pixel_pitch = 0;  ///< [m]

  /// @throws DataError, naming `where`, for cameras without lenslets, with a prescription or without a stop
  static PlenopticCamera of(Setup const& setup, std::string const& where);

  /// Pixels that a lenslet's picture of the stop is wide.
  double picture_px() const { return lenslets.to_sensor * stop_diameter / image_distance / pixel_pitch; }
  /// By how many pixels of a view (pitches of the lenslets) the image of a point at a distance from the lens moves
  /// between views, over the way between their places in the stop: (1 - z_i / v) / pitch, v where the lens images the
  /// point [px/m].
  double parallax(double distance) const;
};

/// Pictures that a plenoptic one holds, after Ng et al., Stanford Tech Report CTSR 2005-02: light that met the array at
/// `a` and had passed the stop at `s` lies on the sensor at axis + d (a - s) / z_i, axis that of its lenslet, for a
/// sensor in the lenslets' focal plane. So one place behind every lenslet makes a view as from a small stop at s, and
/// views moved by their parallax and averaged make a picture focused elsewhere.
class PlenopticViews {
 public:
  /// @param raw grey levels as the sensor has them; it must outlive this
  PlenopticViews(PlenopticCamera const& camera, Image<double> const& raw);

  /// A picture as upright as the raw one, of one pixel a lenslet pitch, the axis in the middle of its middle pixel;
  /// from the place `s` of the stop, X right and Y up as the camera sees them [m]. Between pixels, and between lenslets
  /// of a hexagonal array, levels are linear.
  Image<double> view(Vec2d s) const;
  /// Mean of views, moved so that what lies at that distance from the lens [m] stands still; scale and perspective are
  /// those of the view from the middle.
  Image<double> refocused(std::vector<Vec2d> const& stops, double distance) const;

 private:
  double raw_at(Vec2d pixel) const;
  /// Level of a place of the array, seen from s [m].
  double level(Vec2d place, Vec2d s) const;
  double of_lenslet(Vec2d axis, Vec2d s) const;
  template <class Level>
  Image<double> picture(Level const& level) const;

  PlenopticCamera camera_;
  Image<double> const& raw_;
  int half_columns_, half_rows_;  ///< lenslets to either side of the middle
};

/// Places of a stop, `across` of them over its diameter in either direction, those within it [m].
std::vector<Vec2d> places_of_stop(double diameter, int across);

/// What `gladstone views` writes.
struct ViewsWritten {
  std::string folder;
  std::size_t views = 0;
  int columns = 0, rows = 0;
  PlenopticCamera camera;
  std::string json;
};

/// Extracts the views of both frames of a CASE into FOLDER/FRAME/view_ROW_COLUMN.tif, counted from the stop's upper
/// left as the camera sees it, and where asked for its pictures focused on a plane Z = z [m] into FRAME_refocused.tif;
/// views.json says which is which.
/// @param across views over the stop's diameter
/// @throws DataError where the case has no plenoptic camera
ViewsWritten write_views(std::string const& case_folder, std::string const& folder, int across,
                         std::optional<double> refocus_z);

}  // namespace gladstone
