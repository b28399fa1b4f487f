#include <array>
#include <span>

#include "analysis/vectors/vector_writers/vector_columns.h"
#include "analysis/vectors/vector_writers/vector_writers.h"
#include "render/base/version.h"

namespace gladstone::inline vectors {
namespace {

constexpr std::array netcdf_variables{
    NetcdfVariable{"u", "u_px", "pix", "displacement to the right", "u_velocity"},
    NetcdfVariable{"v", "v_px", "pix", "displacement downwards", "v_velocity"},
    NetcdfVariable{"sigma_u", "sigma_u_px", "pix", "standard uncertainty of u", ""},
    NetcdfVariable{"sigma_v", "sigma_v_px", "pix", "standard uncertainty of v", ""},
    NetcdfVariable{"peak_ratio", "peak_ratio", "1", "highest over second correlation peak", ""},
    NetcdfVariable{"status", "status", "1", "0 valid, 1 replaced, 2 masked, 3 invalid", ""},
    NetcdfVariable{"u_raw", "u_raw_px", "pix", "displacement to the right before replacement", ""},
    NetcdfVariable{"v_raw", "v_raw_px", "pix", "displacement downwards before replacement", ""},
    NetcdfVariable{"correlation", "correlation", "1", "correlation coefficient of the peak at u_raw, v_raw", ""},
    NetcdfVariable{"reason", "reason", "1", "origin of the vector: reason of vectors.h5", ""},
    NetcdfVariable{"ambiguous", "ambiguous", "1", "1: another displacement has nearly the same correlation", ""},
};

/// Writes variables over (y, x, t), with one frame.
class NetcdfFile {
 public:
  NetcdfFile(std::string const& path, FileOrigin const& origin, NetcdfAxes const& axes)
      : file_(path, origin), shape_{axes.grid.y.size(), axes.grid.x.size(), 1} {
    write_axis("x", axes.grid.x, axes.units, axes.x_description);
    write_axis("y", axes.grid.y, axes.units, axes.y_description);
    write_axis("t", {0.0}, "frame", "number of the frame");
  }

  void write(NetcdfVariable const& variable, std::vector<double> const& values) {
    std::string const dataset = std::string("/") + variable.name;
    file_.write(dataset, std::span<double const>(values), shape_, variable.units, variable.long_name, "y, x, t");
    file_.attribute(dataset, "long_name", std::string(variable.long_name));
    if (*variable.standard_name != '\0') file_.attribute(dataset, "standard_name", std::string(variable.standard_name));
    scaled_.push_back({dataset, {"/y", "/x", "/t"}});
  }

  void close(std::string const& path) {
    file_.attach_scales(scaled_);
    file_.attribute("/", "delta_t", 1.0);
    file_.attribute("/", "files", path);
    file_.attribute("/", "pivpy_schema_version", std::string("1"));
    file_.attribute("/", "software", "gladstone " + std::string(version));
    file_.close();
  }

 private:
  void write_axis(std::string const& name, std::vector<double> const& places, std::string const& units,
                  std::string const& description) {
    file_.write('/' + name, std::span<double const>(places), {places.size()}, units, description, name);
  }

  Hdf5Writer file_;
  std::vector<std::size_t> shape_;
  std::vector<ScaledDataset> scaled_;
};

}  // namespace

void write_netcdf_table(std::string const& path, VectorTable const& table, NetcdfAxes const& axes,
                        std::span<NetcdfVariable const> variables, FileOrigin const& origin) {
  NetcdfFile file(path, origin, axes);
  for (NetcdfVariable const& variable : variables) {
    file.write(variable, column_named(table.columns, variable.column).values);
  }
  std::vector<double> counts = column_named(table.columns, "status").values;
  for (double& code : counts) code = code <= static_cast<double>(VectorStatus::replaced) ? 1.0 : 0.0;
  file.write({"chc", "", "1", "1: valid or replaced, 0: masked or invalid", "validity_flag"}, counts);
  file.close(path);
}

void write_vector_netcdf(std::string const& path, DisplacementField const& field, FileOrigin const& origin) {
  NetcdfAxes const axes{require_vector_grid(field, path, "PIVPy's schema"), "pix",
                        "column, pixel centres at integers from 0", "row, downwards"};
  write_netcdf_table(path, vector_table(field), axes, netcdf_variables, origin);
}

}  // namespace gladstone::inline vectors
