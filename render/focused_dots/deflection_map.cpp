#include "render/focused_dots/deflection_map.h"

#include <algorithm>
#include <cmath>

#include "render/base/interrupt.h"
#include "render/base/parallel.h"

namespace gladstone {
namespace {

constexpr double rays_a_source = 1024;  // of the table: more are not paid for by the rays that they save
constexpr double cheap_rays_a_source = 32;
constexpr double most_rays = 1e8;
constexpr double fewest_nodes = 12;  // along either axis
constexpr double slope_reach = 0.6;  // of the stop's radius: where the pupil's points are on average

/// A lattice from low to high. @pre three spacings or more in both directions
void place(SquareLattice& lattice, double spacing, Vec2d low, Vec2d high) {
  double const width = high.x - low.x, height = high.y - low.y;
  lattice.spacing = spacing;
  lattice.per_metre = 1 / lattice.spacing;
  lattice.columns = static_cast<int>(std::ceil(width / lattice.spacing)) + 1;
  lattice.rows = static_cast<int>(std::ceil(height / lattice.spacing)) + 1;
  // the last node may lie beyond: as far before the first
  lattice.first = {low.x - 0.5 * ((lattice.columns - 1) * lattice.spacing - width),
                   low.y - 0.5 * ((lattice.rows - 1) * lattice.spacing - height)};
}

/// How densely a table's nodes lie.
struct NodeDensity {
  double spacing;     ///< of the straight lattice [m]
  double coarseness;  ///< the slopes' spacing over that

