#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "render/focused_dots/deflection_table.h"
#include "render/focused_dots/focused_dots.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// Whether a scene's dots may have a deflection table, as far as its field and its view tell: made, or why not.
TableState table_state(Scene const& scene);

/// Where a scene's deflection table has its nodes: at multiples of a spacing that hangs on the field, the view and the
/// cone alone, as far as the cones of the scene's own dots and of the sources reach, but within the medium.
struct DeflectionPlan {
  /// Shifts that a table has room for unless told otherwise, in radii of the stop.
  static constexpr double usual_aim = 0.25;

  DeflectionTable table;  ///< without its values
  TableState state = TableState::no_sources;
  bool wanted() const { return state == TableState::made; }

  DeflectionPlan() = default;
  /// @param farthest_aim point of the pupil, from its middle, that a dot's cone may lie about [m]
  DeflectionPlan(FocusedDots const& dots, DotPattern const& sources, double farthest_aim);
  /// Whether the other plan's table is the same to the last bit: its nodes, its rays' way, and the medium, by its
  /// owner.
  bool same_table(DeflectionPlan const& other) const;

 private:
  std::vector<double> numbers_;  ///< all that the table's values depend on, beside the medium
  std::shared_ptr<void const> medium_;
};

/// Memory that the table of a setup's dots will take, before anything is built [bytes]: an estimate that a field which
/// ends within the view makes too large. Opens a file to see its grid. @throws DataError for one that cannot be read
double table_bytes_needed(Setup const& setup);

/// A scene's deflection table in the host's memory.
class DeflectionMap {
 public:
  /// Traces the table's rays on all cores. @throws Interrupted
  DeflectionMap(FocusedDots const& dots, DeflectionPlan const& plan);
  DeflectionMap(DeflectionMap const&) = delete;  // the table points into the values
  DeflectionMap& operator=(DeflectionMap const&) = delete;

  /// exists() only where it was wanted.
  DeflectionTable const& table() const { return table_; }

 private:
  DeflectionTable table_;
  std::vector<std::byte> values_;
};

/// A renderer's last table, for those who render one scene several times: its dots, and truth at vectors round by
/// round.
/// @tparam Map DeflectionMap, or a device's
template <class Map>
class LastDeflections {
 public:
  /// The table of a scene; valid until the next call. @param more what a Map takes beside dots and plan
  template <class... More>
  DeflectionTable table(FocusedDots const& dots, DotPattern const& sources, double farthest_aim, More const&... more) {
    DeflectionPlan plan(dots, sources, farthest_aim);
    state_ = plan.state;
    if (!plan.wanted()) return plan.table;
    if (!map_ || !plan.same_table(plan_)) {
      map_.reset();  // first gives its memory back
      map_ = std::make_unique<Map>(dots, plan, more...);
      plan_ = std::move(plan);
    }
    return map_->table();
  }
  void forget() { map_.reset(); }
  /// Of the last table that was asked for.
  TableState state() const { return state_; }

 private:
  TableState state_ = TableState::no_sources;
  DeflectionPlan plan_;
  std::unique_ptr<Map> map_;
};

}  // namespace gladstone
