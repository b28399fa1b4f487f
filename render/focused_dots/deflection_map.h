#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "render/focused_dots/deflection_table.h"
#include "render/focused_dots/focused_dots.h"
#include "render/scene/renderer.h"

namespace gladstone::inline focused_dots {

/// Determines from the field and the view whether a deflection table can be built for a scene's dots. Returns `made` if
/// it can, else the reason why not.
TableState table_state(Scene const& scene);

/// Lattices of a scene's deflection table. Nodes are at multiples of a spacing that depends on field, view and light
/// cone only. The lattices cover the cones of FocusedDots::dots() and of the given sources, as far as they are within
/// the medium.
struct DeflectionTableLayout {
  /// Returns the default for the largest distance of an aim point from the pupil's centre that the table covers: a
  /// quarter of the stop's radius [m].
  static double default_aim_distance(ImagingGeometry const& imaging) { return 0.25 * imaging.entrance_pupil / 2; }

  DeflectionTable table;  ///< the table without values
  TableState state = TableState::no_sources;
  bool wanted() const { return state == TableState::made; }

  DeflectionTableLayout() = default;
  /// @param largest_aim_distance  largest distance of the centre of a dot's light cone from the pupil's centre [m]
  DeflectionTableLayout(FocusedDots const& dots, DotPattern const& sources, double largest_aim_distance);
  /// Returns true if the table of the other layout is identical to the last bit: the same nodes, ray geometry and
  /// medium (by its owner).
  bool same_table(DeflectionTableLayout const& other) const;

 private:
  std::vector<double> numbers_;  ///< all numbers, besides the medium, on which the table's values depend
  std::shared_ptr<void const> medium_;
};

/// Estimates the memory of the deflection table of a setup's dots before anything is built [bytes]; too large for a
/// field that ends within the view. Opens a file to read the size of its grid.
/// @throws DataError for a file that cannot be read
double table_bytes_needed(Setup const& setup);

/// Deflection table of a scene in host memory.
class DeflectionMap {
 public:
  /// Traces the table's rays on all CPU cores.
  /// @throws Interrupted
  DeflectionMap(FocusedDots const& dots, DeflectionTableLayout const& layout);
  DeflectionMap(DeflectionMap const&) = delete;  // the table points into values_
  DeflectionMap& operator=(DeflectionMap const&) = delete;

  /// The table; exists() is false if the layout has none.
  DeflectionTable const& table() const { return table_; }

 private:
  DeflectionTable table_;
  std::vector<std::byte> values_;
};

/// Cache of a renderer's last deflection table, for repeated renderings of one scene: its dots, and the truth at the
/// vectors of each correlation pass.
/// @tparam Map  DeflectionMap, or that of a device
template <class Map>
class DeflectionTableCache {
 public:
  /// Returns the table of a scene, which is valid until the next call.
  /// @param more  further arguments of Map's constructor
  template <class... More>
  DeflectionTable table(FocusedDots const& dots, DotPattern const& sources, double largest_aim_distance,
                        More const&... more) {
    DeflectionTableLayout layout(dots, sources, largest_aim_distance);
    state_ = layout.state;
    if (!layout.wanted()) return layout.table;
    if (!map_ || !layout.same_table(layout_)) {
      map_.reset();  // Free the old table before the new one is allocated.
      map_ = std::make_unique<Map>(dots, layout, more...);
      layout_ = std::move(layout);
    }
    return map_->table();
  }
  void forget() { map_.reset(); }
  /// Returns whether the last table requested was built, and the reason if not.
  TableState state() const { return state_; }

 private:
  TableState state_ = TableState::no_sources;
  DeflectionTableLayout layout_;
  std::unique_ptr<Map> map_;
};

}  // namespace gladstone::inline focused_dots
