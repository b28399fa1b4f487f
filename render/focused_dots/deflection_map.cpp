#include "render/focused_dots/deflection_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/parallel.h"
#include "render/focused_dots/dot_cone.h"
#include "render/focused_dots/one_lane.h"

namespace gladstone::inline focused_dots {
namespace {

constexpr double most_rays = 1e8;     // maximum number of rays of a table
constexpr double cheap_rays = 2.5e5;  // maximum number of rays of a table with doubled node density
constexpr double fine_rays = 2.5e7;   // maximum number of rays of a table with doubled node density if it is requested
constexpr double fewest_nodes = 12;   // minimum number of nodes along either axis of the view
// The table also contains slopes: derivatives of the deflection with respect to the pupil point. They are differences
// between rays to pupil points at this distance from the pupil's centre, in radii of the stop, which is about the mean
// distance of all points of the stop from its centre.
constexpr double slope_reach = 0.6;
constexpr double leaning = 2;  // largest distance from the pupil's centre, in radii of the stop, of the rays that are
                               // considered at the side faces of a field

/// Lane that traces four rays together.
struct FourAbreast : OneLane {
  static constexpr int abreast = 4;
  static Vec2d of_lane(int, Vec2d value) { return value; }
};

/// Node density of a deflection table.
struct NodeDensity {
  double spacing;  ///< node spacing of the lattice of rays to the pupil's centre [m]
  int coarseness;  ///< node spacing of the slopes' lattice, as a multiple of `spacing`

  /// Chooses the node density: one node per cell for a field on a grid, six per finest length (24 per wavelength) for a
  /// closed form, and half as many per axis for the slopes, which are corrections. If affordable or requested, twice as
  /// many nodes per axis, with slopes at each. A field that varies little over the view has at least `fewest_nodes`
  /// nodes along each axis.
  /// @param finest  finest length scale of the medium [m]
  /// @param extent  part of the mid-plane that the light cones of the view cross [m]
  static NodeDensity choose(double finest, bool grid, Vec2d extent, int fineness) {
    double const spacing = std::min(grid ? finest : finest / 6, std::min(extent.x, extent.y) / fewest_nodes);
    NodeDensity const fine{spacing / 2, 1}, usual{spacing, 2};
    return fine.rays(extent.x * extent.y) <= (fineness > 1 ? fine_rays : cheap_rays) ? fine : usual;
  }
  double nodes(double area) const { return area / (spacing * spacing); }
  double rays(double area) const { return nodes(area) * (1 + 4.0 / (coarseness * coarseness)); }
  double bytes(double area) const {
    return nodes(area) * 2 * (sizeof(Vec2d) + sizeof(TableSlopes) / static_cast<double>(coarseness * coarseness));
  }
};

/// Returns the largest distance on the mid-plane between the ray to the aim and the other rays of a dot's cone [m].
double cone_reach(double way, double half_size, double stop) {
  return (1 - way) * 1.5 * half_size + way * CorrectedCone::reach * stop;
}

/// Returns the extent of the mid-plane that the light cones of the whole view cross [m].
Vec2d crossed_extent(Setup const& setup, double way) {
  ImagingGeometry const imaging = setup.imaging();
  double const beyond = 2 * (cone_reach(way, setup.dot_diameter() / 2, imaging.entrance_pupil / 2) +
                             way * DeflectionTableLayout::default_aim_distance(imaging));
  Vec2d const extent = setup.target_extent();
  return {(1 - way) * extent.x + beyond, (1 - way) * extent.y + beyond};
}

/// Returns the distance from the target to the medium's mid-plane over the distance from the target to the lens [1].
/// @param bounds  bounds of the medium
double way_to(Bounds<double> const& bounds, Setup const& setup) {
  return (0.5 * (bounds.low.z + bounds.high.z) + setup.z_d) / setup.z_b();
}

NodeDensity choose_node_density(Scene const& scene, Vec2d extent, int fineness) {
  return NodeDensity::choose(scene.medium.finest, scene.medium.grid.nodes[0] > 1, extent, fineness);
}

Bounds<double> medium_bounds(Scene const& scene) {
  return std::visit([](auto const& medium) { return medium.bounds(); }, scene.medium.view);
}

/// Returns the lattice of all multiples of a spacing within a rectangle; it may have few nodes or none.
SquareLattice lattice_within(double spacing, Vec2d low, Vec2d high) {
  SquareLattice lattice;
  lattice.spacing = spacing;
  lattice.per_metre = 1 / spacing;
  auto const first = [&](double at) { return static_cast<int>(std::ceil(at * lattice.per_metre)); };
  lattice.first = {first(low.x), first(low.y)};
  lattice.columns = static_cast<int>(std::floor(high.x * lattice.per_metre)) - lattice.first.x + 1;
  lattice.rows = static_cast<int>(std::floor(high.y * lattice.per_metre)) - lattice.first.y + 1;
  return lattice;
}

}  // namespace

double table_bytes_needed(Setup const& setup) {
  FieldSetup const& field = setup.medium.field;
  if (field.kind == FieldKind::none || !reason_against_focused_dots(setup).empty()) return 0;
  Vec2d const crossed = crossed_extent(setup, (setup.z_d + field.center.z) / setup.z_b());
  double const area = crossed.x * crossed.y;
  int const most_fineness = setup.render.rays_per_dot ? 1 : 2;
  NodeDensity const density =
      NodeDensity::choose(finest_length(setup.medium), field.kind == FieldKind::file, crossed, most_fineness);
  return density.bytes(area) * std::min(1.0, most_rays / density.rays(area));
}

TableState table_state(Scene const& scene) {
  if (std::holds_alternative<NoMedium<double>>(scene.medium.view) || !(scene.medium.finest > 0)) {
    return TableState::no_medium;
  }
  double const way = way_to(medium_bounds(scene), scene.setup), stop = scene.imaging.entrance_pupil / 2;
  // A source's cone is integrated at a few points of the source and must not vary much between them.
  if ((1 - way) * scene.dots.half_size > 0.5 * std::max(scene.medium.finest, way * stop)) {
    return TableState::dots_too_wide;
  }
  Vec2d const extent = crossed_extent(scene.setup, way);
  // A finer table is built only if it has far fewer rays than the maximum, so that the fineness has no effect here.
  return choose_node_density(scene, extent, 1).rays(extent.x * extent.y) <= most_rays ? TableState::made
                                                                                      : TableState::field_too_fine;
}

DeflectionTableLayout::DeflectionTableLayout(FocusedDots const& dots, DotPattern const& sources,
                                             double largest_aim_distance) {
  Scene const& scene = dots.scene();
  state = table_state(scene);
  if (state == TableState::no_medium) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    table.low = table.high = {infinity, infinity};  // all rays miss the medium
    return;
  }
  if (sources.centre.empty()) state = TableState::no_sources;
  if (state != TableState::made) return;
  Bounds<double> const bounds = medium_bounds(scene);
  double const stop = scene.imaging.entrance_pupil / 2, way = way_to(bounds, scene.setup);
  FocusedSetupView const bench = dots.bench();
  table.mid_plane_fraction = way;
  table.pupil_step = slope_reach * stop;
  table.low = {bounds.low.x, bounds.low.y};
  table.high = {bounds.high.x, bounds.high.y};
  for (int face = 0; face < 2; ++face) {
    table.face_fractions[face] =
        ((face == 0 ? bounds.low.z : bounds.high.z) - bench.plane_z) / (bench.lens_z - bench.plane_z);
  }

