#include "studies/compare/tomography_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/files/output_file.h"
#include "render/medium/field_volume.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/case.h"
#include "studies/compare/tomography.h"
#include "studies/compare/tomography_file.h"

namespace gladstone::inline compare {
namespace {

namespace fs = std::filesystem;

/// Returns the cubic grid about the origin that contains the field at all angles about Y.
RegularGrid enclose_field(MediumSetup const& setup, BuiltMedium const& medium) {
  Bounds<double> const box = std::visit([](auto const& view) { return view.bounds(); }, medium.view);
  bool const is_file = setup.field.kind == FieldKind::file;
  double const depth = setup.thickness;
  Vec3d half{};
  for (int axis = 0; axis < 3; ++axis) {
    // Closed forms are endless in X and Y: use their depth, which contains a plume or a blob to 7 radii
    half[axis] = is_file ? std::max(std::abs(box.low[axis]), std::abs(box.high[axis])) : 0.5 * depth;
    if (!std::isfinite(half[axis]) || half[axis] > 1e3)
      throw SetupError(
          {SetupProblem{"medium.field", "has no finite extent (periodic); give a field of finite extent"}});
  }
  double const radius = is_file ? std::hypot(half.x, half.z) : half.x;
  constexpr double margin = 1.25;  // ambient across the view, so that side faces do not cut the light cones
  Vec3d const reach{margin * radius, margin * half.y, radius};
  double const spacing =
      is_file ? std::min({medium.grid.spacing.x, medium.grid.spacing.y, medium.grid.spacing.z}) : depth / 64.0;
  RegularGrid grid;
  grid.spacing = {spacing, spacing, spacing};
  for (int axis = 0; axis < 3; ++axis) {
    int const nodes = static_cast<int>(std::ceil(2.0 * reach[axis] / spacing - 1e-6)) + 1;
    grid.nodes[static_cast<std::size_t>(axis)] = nodes;
    grid.origin[axis] = -0.5 * (nodes - 1) * spacing;
  }
  return grid;
}

/// Evaluates the field, turned about Y, at the nodes of a grid.
std::vector<double> turn_field(MediumSetup const& setup, BuiltMedium const& medium, double angle,
                               RegularGrid const& grid) {
  std::vector<double> density(grid.size(), setup.ambient_density);
  Pose<double> const volume = turned_volume(angle);
  auto const row = static_cast<std::size_t>(grid.nodes[0]), plane = row * static_cast<std::size_t>(grid.nodes[1]);
  std::visit(
      [&](auto const& view) {
        Bounds<double> const box = view.bounds();
        double const slack = 1e-6 * grid.spacing.x;  // tolerance for positions on a face, which are rounded
        parallel_for(static_cast<std::size_t>(grid.nodes[2]), [&](std::size_t k) {
          for (std::size_t n = 0; n < plane; ++n) {
            std::size_t const column = n % row, line = n / row;
            Vec3d const at = grid.origin + Vec3d{static_cast<double>(column) * grid.spacing.x,
                                                 static_cast<double>(line) * grid.spacing.y,
                                                 static_cast<double>(k) * grid.spacing.z};
            Vec3d p = volume.point_to_local(at);
            bool inside = true;
            for (int axis = 0; axis < 3; ++axis) {
              inside = inside && p[axis] >= box.low[axis] - slack && p[axis] <= box.high[axis] + slack;
              p[axis] = std::clamp(p[axis], box.low[axis], box.high[axis]);
            }
            if (inside) density[k * plane + n] = view.sample(p).refractivity / setup.gladstone_dale;
          }
        });
      },
      medium.view);
  return density;
}

}  // namespace

std::vector<std::string> write_tomography_setups(TomographyPlan const& plan, std::string const& folder) {
  SetupDocument const document = read_setup_document(plan.setup);
  CaseSetup const loaded = load_case_setup(document.copy());
  MediumSetup const& medium = loaded.setup.medium;
  if (medium.field.kind == FieldKind::none || medium.field.extrude)
    throw SetupError(
        {SetupProblem{"medium.field", "is not a volume; tomography needs a field with all three dimensions"}});
  BuiltMedium const built = build_checked_medium(medium);
  RegularGrid const grid = enclose_field(medium, built);
  require_memory(plan.setup, fmt::format("a field of {} x {} x {} nodes", grid.nodes[0], grid.nodes[1], grid.nodes[2]),
                 sizeof(double) * static_cast<double>(grid.size()));
  std::vector<std::string> setups;
  Progress progress("turning the field", static_cast<std::size_t>(plan.views));
  for (int i = 0; i < plan.views; ++i) {
    std::string const base = (fs::absolute(folder) / fmt::format("view_{:02}", i)).string();
    double const angle = plan.arc * i / plan.views;
    write_density_volume(base + ".h5", grid, turn_field(medium, built, angle, grid), loaded.document.resolved());
    std::string const field =
        fmt::format("medium.field={{ kind = \"file\", file = \"{}\", dataset = \"density_kg_m3\" }}", base + ".h5");
    SetupDocument turned = document.copy();
    turned.override_key(field);
    turned.override_key("medium.thickness_mm=\"auto\"");
    CaseSetup const view = load_case_setup(std::move(turned));
    OutputFile::write_text(base + ".toml", view.document.resolved());
    setups.push_back(base + ".toml");
    progress.advance();
  }
  return setups;
}

}  // namespace gladstone::inline compare
