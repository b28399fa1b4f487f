#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "render/files/hdf5_file.h"

namespace gladstone::inline files {

/// The named axes of the datasets of a file. netCDF-4 and xarray show them as dimensions, with the coordinates if there
/// are any.
class Hdf5Axes {
 public:
  /// @param file  must outlive this object
  explicit Hdf5Axes(Hdf5Writer& file) : file_(file) {}

  /// Writes the numbers 0, 1, 2, ... as coordinates of an axis without physical coordinates: dots, components, frames.
  /// @param axis  absolute path of the dataset, whose last step is the name of the axis: "/dots/dot"
  void write_numbers(std::string const& axis, std::size_t size, std::string const& description);
  /// Names the axes of a dataset, the slowest first, by the paths of their coordinates.
  void name(std::string const& dataset, std::vector<std::string> const& axes) { scaled_.push_back({dataset, axes}); }
  /// Stores the names of all axes in the file. To be called once, after all datasets were written.
  void attach() { file_.attach_scales(scaled_); }

 private:
  Hdf5Writer& file_;
  std::vector<ScaledDataset> scaled_;
};

}  // namespace gladstone::inline files
