#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "analysis/vectors/vector_readers/own_columns.h"
#include "analysis/vectors/vector_readers/vector_readers.h"
#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/hdf5_file.h"
#include "render/files/input_file.h"

namespace gladstone::inline vectors {
namespace {

/// Variable of PIVPy's schema and the column that the variable contains.
struct SchemaColumn {
  char const* variable;
  char const* column;
};
constexpr std::array schema_columns{SchemaColumn{"/u", "u_px"},
                                    SchemaColumn{"/v", "v_px"},
                                    SchemaColumn{"/sigma_u", "sigma_u_px"},
                                    SchemaColumn{"/sigma_v", "sigma_v_px"},
                                    SchemaColumn{"/peak_ratio", "peak_ratio"},
                                    SchemaColumn{"/status", "status"},
                                    SchemaColumn{"/u_raw", "u_raw_px"},
                                    SchemaColumn{"/v_raw", "v_raw_px"},
                                    SchemaColumn{"/correlation", "correlation"},
                                    SchemaColumn{"/reason", "reason"},
                                    SchemaColumn{"/ambiguous", "ambiguous"}};

void refuse_netcdf_3(std::string const& path) {
  std::array<char, 3> start{};
  InputFile const file(path, "a file of vectors");
  if (file.read(0, start.data(), start.size()) == 3 && std::equal(start.begin(), start.end(), "CDF"))
    throw DataError(ErrorCode::unsupported, path,
                    "is netCDF-3; save it as netCDF-4 (xarray: to_netcdf(..., engine=\"h5netcdf\"))");
}

/// Reader of variables over x and y.
class SchemaReader {
 public:
  explicit SchemaReader(std::string const& path) : path_(path), file_(path) {
    for (char const* const name : {"/x", "/y", "/u", "/v"}) {
      if (file_.has(name)) continue;
      throw DataError(ErrorCode::missing_content, path,
                      fmt::format("has no variable {}, which PIVPy's schema requires (the file contains {})", name + 1,
                                  fmt::join(file_.dataset_names(), ", ")));
    }
    if (file_.has("/w"))
      throw DataError(
          ErrorCode::unsupported, path,
          "has three components (variable w), but two components in px are required; give the vectors of one camera");
    x_ = file_.read("/x");
    y_ = file_.read("/y");
  }

  bool has(char const* variable) const { return file_.has(variable); }
  std::string units(char const* variable) const {
    std::string const unit = lower_case(trimmed(file_.attribute_of(variable, "units")));
    return is_pixel_unit(unit) || unit == "1" ? "" : unit;
  }

  /// Returns the values of a variable row by row.
  std::vector<double> read(std::string const& variable) const {
    std::vector<std::size_t> const shape = file_.shape(variable);
    std::vector<std::string> const scales = file_.dimension_scales(variable);
    std::vector<double> stored = file_.read(variable);
    std::size_t count = 1, of_x = shape.size(), of_y = shape.size();
    for (std::size_t i = 0; i < shape.size(); ++i) {
      count *= shape[i];
      if (scales[i] == "/x") of_x = i;
      if (scales[i] == "/y") of_y = i;
    }
    bool const both =
        of_x < shape.size() && of_y < shape.size() && shape[of_x] == x_.size() && shape[of_y] == y_.size();
    if (!both)
      throw DataError(ErrorCode::wrong_shape, path_,
                      fmt::format("{} is not a variable over the coordinates x and y; save the data set in PIVPy's "
                                  "schema",
                                  variable.substr(1)));
    if (count != x_.size() * y_.size())
      throw DataError(ErrorCode::wrong_shape, path_,
                      fmt::format("{} has {} frames, but one is required; save one of them (xarray: ds.isel(t=[0]))",
                                  variable.substr(1), count / std::max<std::size_t>(x_.size() * y_.size(), 1)));
    if (of_y < of_x) return stored;
    std::vector<double> by_rows(count);
    for (std::size_t i = 0; i < count; ++i) by_rows[i] = stored[i % x_.size() * y_.size() + i / x_.size()];
    return by_rows;
  }

  /// Returns the positions of all vectors, row by row.
  std::pair<std::vector<double>, std::vector<double>> positions() const {
    std::pair<std::vector<double>, std::vector<double>> places;
    for (double const y : y_) {
      for (double const x : x_) {
        places.first.push_back(x);
        places.second.push_back(y);
      }
    }
    return places;
  }

 private:
  std::string path_;
  Hdf5Reader file_;
  std::vector<double> x_, y_;
};

/// Reads the conventions and the validity of a file that gladstone did not write.
void read_foreign_schema(SchemaReader const& reader, std::string const& path, VectorFile& file) {
  file.format = "PIVPy";
  file.foreign = true;
  file.place_unit = reader.units("/x");
  file.displacement_unit = reader.units("/u");
  VectorConventions turned;
  turned.y_up = turned.v_up = true;
  file.also = {turned};
  add_offsets(file, {-0.5, -1.0});
  if (!reader.has("/chc")) return;
  std::vector<double> const choice = reader.read("/chc");
  for (std::size_t i = 0; i < choice.size(); ++i) {
    if (!(choice[i] >= 1.0)) file.field.status[i] = VectorStatus::invalid;
  }
  bool const none = std::none_of(choice.begin(), choice.end(), [](double chc) { return chc >= 1.0; });
  if (none && !choice.empty()) {
    file.warnings.push_back(
        {WarningCode::implausible, path,
         "chc marks all vectors as invalid (PIVPy copies the flags of an OpenPIV file, 0 for valid vectors, to chc); "
         "if so, save the data set with chc = (chc == 0), or give the OpenPIV file"});
  }
}

}  // namespace

VectorFile read_vector_netcdf(std::string const& path) {
  refuse_netcdf_3(path);
  SchemaReader const reader(path);
  OwnColumns columns{path};
  for (auto const& [variable, column] : schema_columns) {
    if (reader.has(variable)) columns.values[column] = reader.read(variable);
  }
  std::tie(columns.values["x_px"], columns.values["y_px"]) = reader.positions();
  VectorFile file = read_own_columns(columns);
  if (!reader.has("/status")) read_foreign_schema(reader, path, file);
  return file;
}

}  // namespace gladstone::inline vectors
