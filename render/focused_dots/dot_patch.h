#pragma once

#include <vector>

#include "render/focused_dots/moment_images.h"
#include "render/scene/light_patch.h"

namespace gladstone {

/// A patch that takes light by the moments of its displacements, too.
class DotPatch : public LightPatch {
 public:
  /// @param images of the squares of displacement that it is to hold, or none
  DotPatch(SpotView const& spot, MomentImages const& images);

  using LightPatch::deposit;
  /// A Gaussian spot along one axis: its shares of the pixels from `first` on, and their derivatives by its place.
  struct Series {
    int first = 0;               ///< pixel [px]
    std::vector<double> shares;  ///< [order + 1][width] of taylor_shares()
  };
  /// Series of a spot at p [px]. @return false beyond any image
  bool make_series(double p, Series& series) const;
  /// Adds Gaussian spots whose displacements from where the series stand have these moments.
  void deposit(Series const& column, Series const& row, double weight, DisplacementMoments const& moments,
               LightImage* image, double light_per_weight);
  /// Adds the light of one of the sensor's squares of displacement.
  void deposit(Vec2<int> square, double weight, MomentField const& field, LightImage* image, double light_per_weight);

 private:
  MomentImages images_;
  std::vector<double> of_square_;  ///< light of a square of displacement
};

}  // namespace gladstone
