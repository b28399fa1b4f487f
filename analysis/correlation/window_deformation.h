#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "analysis/correlation/bspline_image.h"
#include "analysis/correlation/interrogation_grid.h"
#include "analysis/correlation/predictor_view.h"
#include "render/base/image.h"
#include "render/base/uninitialized_vector.h"
#include "render/base/vec.h"

namespace gladstone::inline correlation {

/// Image pair in the form used by a correlation pass: grey levels row by row, in float, after subtraction of a common
/// level and multiplication by a power of two.
struct ImagePair {
  int columns = 0;
  int rows = 0;
  UninitializedVector<float> reference;
  UninitializedVector<float> flow;
  /// 1 at pixels that are known in both images, otherwise 0; empty: all pixels are known.
  UninitializedVector<float> available;
  float contrast = 0.0f;  ///< scaled range of the grey levels of both images
};

/// Interpolates a displacement from the nodes of a grid to every pixel: cubic convolution (Keys, IEEE Trans. ASSP 29
/// (1981) 1153) between the nodes, linear extrapolation beyond the outermost, so that linear fields are reproduced
/// everywhere.
class DensePredictor {
 public:
  /// @param nodes  displacement at grid.centre(i) [px], grid.size() finite values
  DensePredictor(InterrogationGrid const& grid, std::span<Vec2d const> nodes, int image_columns, int image_rows);

  Vec2d at(Vec2d position_px) const { return view().at(position_px); }
  /// Computes the displacement at every pixel centre of an image row.
  /// @param u,  v  output: one value per column [px]
  void row(int image_row, std::span<float> u, std::span<float> v) const;

  PredictorView view() const { return {grid_, ghosts_, columns_, rows_, nodes_.data()}; }

 private:
  InterrogationGrid grid_;
  int ghosts_;
  int columns_;  // number of columns of nodes, including the ghost nodes
  int rows_;
  std::vector<Vec2d> nodes_;
  std::vector<int> column_first_;         // [image column] first of the four nodes
  std::vector<float> column_weights_[4];  // [node][image column]
};

/// Grey levels of both images of a deformed pair at one pixel.
struct DeformedPixel {
  float reference;
  float flow;
  float available;
};

/// Returns known(column, row) of the pixel nearest to (x, y) [px]; 0 outside the image.
template <class Known>
GLADSTONE_HD float known_at(float x, float y, int columns, int rows, Known const& known) {
  auto const nearest = [](float position, int count) {
    int const k = static_cast<int>(std::lround(position));
    return k < 0 ? 0 : (k > count - 1 ? count - 1 : k);
  };
  bool const inside =
      x >= -0.5f && x <= static_cast<float>(columns) - 0.5f && y >= -0.5f && y <= static_cast<float>(rows) - 0.5f;
  return inside ? known(nearest(x, columns), nearest(y, rows)) : 0.0f;
}

/// Returns pixel (i, j) of reference(x - d/2) and flow(x + d/2).
/// @param u,  v  displacement d at the pixel [px]
/// @param known  returns 1 if both original images are known at a pixel (column, row), otherwise 0
template <int degree, class Known>
GLADSTONE_HD DeformedPixel deformed_pixel(BsplineView<float> const& reference, BsplineView<float> const& flow, int i,
                                          int j, float u, float v, Known const& known) {
  int const columns = reference.columns, rows = reference.rows;
  float const half_u = 0.5f * u, half_v = 0.5f * v;
  float const x = static_cast<float>(i), y = static_cast<float>(j);
  float const in_reference = known_at(x - half_u, y - half_v, columns, rows, known);
  float const in_flow = known_at(x + half_u, y + half_v, columns, rows, known);
  return {reference.sample<degree>(i, j, -half_u, -half_v), flow.sample<degree>(i, j, half_u, half_v),
          in_reference < in_flow ? in_reference : in_flow};
}

/// Deforms both images of a pair by half the displacement each, in opposite directions (Scarano, Meas. Sci. Technol. 13
/// (2002) R1; Wereley & Meinhart, Exp. Fluids 31 (2001) 258). A pattern displaced by exactly the predictor coincides in
/// both deformed images. The residual displacement belongs to the mid-position and is second-order accurate in time.
class PairDeformer {
 public:
  /// Prepares both frames for deformation. Pixels that are not finite count as unknown.
  /// @param degree  degree of the B-spline, 3 or 5, or windowed_sinc
  PairDeformer(Image<double> const& reference, Image<double> const& flow, int degree);

  /// Returns the deformed pair reference(x - d(x)/2) and flow(x + d(x)/2), with d the predictor [px].
  ImagePair deform(DensePredictor const& predictor) const;
  /// Deforms the pair like deform() above, but reuses the memory of an earlier result.
  void deform(DensePredictor const& predictor, ImagePair& pair) const;
  /// Returns the pair without deformation.
  ImagePair const& original() const { return original_; }

 private:
  int degree_;
  ImagePair original_;
  BsplineImage<float> reference_;
  BsplineImage<float> flow_;
};

/// Converts two images to an ImagePair without deformation. Pixels that are not finite are filled with the mid-range
/// level and marked as unknown.
ImagePair make_image_pair(Image<double> const& reference, Image<double> const& flow);

}  // namespace gladstone::inline correlation
