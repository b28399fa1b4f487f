#pragma once

#include <memory>

#include "render/files/fields/field_file.h"
#include "render/files/fields/readers/checked_source.h"
#include "render/files/fields/value_store.h"

namespace gladstone::inline files {

/// Stored field in world orientation: axes are permuted to x, y, z and reversed where they descend. A permutation
/// requires the whole field in memory, a reversal does not. The spacing may be non-uniform, see coordinates().
class OrientedField final : public FieldSource {
 public:
  explicit OrientedField(std::unique_ptr<CheckedSource> stored);

  RegularGrid const& grid() const override { return grid_; }
  FieldUnits const& units() const override { return stored_->units(); }
  AxisAssignment const& reading() const override { return stored_->reading(); }
  Warnings notes() override { return stored_->notes(); }
  std::string const& name() const override { return stored_->name(); }
  std::string const& path() const { return stored_->path(); }
  int significant_bits() const override { return stored_->significant_bits(); }
  void read_planes(int first_plane, int count, std::span<double> out) override;
  void read_rows(int plane, int first_row, int count, std::span<double> out) override;

  /// Returns the ascending coordinates of the nodes along a non-uniform world axis; empty for a uniform one.
  std::vector<double> const& coordinates(std::size_t axis) const { return coordinates_[axis]; }
  bool uniform() const;

 private:
  void turn_rows(int count, std::span<double> rows) const;
  void load();

  std::unique_ptr<CheckedSource> stored_;
  RegularGrid grid_;
  std::array<std::size_t, 3> stored_axis_{};  ///< stored axis of each world axis, 0 = fastest
  std::array<bool, 3> backwards_{};           ///< true for world axes that are stored in descending order
  std::array<std::vector<double>, 3> coordinates_;
  ValueStore all_;  ///< all values in the order of the file if axes are permuted, once loaded
};

}  // namespace gladstone::inline files