  /// A grid's table has a node a cell, a wave twenty-four a wavelength; its slopes, which are corrections, half as
  /// many; twice as many of both, and as many slopes, where there are sources enough. A field that is smooth over all
  /// of the view has no fewer nodes than polynomials need.
  /// @param finest of the medium @param extent of the mid-plane that cones cross [m]
  static NodeDensity choose(double finest, bool grid, Vec2d extent, double sources) {
    double const area = extent.x * extent.y;
    double const spacing = std::min(grid ? finest : finest / 6, std::min(extent.x, extent.y) / fewest_nodes);
    NodeDensity const fine{spacing / 2, 1}, usual{spacing, 2};
    return fine.rays(area) <= cheap_rays_a_source * sources ? fine : usual;
  }
  double nodes(double area) const { return area / (spacing * spacing); }
  double rays(double area) const { return nodes(area) * (1 + 4 / (coarseness * coarseness)); }
  double bytes(double area) const {
    return nodes(area) * 2 * (sizeof(Vec2d) + sizeof(KeptSlopes) / (coarseness * coarseness));
  }
};

/// Rays that a table for so many sources may have.
double allowed_rays(double sources) { return std::min(rays_a_source * sources, most_rays); }

/// How far from the cone of a source's middle its rays cross the mid-plane [m].
double cone_reach(double way, double half_size, double pupil) {
  return (1 - way) * 1.5 * half_size + way * pupil + 1e-9;
}

}  // namespace

double table_bytes_needed(Setup const& setup) {
  FieldSetup const& field = setup.medium.field;
  if (field.kind == FieldKind::none || !std::isfinite(setup.lens.f_number) ||
      setup.render.sampling != PupilSampling::sobol) {
    return 0;
  }
  double const way = (setup.z_d + field.center.z) / setup.z_b();
  double const pupil = setup.imaging().entrance_pupil / 2 * std::sqrt(1 + Scene::stop_edge(1) / 2);
  double const beyond = 2 * cone_reach(way, setup.dot_diameter() / 2, pupil);
  Vec2d const extent = setup.target_extent();
  Vec2d const crossed{(1 - way) * extent.x + beyond, (1 - way) * extent.y + beyond};
  double const area = crossed.x * crossed.y;
  double const sources = setup.target.kind == TargetKind::dots ? setup.dot_count() : most_rays;
  NodeDensity const density =
      NodeDensity::choose(finest_length(setup.medium), field.kind == FieldKind::file, crossed, sources);
  return density.bytes(area) * std::min(1.0, allowed_rays(sources) / density.rays(area));
}

DeflectionPlan::DeflectionPlan(FocusedDots const& dots, DotPattern const& sources) {
  Scene const& scene = dots.scene();
  Setup const& setup = scene.setup;
  state = std::holds_alternative<NoMedium<double>>(scene.medium.view) || !(scene.medium.finest > 0)
              ? TableState::no_medium
          : scene.chief_rays_only()                       ? TableState::chief_rays
          : setup.render.sampling != PupilSampling::sobol ? TableState::random_rays
          : sources.centre.empty()                        ? TableState::no_sources
                                                          : TableState::made;
  if (state != TableState::made) return;
  SceneView<double> const view = dots.view(sources);
  Bounds<double> const box = std::visit([](auto const& medium) { return medium.bounds(); }, scene.medium.view);
  double const depth = view.bundle.lens_z - view.sources.plane_z;
  double const middle_z = 0.5 * (box.low.z + box.high.z);
  double const way = (middle_z - view.sources.plane_z) / depth;

  // what the sources' cones cover of the mid-plane, as far as rays to all of the pupil cross the medium's whole depth
  Vec2d low = sources.centre.front(), high = low;
  for (DotPattern const* const pattern : {&sources, &scene.dots}) {
    for (Vec2d const c : pattern->centre) {
      low = {std::min(low.x, c.x), std::min(low.y, c.y)};
      high = {std::max(high.x, c.x), std::max(high.y, c.y)};
    }
  }
  double const half_size = std::max(sources.half_size, scene.dots.half_size), pupil = scene.pupil_radius(1);
  double const reach = cone_reach(way, half_size, pupil);
  low = (1 - way) * low - Vec2d{reach, reach};
  high = (1 - way) * high + Vec2d{reach, reach};
  double const to_lens = view.bundle.lens_z - middle_z;
  auto const lean = [&](double q) { return 0.5 * (box.high.z - box.low.z) * (std::abs(q) + pupil) / to_lens; };
  auto const area = [&] { return (high.x - low.x) * (high.y - low.y); };
  auto const count = static_cast<double>(std::max(sources.centre.size(), scene.dots.centre.size()));
  NodeDensity const density =
      NodeDensity::choose(scene.medium.finest, scene.medium.grid.nodes[0] > 1, high - low, count);
  double const spacing_of_slopes = density.coarseness * density.spacing, edge = 0.5 * spacing_of_slopes;
  low = {std::max(low.x, box.low.x + lean(low.x) + edge), std::max(low.y, box.low.y + lean(low.y) + edge)};
  high = {std::min(high.x, box.high.x - lean(high.x) - edge), std::min(high.y, box.high.y - lean(high.y) - edge)};
  double const least = 3 * spacing_of_slopes;
  if (!(high.x - low.x >= least && high.y - low.y >= least)) {
    state = TableState::field_too_small;
  } else if (!(density.rays(area()) <= allowed_rays(count))) {
    state = TableState::field_too_fine;
  }
  // a source's cone is integrated from a few places of it: it must not change much between them
  double const stop = scene.imaging.entrance_pupil / 2;
  if ((1 - way) * half_size > 0.5 * std::max(scene.medium.finest, way * stop)) state = TableState::dots_too_wide;
  if (state != TableState::made) return;
  table.way = way;
  table.pupil_step = slope_reach * stop;
  place(table.straight, density.spacing, low, high);
  place(table.sloping, spacing_of_slopes, low, high);
  // out of focus a dot's cone has its rule, for theory, but no table
  if (!(std::abs(setup.focus_distance() - setup.z_b()) <= 1e-12 * setup.z_b())) state = TableState::out_of_focus;

  SceneView<double> const open = dots.open_view();
  numbers_ = {open.sources.plane_z,
              open.bundle.lens_z,
              setup.lens.focal_length,
              open.sensor.z,
              open.sensor.pitch,
              static_cast<double>(open.sensor.columns),
              static_cast<double>(open.sensor.rows),
              open.tracing.step,
              open.tracing.ambient_refractivity,
              static_cast<double>(open.tracing.integrator),
              static_cast<double>(open.tracing.faces),
              way,
              table.pupil_step};
  for (SquareLattice const& lattice : {table.straight, table.sloping}) {
    numbers_.insert(numbers_.end(), {lattice.first.x, lattice.first.y, lattice.spacing,
                                     static_cast<double>(lattice.columns), static_cast<double>(lattice.rows)});
  }
  medium_ = scene.medium.owner;
}

bool DeflectionPlan::same_table(DeflectionPlan const& other) const {
  return wanted() && other.wanted() && medium_ && medium_ == other.medium_ && numbers_ == other.numbers_;
}

DeflectionMap::DeflectionMap(FocusedDots const& dots, DeflectionPlan const& plan) {
  if (!plan.wanted()) return;
  SceneView<double> const open = dots.open_view();
  table_ = plan.table;
  auto const for_each_node = [](SquareLattice const& lattice, auto const& visit) {
    parallel_for(static_cast<std::size_t>(lattice.rows), [&](std::size_t row) {
      std::size_t at = row * static_cast<std::size_t>(lattice.columns);
      for (int column = 0; column < lattice.columns; ++column) {
        throw_if_interrupted();
        visit(lattice.node(column, static_cast<int>(row)), at++);
      }
    });
  };
  auto const nodes = static_cast<std::size_t>(table_.straight.size());
  auto const slopes = static_cast<std::size_t>(table_.sloping.size());
  displacements_.resize(nodes);
  bends_.resize(nodes);
  displacement_slopes_.resize(slopes);
  bend_slopes_.resize(slopes);
  std::visit(
      [&](auto const& medium) {
        for_each_node(table_.straight, [&](Vec2d q, std::size_t at) {
          Deflection const node = deflect(open, medium, plan.table.way, q, {});
          displacements_[at] = KeptVector::of(node.displacement);
          bends_[at] = KeptVector::of(node.bend);
        });
        for_each_node(table_.sloping, [&](Vec2d q, std::size_t at) {
          Deflection sides[4];
          for (int side = 0; side < 4; ++side) {
            sides[side] = deflect(open, medium, plan.table.way, q, slope_pupil(plan.table, side));
          }
          DeflectionSlopes const node = slopes_of(plan.table, sides);
          displacement_slopes_[at] = node.displacement;
          bend_slopes_[at] = node.bend;
        });
      },
      dots.scene().medium.view);
  table_.displacements = displacements_.data();
  table_.bends = bends_.data();
  table_.displacement_slopes = displacement_slopes_.data();
  table_.bend_slopes = bend_slopes_.data();
}

}  // namespace gladstone
