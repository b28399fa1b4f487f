#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gladstone::inline vectors {

/// Column name split into quantity and unit: "U pix[pix]" is the quantity "u" in "pix".
struct ColumnName {
  std::string quantity;  ///< lower case, without the unit
  std::string unit;      ///< lower case; empty: not stated
};
ColumnName parse_column_name(std::string_view name);

/// Returns true if a unit, as in ColumnName, is a pixel unit or not stated.
bool is_pixel_unit(std::string_view unit);

/// Parses the column names of a header line, without leading "#" or "%" and without quotation marks. A blank-separated
/// header with units in brackets ("u [px/frame]") is split after each unit.
std::vector<std::string> column_names(std::string_view line);

/// Parses the names of Tecplot's variables: the words after VARIABLES =, in quotation marks or separated by commas and
/// blanks, up to the next record of the header.
/// @param text  lines of the header, joined by blanks
/// @return empty if the text has no VARIABLES record
std::vector<std::string> tecplot_variables(std::string const& text);

/// Header of DaVis' text export: #DaVis 8.4.0 2D-vector 16 49 49 "position" "mm" "position" "mm" "velocity" "m/s" are
/// version, kind, window size, two sizes of the grid, and quantity and unit of x, of y and of both components.
/// PIVMat (Moisy, loadpivtxt.m, version 1.32) reads the units from the same positions among these 12 words.
struct DavisHeader {
  bool planar = false;             ///< true if the kind is 2D-vector, with the columns x, y, u, v
  std::vector<std::string> names;  ///< names of the columns: "x [mm]", "y [mm]", "Vx [m/s]", "Vy [m/s]"
  std::optional<double> vectors;   ///< number of vectors of the grid; nullopt: not stated
};
/// Parses the header line of DaVis' text export. @return nullopt if the line does not begin with "#DaVis"
std::optional<DavisHeader> parse_davis_header(std::string_view line);

/// Number of vectors according to the header of a file: I, J and K of a Tecplot zone, GridSize of Dantec, or the size
/// of the grid in DaVis' text export.
class DeclaredVectors {
 public:
  /// Adds a line of the header.
  /// @param line_number  counted from 1
  void add(std::string_view line, std::size_t line_number);
  /// Returns the declared number of vectors; nullopt if the header declares none.
  std::optional<double> count() const { return count_; }
  /// Returns the line number of the declaration.
  std::size_t line() const { return line_; }

 private:
  std::optional<double> count_;
  std::size_t line_ = 0;
  bool in_zone_ = false;  ///< true if a line with Tecplot's ZONE has been added
};

}  // namespace gladstone::inline vectors
