#pragma once

#include <optional>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "render/base/vec.h"

namespace gladstone::inline stereo {

/// Returns true if the vectors lie on a complete grid of at least 2 x 2 nodes with equal distances along each axis, in
/// rows from the smallest y.
bool is_regular_grid(DisplacementField const& field);

/// Vectors on a regular grid, interpolated between its nodes: cubic convolution (Keys, IEEE Trans. ASSP 29 (1981)
/// 1153), or bilinear where one of the 4 x 4 neighbours is missing.
class InterpolatedField {
 public:
  /// @param field  vectors on a regular grid (is_regular_grid()); must outlive this object
  /// @param window_px  size of the interrogation windows, by which the errors of neighbouring vectors are correlated:
  /// (1 - |dx| / window) (1 - |dy| / window) at a distance (dx, dy); 0: independent errors
  InterpolatedField(DisplacementField const& field, double window_px);

  struct Vector {
    Vec2d displacement_px;
    Vec2d sigma_px;  ///< standard uncertainty [px]; NaN: one of the interpolated vectors has no uncertainty
  };
  /// @return vector interpolated at a position; nullopt outside the grid and next to missing vectors
  std::optional<Vector> vector(Vec2d position_px) const;
  std::optional<Vec2d> displacement(Vec2d position_px) const;

  Vec2d spacing_px() const { return spacing_; }

 private:
  /// Node with its weight in the interpolation.
  struct Node {
    std::size_t index;
    int column, row;
    double weight;
  };
  std::vector<Node> nodes_around(Vec2d position_px) const;

  DisplacementField const* field_;
  Vec2d first_, spacing_;
  double window_px_;
};

}  // namespace gladstone::inline stereo
