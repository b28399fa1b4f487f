#include "render/light/velocity_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/units.h"
#include "render/files/fields/field_axes.h"
#include "render/files/fields/spline_prefilter.h"
#include "render/light/existing_file.h"
#include "render/light/flow.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline light {
namespace {

constexpr int components = 3;

/// Layout of the padded coefficients of a grid. Every axis has one ghost layer before the first node and one (open
/// axis) or two (periodic axis) after the last; a single plane has no ghost layers in z.
struct Padded {
  explicit Padded(RegularGrid const& grid) : nodes(grid.nodes), periodic(grid.periodic) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bool const flat = axis == 2 && nodes[2] == 1;
      before[axis] = flat ? 0 : 1;
      count[axis] = flat ? 1 : nodes[axis] + (periodic[axis] ? 3 : 2);
    }
    stride = {components, components * count[0], components * static_cast<std::ptrdiff_t>(count[0]) * count[1]};
  }
  std::size_t size() const { return static_cast<std::size_t>(stride[2]) * static_cast<std::size_t>(count[2]); }
  /// Returns the index of the first component at a node or ghost node.
  std::size_t at(int i, int j, int k) const {
    return static_cast<std::size_t>((i + before[0]) * stride[0] + (j + before[1]) * stride[1] +
                                    (k + before[2]) * stride[2]);
  }

  std::array<int, 3> nodes, count{}, before{};
  std::array<bool, 3> periodic;
  std::array<std::ptrdiff_t, 3> stride{};
};

/// Converts all lines along an axis to B-spline coefficients and fills its ghost layers. Ghost layers of previously
/// filtered axes are filtered like nodes.
void filter_axis(Padded const& grid, std::size_t axis, std::vector<float>& values) {
  std::size_t const a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;  // axes perpendicular to the lines
  auto const lines_on = [&](std::size_t other) { return other < axis ? grid.count[other] : grid.nodes[other]; };
  auto const first_on = [&](std::size_t other) { return other < axis ? -grid.before[other] : 0; };
  auto const n = static_cast<std::size_t>(grid.nodes[axis]);
  parallel_for(static_cast<std::size_t>(lines_on(a)) * static_cast<std::size_t>(lines_on(b)), [&](std::size_t line) {
    std::array<int, 3> at{};
    at[a] = first_on(a) + static_cast<int>(line % static_cast<std::size_t>(lines_on(a)));
    at[b] = first_on(b) + static_cast<int>(line / static_cast<std::size_t>(lines_on(a)));
    std::vector<double> c(n + 2), scratch(n);
    for (int component = 0; component < components; ++component) {
      float* const base = values.data() + grid.at(at[0], at[1], at[2]) + component;
      std::ptrdiff_t const step = grid.stride[axis];
      for (std::size_t i = 0; i < n; ++i) c[i + 1] = static_cast<double>(base[static_cast<std::ptrdiff_t>(i) * step]);
      if (grid.periodic[axis]) {
        prefilter_periodic(std::span(c).subspan(1, n));
      } else {
        prefilter_open(c, scratch);
      }
      auto const put = [&](std::ptrdiff_t i, std::size_t from) { base[i * step] = static_cast<float>(c[from]); };
      auto const last = static_cast<std::ptrdiff_t>(n);
      for (std::ptrdiff_t i = 0; i < last; ++i) put(i, static_cast<std::size_t>(i) + 1);
      put(-1, grid.periodic[axis] ? n : 0);
      put(last, grid.periodic[axis] ? 1 : n + 1);
      if (grid.periodic[axis]) put(last + 1, n > 1 ? 2 : 1);
    }
  });
}

}  // namespace

FileFlow FileFlow::read(SetupTable& table, FlowSetup& setup) {
  double const mm = unit::millimetre;
  VelocityFile file;
  file.file = existing_file(table);
  file.where = table.where("file");
  file.dataset = table.text("dataset", "");
  file.axes = table.text("axes", "");
  if (!file.axes.empty() && !is_axis_order(file.axes)) {
    table.problem("axes",
                  "is not an order of axes; list the axes of the file, slowest first: \"zyx\", or \"yx\" for a plane");
  }
  if (table.has("scale")) file.scale = table.number("scale", 1.0, {-1e12, 1e12});
  if (table.has("spacing_mm")) file.spacing = table.quantities("spacing_mm", {mm, mm, mm}, mm, Range::positive(1e9));
  file.center = table.quantities("center_mm", file.center, mm, {-1e9, 1e9});
  file.extrude = table.boolean("extrude", false);
  auto const periodic = table.booleans("periodic", {false, false, false}, 3);
  for (std::size_t axis = 0; axis < 3 && periodic.size() == 3; ++axis) file.periodic[axis] = periodic[axis];
  setup.file = file;
  return {};
}

