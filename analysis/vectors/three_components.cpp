#include "analysis/vectors/three_components.h"

#include <fmt/format.h>

#include <cstdlib>

#include "render/base/error.h"

namespace gladstone::inline vectors {
namespace {

constexpr char const* stereo_filetype = "gladstone stereo";

/// Reads datasets of a file and checks their sizes.
class NodeReader {
 public:
  explicit NodeReader(std::string const& path) : path_(path), file_(path) {
    if (file_.attribute("filetype") != stereo_filetype)
      throw DataError(ErrorCode::wrong_format, path,
                      "contains no displacements with three components; give a file that gladstone stereo has written");
  }

  std::vector<double> read(std::string const& dataset, std::size_t count) const {
    if (!file_.has(dataset))
      throw DataError(ErrorCode::missing_content, path_,
                      fmt::format("has no dataset {}; run gladstone stereo again", dataset));
    std::vector<double> values = file_.read(dataset);
    if (values.size() != count && count > 0)
      throw DataError(ErrorCode::wrong_shape, path_,
                      fmt::format("{}: {} values where the grid requires {}", dataset, values.size(), count));
    return values;
  }
  std::vector<double> read_axis(std::string const& dataset) const { return read(dataset, 0); }
  std::vector<Vec3d> read_vectors(std::string const& dataset, std::size_t nodes) const {
    std::vector<double> const values = read(dataset, 3 * nodes);
    std::vector<Vec3d> vectors;
    for (std::size_t i = 0; i < nodes; ++i) vectors.push_back({values[3 * i], values[3 * i + 1], values[3 * i + 2]});
    return vectors;
  }
  double number(std::string const& attribute) const { return std::strtod(file_.attribute(attribute).c_str(), nullptr); }

 private:
  std::string path_;
  Hdf5Reader file_;
};

}  // namespace

bool is_three_component_file(std::string const& path) {
  return has_hdf5_ending(path) && Hdf5Reader(path).attribute("filetype") == stereo_filetype;
}

ThreeComponentField read_three_components(std::string const& path) {
  NodeReader const file(path);
  ThreeComponentField field;
  field.x_mm = file.read_axis("/x_mm");
  field.y_mm = file.read_axis("/y_mm");
  std::size_t const nodes = field.x_mm.size() * field.y_mm.size();
  if (nodes == 0) throw DataError(ErrorCode::missing_content, path, "contains no nodes");
  field.displacement_mm = file.read_vectors("/displacement_mm", nodes);
  field.sigma_mm = file.read_vectors("/sigma_mm", nodes);
  field.residual_px = file.read("/residual_px", nodes);
  field.residual_ratio = file.read("/residual_ratio", nodes);
  for (double const code : file.read("/status", nodes))
    field.status.push_back(code == 0.0 ? VectorStatus::valid : VectorStatus::invalid);
  double const z = file.number("sheet_z_mm"), by_x = file.number("sheet_slope_x"), by_y = file.number("sheet_slope_y");
  for (double const y : field.y_mm)
    for (double const x : field.x_mm) field.z_mm.push_back(z + by_x * x + by_y * y);
  return field;
}

}  // namespace gladstone::inline vectors
