#pragma once

#include <string>

#include "render/base/fields/field_file.h"

namespace gladstone {

/// A FieldSource that refuses values no field has: JHTDB's -999.9 where it has no data, nan and inf. Readers give the
/// raw values; where one is bad the whole field is read once more, to say how many there are.
class CheckedSource : public FieldSource {
 public:
  CheckedSource(std::string path, std::string name, int values)
      : FieldSource(values), path_(std::move(path)), name_(std::move(name)) {}

  RegularGrid const& grid() const override { return grid_; }
  FieldUnits const& units() const override { return units_; }
  std::string const& name() const override { return name_; }
  void read_planes(int first_plane, int count, std::span<double> out) final;
  void read_rows(int plane, int first_row, int count, std::span<double> out) final;

 protected:
  virtual void read_raw_planes(int first_plane, int count, std::span<double> out) = 0;
  virtual void read_raw_rows(int plane, int first_row, int count, std::span<double> out) = 0;

  /// Numbers in a row of nodes.
  std::size_t row_values() const {
    return static_cast<std::size_t>(grid_.nodes[0]) * static_cast<std::size_t>(values());
  }

  std::string path_;
  std::string name_;
  RegularGrid grid_;
  FieldUnits units_;

 private:
  /// Where one of the values is bad, reads the field once more, to say how many are.
  void refuse_bad_values(std::span<double const> read);
};

}  // namespace gladstone
