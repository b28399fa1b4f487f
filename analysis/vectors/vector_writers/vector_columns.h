#pragma once

#include <string>
#include <vector>

#include "analysis/vectors/displacement_field.h"

namespace gladstone::inline vectors {

/// Quantity of all vectors, as files store it.
struct VectorColumn {
  std::string name;         ///< name of the column with its unit: "u_px"
  std::string units;        ///< "px" or "1"
  std::string description;  ///< meaning of the numbers
  bool is_code = false;     ///< true if the values are integer codes, such as the status
  std::vector<double> values;

  /// Returns true if at least one vector has a finite value.
  bool is_known() const;
};

/// Vectors as the writers store them.
struct VectorTable {
  std::vector<VectorColumn> columns;
  int grid_columns = 0, grid_rows = 0;  ///< numbers of columns and rows of the grid; 0: scattered vectors
  std::string remark;                   ///< units and directions of the axes, for headers
  std::string content = "vectors";      ///< plural noun for the rows in headers: "vectors"
  int grid_layers = 1;                  ///< number of grid layers along z, stored one after the other

  std::size_t rows() const { return columns.empty() ? 0 : columns.front().values.size(); }
};

/// Returns the quantities of vectors.csv in their order: x_px, y_px, u_px, v_px, sigma_u_px, sigma_v_px, peak_ratio,
/// status, u_raw_px, v_raw_px, correlation, reason, ambiguous. Values that were not estimated are NaN. If the field has
/// no raw displacements, the displacements are used instead, with reason 0 (measured).
std::vector<VectorColumn> vector_columns(DisplacementField const& field);

/// Returns the quantities of vector_columns() together with the size of the grid and the remark for headers.
VectorTable vector_table(DisplacementField const& field);

/// Returns a column of numbers.
VectorColumn number_column(std::string name, std::string units, std::string description, std::vector<double> values);
/// Returns the column "status" of VectorStatus; vectors without status are valid.
VectorColumn status_column(std::vector<VectorStatus> const& status, std::size_t count);

/// Returns the validation tests that the vectors failed, which only vectors.h5 contains.
VectorColumn failed_test_column(DisplacementField const& field);

/// Coordinates of the columns and rows of a grid of vectors [px].
struct VectorGrid {
  std::vector<double> x, y;
};

/// Returns the coordinates of the grid: those of its first row and of its first column.
/// @param kind  kind of the output file for the message: "NetCDF"
/// @throws OutputError if the vectors are scattered
VectorGrid require_vector_grid(DisplacementField const& field, std::string const& path, std::string const& kind);

/// Returns the column of this name. @pre it exists
VectorColumn const& column_named(std::vector<VectorColumn> const& columns, std::string const& name);

}  // namespace gladstone::inline vectors
