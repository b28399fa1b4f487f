#include "studies/report/simulated_twin.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "render/base/error.h"
#include "render/base/progress.h"
#include "render/base/units.h"
#include "render/files/output_file.h"
#include "studies/drawing/temporary_directory.h"
#include "studies/sweep/case_runner.h"
#include "studies/sweep/plan.h"

namespace gladstone::inline report {
namespace {

constexpr std::size_t twin_repeats = 2;
/// extrapolated nodes beyond the vectors, seen by light cones and dots at the edge of the view
constexpr int margin_nodes = 16;

/// Returns the value at a node; beyond the border, linear extrapolation of the last two nodes.
double continued(Image<double> const& image, int column, int row) {
  int const i = std::clamp(column, 0, image.columns() - 1), j = std::clamp(row, 0, image.rows() - 1);
  double value = image(i, j);
  if (column != i)
    value += (column < 0 ? image(0, j) - image(1, j) : image(i, j) - image(i - 1, j)) * std::abs(column - i);
  if (row != j) value += (row < 0 ? image(i, 0) - image(i, 1) : image(i, j) - image(i, j - 1)) * std::abs(row - j);
  return value;
}

/// Writes density plus `ambient` as a NRRD plane, y upwards, linearly extrapolated by `margin` nodes beyond its border.
/// @throws OutputError if the file cannot be written
void write_density_plane(std::string const& path, Image<double> const& density, int margin, double ambient) {
  int const columns = density.columns() + 2 * margin, rows = density.rows() + 2 * margin;
  std::string text = fmt::format(
      "NRRD0004\ntype: double\ndimension: 3\nsizes: {} {} 1\nencoding: raw\nendian: little\n\n", columns, rows);
  for (int row = rows - 1; row >= 0; --row) {  // y upwards
    for (int column = 0; column < columns; ++column) {
      double const value = ambient + continued(density, column - margin, row - margin);
      text.append(reinterpret_cast<char const*>(&value), sizeof value);
    }
  }
  OutputFile::write_text(path, text);
}

SetupNode field_of(std::string const& file, double spacing, Vec2d centre) {
  double const mm = unit::millimetre;
  auto const numbers = [](double a, double b, double c) {
    return setup_array({setup_number(a), setup_number(b), setup_number(c)});
  };
  SetupNode yes;
  yes.kind = SetupNode::Kind::boolean;
  yes.boolean = true;
  SetupNode field;
  field.members.push_back({"kind", setup_text("file")});
  field.members.push_back({"file", setup_text(file)});
  field.members.push_back({"quantity", setup_text("density")});
  field.members.push_back({"spacing_mm", numbers(spacing / mm, spacing / mm, spacing / mm)});
  field.members.push_back({"center_mm", numbers(centre.x / mm, centre.y / mm, 0)});
  field.members.push_back({"extrude", yes});
  return field;
}

StudyFile study_of(CaseSetup const& loaded, SetupNode field) {
  SetupDocument base = loaded.document.unread();
  CameraSetup const& camera = loaded.setup.camera;
  base.set({"camera", "pixels"}, setup_array({setup_integer(std::min(camera.columns, most_twin_px)),
                                              setup_integer(std::min(camera.rows, most_twin_px))}));
  base.set({"medium", "thickness_mm"}, setup_number(loaded.setup.medium.thickness / unit::millimetre));
  AxisPlan medium;
  medium.key = "medium.field";
  medium.path = {"medium", "field"};
  AxisValue& value = medium.list.emplace_back();
  value.parameter.label = "as measured";
  value.node = std::move(field);
  StudyFile study;
  study.path = study.base_path = "twin";
  study.base = std::make_shared<SetupDocument const>(std::move(base));
  study.axes.push_back(std::move(medium));
  study.repeats = twin_repeats;
  return study;
}

}  // namespace

SimulatedTwin simulate_twin(CaseSetup const& loaded, Image<double> const& density, double spacing, Vec2d centre,
                            Backend device) {
  SimulatedTwin twin;
  try {
    TemporaryDirectory const folder;
    std::string const file = folder.path() + "/density.nrrd";
    write_density_plane(file, density, margin_nodes, loaded.setup.medium.ambient_density);
    StudyPlan const plan = plan_study(study_of(loaded, field_of(file, spacing, centre)), device.name());
    CaseRunner runner(std::move(device), Sharing::over_repeats);
    std::vector<std::vector<Vec2d>> errors;
    Progress progress("simulating the twin", plan.size());
    for (std::size_t i = 0; i < plan.size(); ++i) {
      ManifestCase const one = plan[i];
      CaseResult const result = runner.run(one, "", [&](ObservedCase const& seen) {
        Comparison const& all = seen.comparison;
        std::vector<Vec2d>& error = errors.emplace_back(all.mask.size(), Vec2d{std::nan(""), std::nan("")});
        for (std::size_t k = 0; k < all.mask.size(); ++k) {
          if (all.mask[k]) error[k] = all.measured.displacement_px[k] - all.point.eq9_px[k];
        }
        if (i == 0) {
          twin.comparison = all;
          twin.columns = seen.prepared.scene.setup.camera.columns;
          twin.rows = seen.prepared.scene.setup.camera.rows;
        }
      });
      progress.advance();
      twin.seeds.push_back(one.seed);
      if (result.status == CaseStatus::ok) continue;
      twin.failed = result.error;
      return twin;
    }
    RepeatSplit const split = split_repeats(errors);
    twin.random_px = split.scatter_px;
    twin.systematic_px = split.systematic_px;
  } catch (SetupError const& error) {
    twin.failed = error.what();
  } catch (DataError const& error) {
    twin.failed = error.what();
  }
  return twin;
}

}  // namespace gladstone::inline report
