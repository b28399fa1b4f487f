#pragma once

#include <initializer_list>
#include <string>

#include "analysis/vectors/vector_file.h"
#include "analysis/vectors/vector_readers/text_table.h"

namespace gladstone::detail {

/// vectors.h5 of ours. @throws DataError naming the dataset
VectorFile read_gladstone_hdf5(std::string const& path);

/// Readers of text: each says whether a table is its format, and makes vectors of it.
bool is_gladstone_csv(TextTable const& table);
VectorFile read_gladstone_csv(TextTable const& table);

/// PIVlab (Thielicke & Sonntag 2021): "x [px],y [px],u [px/frame],v [px/frame],Vector type [-]", column by column;
/// vector type 0 masked, 1 measured, 2 interpolated. Its x is 1-based and ws/2 from the window's first pixel.
bool is_pivlab(TextTable const& table);
VectorFile read_pivlab(TextTable const& table);

/// OpenPIV: "# x y u v flags mask" (flags 0 valid, 1 invalid, 2 interpolated; mask 1 masked), "# x y u v mask" of
/// older versions (mask 1 invalid) and openpiv-cxx's "# x y u v flag". Its x is ws/2 from the window's first pixel.
bool is_openpiv(TextTable const& table);
VectorFile read_openpiv(TextTable const& table);

/// Tecplot's ASCII with VARIABLES x, y, u or Vx, v or Vy, in POINT packing: DaVis' .dat (isValid 0 masked; without that
/// column vectors of exactly no length are taken for masked) and TSI Insight's .vec (CHC 1 measured, above 1 another
/// peak or interpolated, below 1 invalid). y and v point upwards, y from the image's last row.
bool is_tecplot(TextTable const& table);
VectorFile read_tecplot(TextTable const& table);

/// Dantec DynamicStudio's numeric export (">>*HEADER*<<"): Status 0 valid, 16 substituted, others rejected. y and v
/// point upwards, y from the image's last row.
bool is_dantec(TextTable const& table);
VectorFile read_dantec(TextTable const& table);

/// JPIV's .jvc, without a header: x, y, u, v and a quality, which is below 0 for invalid vectors. y and v point
/// downwards.
bool is_jpiv(TextTable const& table);
VectorFile read_jpiv(TextTable const& table);

/// Any table with columns x, y, u, v (or x_px, ...), optionally sigma_u, sigma_v (su, sv), status.
bool has_named_columns(TextTable const& table);
VectorFile read_named_columns(TextTable const& table);

/// x, y, u, v of a table, under whatever names and in whatever units they are, with these units.
VectorFile read_quantities(TextTable const& table, std::string const& format);

/// Lets each of the format's readings count pixels by these offsets as well [px].
void add_offsets(VectorFile& file, std::initializer_list<double> offsets_px);

/// The same numbers as a field; what has a displacement that is not finite becomes invalid.
DisplacementField plain_vectors(std::vector<double> const& x, std::vector<double> const& y,
                                std::vector<double> const& u, std::vector<double> const& v);

/// A status column in our numbers. @throws DataError with file:line for another number
void read_status(TextTable const& table, std::size_t column, DisplacementField& field);

}  // namespace gladstone::detail
