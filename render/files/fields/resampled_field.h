#pragma once

#include <memory>

#include "render/files/fields/oriented_field.h"

namespace gladstone::inline files {

/// Field on a rectilinear grid, resampled along each non-uniform axis to a uniform axis of its finest spacing, by the
/// cubic through the four nearest nodes (exact for cubics). The whole field is held in memory.
///
/// The error is bounded by omitting nodes: each node is predicted by the cubic through two nodes on either side, and
/// the largest difference is reported. If the spacing h varies slowly, the prediction error is 4/24 h^4 f'''', the
/// resampling error at most a quarter of it: 0.94/24 h^4 f'''' in the first and last cell, 0.56/24 h^4 f'''' elsewhere.
class ResampledField final : public FieldSource {
 public:
  explicit ResampledField(std::unique_ptr<OrientedField> source);

  RegularGrid const& grid() const override { return grid_; }
  FieldUnits const& units() const override { return source_->units(); }
  AxisAssignment const& reading() const override { return source_->reading(); }
  Warnings notes() override;
  std::string const& name() const override { return source_->name(); }
  int significant_bits() const override { return source_->significant_bits(); }
  void read_planes(int first_plane, int count, std::span<double> out) override;
  void read_rows(int plane, int first_row, int count, std::span<double> out) override;

  /// Returns the largest difference between a node's value and its prediction from its neighbours, in units().values.
  double error_bound();

 private:
  void load();

  std::unique_ptr<OrientedField> source_;
  RegularGrid grid_;
  std::vector<double> values_;  ///< resampled values, once loaded
  double error_ = 0, range_ = 0;
};

}  // namespace gladstone::inline files
