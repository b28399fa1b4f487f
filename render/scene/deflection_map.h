#pragma once

#include <vector>

#include "render/scene/deflection_table.h"
#include "render/scene/scene.h"

namespace gladstone {

/// Where a scene's deflection table has its nodes. None where rays are not traced through a medium and a focused lens
/// with a stop, where the field is too fine for the number of sources to pay for a table, or where somebody wants
/// random rays as they are.
struct DeflectionPlan {
  DeflectionTable table;  ///< without its values
  bool wanted = false;

  DeflectionPlan(Scene const& scene, DotPattern const& sources);
};

/// The scene as rays of the table see it: without a stop.
SceneView<double> open_view(Scene const& scene);

/// A scene's deflection table in the host's memory.
class DeflectionMap {
 public:
  /// Traces the table's rays on all cores. @throws Interrupted
  DeflectionMap(Scene const& scene, DotPattern const& sources);
  DeflectionMap(DeflectionMap const&) = delete;  // the table points into the arrays
  DeflectionMap& operator=(DeflectionMap const&) = delete;

  /// exists() only where it was wanted.
  DeflectionTable const& table() const { return table_; }

 private:
  DeflectionTable table_;
  std::vector<Vec2d> displacements_, bends_;
  std::vector<KeptSlopes> displacement_slopes_, bend_slopes_;
};

}  // namespace gladstone
