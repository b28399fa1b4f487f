#pragma once

#include <span>
#include <vector>

#include "analysis/bspline_image.h"
#include "analysis/interrogation_grid.h"
#include "render/base/image.h"
#include "render/base/vec.h"

namespace gladstone {

/// Two images as a correlation pass reads them, row by row, with their joint grey level removed.
struct ImagePair {
  int columns = 0;
  int rows = 0;
  std::vector<float> reference;
  std::vector<float> flow;
  std::vector<float> available;  ///< 1 where both are known, 0 elsewhere; empty: everywhere
  float contrast = 0.0f;         ///< largest minus smallest grey level of the two images
};

/// A displacement known at the nodes of a grid, at every pixel: cubic convolution (Keys, IEEE Trans. ASSP 29 (1981)
/// 1153) between the nodes, straight lines beyond the outermost, so that linear fields are reproduced everywhere.
class DensePredictor {
 public:
  /// @param nodes displacement [px] at grid.centre(i), all finite; grid.size() of them
  DensePredictor(InterrogationGrid const& grid, std::span<Vec2d const> nodes, int image_columns, int image_rows);

  Vec2d at(Vec2d position_px) const;
  /// Displacement at every pixel centre of an image row. @param u, v one value per column
  void row(int image_row, std::span<float> u, std::span<float> v) const;

 private:
  struct Taps {
    int first;
    double weight[4];
  };
  Taps taps(double position_px, int nodes) const;

  InterrogationGrid grid_;
  int ghosts_;
  int columns_;  // with the ghost nodes
  std::vector<Vec2d> nodes_;
  std::vector<Taps> column_taps_;
};

/// Deforms both images of a pair by half a displacement each, in opposite directions (Scarano, Meas. Sci. Technol. 13
/// (2002) R1; Wereley & Meinhart, Exp. Fluids 31 (2001) 258): a pattern that moved by exactly the predictor coincides
/// in the two deformed images, and what is left over is measured at mid-position, to second order in time.
class PairDeformer {
 public:
  /// @param degree of the B-spline, 3 or 5. Pixels that are not finite count as unknown.
  PairDeformer(Image<double> const& reference, Image<double> const& flow, int degree);

  /// The pair: reference(x - d(x)/2) and flow(x + d(x)/2) with d the predictor [px].
  ImagePair deform(DensePredictor const& predictor) const;

 private:
  int degree_;
  ImagePair original_;
  BsplineImage<float> reference_;
  BsplineImage<float> flow_;
};

/// The pair as it was taken.
ImagePair make_image_pair(Image<double> const& reference, Image<double> const& flow);

}  // namespace gladstone
