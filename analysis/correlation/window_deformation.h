#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "analysis/correlation/bspline_image.h"
#include "analysis/correlation/interrogation_grid.h"
#include "analysis/correlation/predictor_view.h"
#include "render/base/image.h"
#include "render/base/unset_vector.h"
#include "render/base/vec.h"

namespace gladstone {

/// Two images as a correlation pass reads them, row by row, with their joint grey level removed.
struct ImagePair {
  int columns = 0;
  int rows = 0;
  UnsetVector<float> reference;
  UnsetVector<float> flow;
  UnsetVector<float> available;  ///< 1 where both are known, 0 elsewhere; empty: everywhere
  float contrast = 0.0f;         ///< largest minus smallest grey level of the two images
};

/// A displacement known at the nodes of a grid, at every pixel: cubic convolution (Keys, IEEE Trans. ASSP 29 (1981)
/// 1153) between the nodes, straight lines beyond the outermost, so that linear fields are reproduced everywhere.
class DensePredictor {
 public:
  /// @param nodes displacement [px] at grid.centre(i), all finite; grid.size() of them
  DensePredictor(InterrogationGrid const& grid, std::span<Vec2d const> nodes, int image_columns, int image_rows);

  Vec2d at(Vec2d position_px) const { return view().at(position_px); }
  /// Displacement at every pixel centre of an image row. @param u, v one value per column
  void row(int image_row, std::span<float> u, std::span<float> v) const;

  PredictorView view() const { return {grid_, ghosts_, columns_, rows_, nodes_.data()}; }

 private:
  InterrogationGrid grid_;
  int ghosts_;
  int columns_;  // with the ghost nodes
  int rows_;
  std::vector<Vec2d> nodes_;
  std::vector<int> column_first_;         // of the four nodes that count at a pixel column
  std::vector<float> column_weights_[4];  // of each of them, for every pixel column
};

/// One pixel of a deformed pair.
struct DeformedPixel {
  float reference;
  float flow;
  float available;
};

/// Whether (x, y) [px] is known: 1 inside an image where known(column, row) of the nearest pixel is, else 0.
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

/// Pixel (i, j) of reference(x - d/2) and flow(x + d/2).
/// @param u, v  the displacement d there [px]
/// @param known 1 where both original images are known at a pixel (column, row), 0 elsewhere
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

/// Deforms both images of a pair by half a displacement each, in opposite directions (Scarano, Meas. Sci. Technol. 13
/// (2002) R1; Wereley & Meinhart, Exp. Fluids 31 (2001) 258): a pattern that moved by exactly the predictor coincides
/// in the two deformed images, and what is left over is measured at mid-position, to second order in time.
class PairDeformer {
 public:
  /// @param degree of the B-spline, 3 or 5, or windowed_sinc. Pixels that are not finite count as unknown.
  PairDeformer(Image<double> const& reference, Image<double> const& flow, int degree);

  /// The pair: reference(x - d(x)/2) and flow(x + d(x)/2) with d the predictor [px].
  ImagePair deform(DensePredictor const& predictor) const;
  /// The same into a pair that may hold an earlier one: its memory is used again.
  void deform(DensePredictor const& predictor, ImagePair& pair) const;
  /// The pair as it was taken.
  ImagePair const& original() const { return original_; }

 private:
  int degree_;
  ImagePair original_;
  BsplineImage<float> reference_;
  BsplineImage<float> flow_;
};

/// The pair as it was taken.
ImagePair make_image_pair(Image<double> const& reference, Image<double> const& flow);

}  // namespace gladstone
