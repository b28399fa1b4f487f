#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "analysis/vectors/vector_file.h"
#include "analysis/vectors/vector_readers/text_table.h"

namespace gladstone::inline vectors {

/// Reads vectors.h5 of gladstone. @throws DataError that contains the name of the dataset
VectorFile read_gladstone_hdf5(std::string const& path);

/// Reads netCDF-4 in the schema of PIVPy, written by gladstone or other programs such as PIVPy itself: u and v over (y,
/// x, t) in any order, of one frame. The validity is read from `status`, else from `chc`. In files of other programs, y
/// and v point downwards, or both upwards about the centre of the grid.
/// @throws DataError for netCDF-3, several frames or three components
VectorFile read_vector_netcdf(std::string const& path);

/// Reads MATLAB files of level 5 or 7.3 with a matrix for each column of vectors.csv. @throws DataError if columns are
/// missing
VectorFile read_vector_matlab(std::string const& path);

/// Reads VTK images (.vti) or points (.vtp) with the arrays that gladstone writes. @throws DataError if arrays are
/// missing
VectorFile read_vector_vtk(std::string const& path);

/// Text formats. For each, a function recognises a table of the format and another converts it to vectors.
bool is_gladstone_csv(TextTable const& table);
VectorFile read_gladstone_csv(TextTable const& table);

/// Tecplot ASCII as gladstone writes it, with VARIABLES x_px, y_px, u_px, v_px and status; y and v downwards. The
/// variable `unknown` marks unknown values; in files of older versions, which lack it, 0 marks them.
bool is_gladstone_tecplot(TextTable const& table);
VectorFile read_gladstone_tecplot(TextTable const& table);

/// PIVlab (Thielicke & Sonntag 2021): "x [px],y [px],u [px/frame],v [px/frame],Vector type [-]", column by column;
/// vector type 0 is masked, 1 measured, any other interpolated. x is 1-based and ws/2 from the first pixel of the
/// window (ws: window size).
bool is_pivlab(TextTable const& table);
VectorFile read_pivlab(TextTable const& table);

/// OpenPIV: "# x y u v flags mask" (flags 0 valid, 1 invalid, 2 interpolated; mask 1 masked), "# x y u v mask" of older
/// versions (mask 1 invalid) and openpiv-cxx's "# x y u v flag". x is ws/2 from the first pixel of the window.
bool is_openpiv(TextTable const& table);
VectorFile read_openpiv(TextTable const& table);

/// Tecplot ASCII with VARIABLES x, y, u or Vx, v or Vy, and DaVis' text export, whose y points
/// downwards if it increases from row to row: DaVis (isValid 0: masked; without that column, vectors of exactly zero
/// count as masked) and TSI Insight .vec (CHC 1: measured; above 1: secondary peak or interpolated; below 1: invalid).
/// y and v point upwards, y from the last row of the image.
bool is_tecplot(TextTable const& table);
VectorFile read_tecplot(TextTable const& table);

/// Numeric export of Dantec DynamicStudio (recognised by ">>*DATA*<<"): Status 0 valid, 16 substituted, others
/// rejected. y and v point upwards, y from the last row of the image.
bool is_dantec(TextTable const& table);
VectorFile read_dantec(TextTable const& table);

/// JPIV .jvc, without header: x, y, u, v and optionally a quality, which is negative for invalid vectors. y and v point
/// downwards.
bool is_jpiv(TextTable const& table);
VectorFile read_jpiv(TextTable const& table);

/// Recognises any table; tried last. Columns: x, y, u, v (or x_px, ...), optionally sigma_u, sigma_v (su, sv),
/// peak_ratio, status, chc, isValid. read_named_columns() throws DataError if x, y, u or v is missing.
bool has_named_columns(TextTable const& table);
VectorFile read_named_columns(TextTable const& table);

/// Reads x, y, u and v of a table together with their units; the columns may have any of the known names.
/// @param others  names of further columns that the caller uses; VectorFile::notes contains the remaining ones
VectorFile read_quantities(TextTable const& table, std::string const& format,
                           std::initializer_list<std::string_view> others);

/// Adds alternative conventions: each of the format's conventions with each of these offsets [px].
void add_offsets(VectorFile& file, std::initializer_list<double> offsets_px);

/// Converts columns to a displacement field; vectors with a displacement that is not finite become invalid.
DisplacementField plain_vectors(std::vector<double> const& x, std::vector<double> const& y,
                                std::vector<double> const& u, std::vector<double> const& v);

/// Reads the validity of TSI Insight (column CHC) and DaVis (column isValid), which other programs also write under
/// these names: CHC 1 measured, above 1 replaced, below 1 invalid; isValid above 0 measured, otherwise masked.
/// @return false if the table has neither column
bool read_validity(TextTable const& table, DisplacementField& field);

/// Reads a status column with the codes of VectorStatus. @throws DataError with file:line for any other number
void read_status(TextTable const& table, std::size_t column, DisplacementField& field);

}  // namespace gladstone::inline vectors