RegularGrid velocity_grid(VelocityFile const& setup) {
  auto const source = open_field(setup.file, setup.dataset, components, setup.axes);
  RegularGrid grid = source->grid();
  auto const refuse = [&](std::string const& why) {
    throw DataError(ErrorCode::wrong_shape, setup.file, source->name() + ' ' + why);
  };
  if (setup.extrude && grid.nodes[2] != 1) {
    refuse(fmt::format("has {} planes along z (extrude = true needs a single plane); set flow.extrude = false",
                       grid.nodes[2]));
  }
  if (!setup.extrude && grid.nodes[2] < 2) {
    refuse("is a single plane (a volume needs at least two); set flow.extrude = true to extend it along Z");
  }
  if (grid.nodes[0] < 2 || grid.nodes[1] < 2) {
    refuse(fmt::format("has {} x {} nodes (at least 2 x 2 are needed)", grid.nodes[0], grid.nodes[1]));
  }
  std::string const undefined = source->units().undefined();
  if (!setup.spacing && !undefined.empty())
    throw DataError(ErrorCode::undetermined, setup.file, undefined + "; give flow.spacing_mm");
  grid.spacing = setup.spacing ? *setup.spacing : grid.spacing * source->units().metres();
  grid.periodic = setup.periodic;
  if (setup.extrude) grid.periodic[2] = false;
  for (int axis = 0; axis < 3; ++axis) {
    double const span = grid.spacing[axis] * (grid.nodes[static_cast<std::size_t>(axis)] - 1);
    grid.origin[axis] = setup.center[axis] - span / 2;
  }
  return grid;
}

double velocity_bytes(VelocityFile const& setup) {
  return static_cast<double>(Padded(velocity_grid(setup)).size()) * sizeof(float);
}

LoadedVelocity load_velocity(VelocityFile const& setup) {
  RegularGrid const grid = velocity_grid(setup);
  auto const source = open_field(setup.file, setup.dataset, components, setup.axes);
  ValueFactor const unit =
      setup.scale ? ValueFactor{*setup.scale, ""} : source->units().value_factor(dimension_of_velocity);
  Padded const padded(grid);
  require_memory(setup.file, source->name(), static_cast<double>(padded.size()) * sizeof(float));
  std::vector<float> values(padded.size());
  std::vector<double> plane(static_cast<std::size_t>(components) * static_cast<std::size_t>(grid.nodes[0]) *
                            static_cast<std::size_t>(grid.nodes[1]));
  std::size_t const row = static_cast<std::size_t>(components) * static_cast<std::size_t>(grid.nodes[0]);
  for (int k = 0; k < grid.nodes[2]; ++k) {
    source->read_planes(k, 1, plane);
    for (int j = 0; j < grid.nodes[1]; ++j) {
      double const* const from = plane.data() + row * static_cast<std::size_t>(j);
      std::transform(from, from + row, values.begin() + static_cast<std::ptrdiff_t>(padded.at(0, j, k)),
                     [&unit](double value) { return static_cast<float>(unit.factor * value); });
    }
  }
  for (std::size_t axis = 0; axis < (grid.nodes[2] > 1 ? 3u : 2u); ++axis) filter_axis(padded, axis, values);
  LoadedVelocity loaded;
  loaded.coefficients = std::make_shared<std::vector<float> const>(std::move(values));
  loaded.flow.coefficients = loaded.coefficients->data();
  loaded.flow.row = padded.stride[1];
  loaded.flow.plane = padded.stride[2];
  loaded.flow.nodes = grid.nodes;
  loaded.flow.periodic = grid.periodic;
  loaded.flow.origin = grid.origin;
  loaded.flow.inverse_spacing = {1 / grid.spacing.x, 1 / grid.spacing.y, 1 / grid.spacing.z};
  std::string const assumed = setup.spacing ? "" : source->units().assumed();
  if (!assumed.empty()) {
    double const mm = unit::millimetre;
    loaded.warnings.push_back(
        {WarningCode::assumed, "flow.file",
         fmt::format("of {} in {} {} (the field is {:.4g} x {:.4g} mm wide); if that is wrong, give flow.spacing_mm",
                     source->name(), setup.file, assumed, grid.spacing.x * (grid.nodes[0] - 1) / mm,
                     grid.spacing.y * (grid.nodes[1] - 1) / mm)});
  }
  Warnings notes = source->notes();
  if (!unit.warning.empty())
    notes.push_back({WarningCode::assumed, "", unit.warning + "; if that is wrong, give flow.scale"});
  for (Warning const& note : notes)
    loaded.warnings.push_back({note.code, "flow.file", setup.file + ": " + to_string(note)});
  return loaded;
}

}  // namespace gladstone::inline light
