#pragma once

#include <memory>

#include "render/base/fields/field_file.h"
#include "render/base/fields/readers/checked_source.h"
#include "render/base/fields/value_store.h"

namespace gladstone {

/// A stored field turned to world axes: exchanged axes are put in order and axes that run backwards are turned round.
/// Exchanged axes need the whole field in memory, turned ones do not. Nodes need not be uniform: see coordinates().
class OrientedField final : public FieldSource {
 public:
  explicit OrientedField(std::unique_ptr<CheckedSource> stored);

  RegularGrid const& grid() const override { return grid_; }
  FieldUnits const& units() const override { return stored_->units(); }
  FieldReading const& reading() const override { return stored_->reading(); }
  std::vector<std::string> notes() override { return stored_->notes(); }
  std::string const& name() const override { return stored_->name(); }
  std::string const& path() const { return stored_->path(); }
  int significant_bits() const override { return stored_->significant_bits(); }
  void read_planes(int first_plane, int count, std::span<double> out) override;
  void read_rows(int plane, int first_row, int count, std::span<double> out) override;

  /// Ascending coordinates of the nodes along a world axis that is not uniform; empty for a uniform one.
  std::vector<double> const& coordinates(std::size_t axis) const { return coordinates_[axis]; }
  bool uniform() const;

 private:
  void turn_rows(int count, std::span<double> rows) const;
  void load();

  std::unique_ptr<CheckedSource> stored_;
  RegularGrid grid_;
  std::array<std::size_t, 3> stored_axis_{};  ///< of a world axis: its number in the file, the fastest first
  std::array<bool, 3> backwards_{};           ///< of a world axis
  std::array<std::vector<double>, 3> coordinates_;
  ValueStore all_;  ///< of a field whose axes are exchanged, in the file's order, once it is read
};

}  // namespace gladstone