  // Part of the mid-plane that the sources' cones cross, limited to where rays to the whole pupil cross the medium's
  // full depth.
  Vec2d low = sources.centre.front(), high = low;
  for (DotPattern const* const pattern : {&sources, &dots.dots()}) {
    for (Vec2d const c : pattern->centre) {
      low = {std::min(low.x, c.x), std::min(low.y, c.y)};
      high = {std::max(high.x, c.x), std::max(high.y, c.y)};
    }
  }
  NodeDensity const density = choose_node_density(scene, crossed_extent(scene.setup, way), dots.plan().fineness);
  double const spacing_of_slopes = density.coarseness * density.spacing;
  double const reach = cone_reach(way, std::max(sources.half_size, dots.dots().half_size), stop) +
                       way * largest_aim_distance + 3 * spacing_of_slopes;
  low = (1 - way) * low - Vec2d{reach, reach};
  high = (1 - way) * high + Vec2d{reach, reach};
  double const to_lens = (1 - way) * (bench.lens_z - bench.plane_z), half_depth = 0.5 * (bounds.high.z - bounds.low.z);
  // Rays through q meet the faces at distances of up to half_depth (|q| + leaning * stop) / to_lens from q.
  double const lean = half_depth / to_lens, aside = lean * leaning * stop;
  auto const inside = [&](double side) { return (side - aside) / (side > aside ? 1 + lean : 1 - lean); };
  low = {std::max(low.x, -inside(-bounds.low.x)), std::max(low.y, -inside(-bounds.low.y))};
  high = {std::min(high.x, inside(bounds.high.x)), std::min(high.y, inside(bounds.high.y))};
  table.straight = lattice_within(density.spacing, low, high);
  table.sloping = lattice_within(spacing_of_slopes, low, high);
  if (std::min(table.sloping.columns, table.sloping.rows) < 4) {
    state = TableState::field_too_small;
  } else if (!(density.rays((high.x - low.x) * (high.y - low.y)) <= most_rays)) {
    state = TableState::field_too_fine;
  }
  numbers_ = {bench.plane_z,
              bench.lens_z,
              bench.px_per_metre,
              bench.tracing.step,
              bench.tracing.ambient_refractivity,
              static_cast<double>(bench.tracing.integrator),
              static_cast<double>(bench.tracing.faces),
              way,
              table.pupil_step};
  for (SquareLattice const& lattice : {table.straight, table.sloping}) {
    numbers_.insert(numbers_.end(),
                    {static_cast<double>(lattice.first.x), static_cast<double>(lattice.first.y), lattice.spacing,
                     static_cast<double>(lattice.columns), static_cast<double>(lattice.rows)});
  }
  medium_ = scene.medium.owner;
}

bool DeflectionTableLayout::same_table(DeflectionTableLayout const& other) const {
  return wanted() && other.wanted() && medium_ && medium_ == other.medium_ && numbers_ == other.numbers_;
}

DeflectionMap::DeflectionMap(FocusedDots const& dots, DeflectionTableLayout const& layout) {
  constexpr std::size_t grain = 64;
  if (!layout.wanted()) return;
  FocusedSetupView const bench = dots.bench();
  values_.resize(layout.table.bytes());
  DeflectionTable::Values const values = layout.table.values_in(values_.data());
  std::visit(
      [&](auto const& medium) {
        parallel_chunks(static_cast<std::size_t>(layout.table.fours()), grain, [&](std::size_t begin, std::size_t end) {
          throw_if_interrupted();
          for (std::size_t four = begin; four < end; ++four) {
            trace_ray_group(FourAbreast{}, bench, medium, layout.table, values, static_cast<long long>(four));
          }
        });
      },
      dots.scene().medium.view);
  table_ = layout.table.with(values);
}

}  // namespace gladstone::inline focused_dots
