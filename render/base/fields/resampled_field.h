#pragma once

#include <memory>
#include <optional>

#include "render/base/fields/oriented_field.h"

namespace gladstone {

/// A field on a rectilinear grid, resampled to the finest spacing of every axis that is not uniform, by the cubic
/// through the four nearest nodes (exact for cubics). The whole field is held in memory.
///
/// The error is bounded by leaving nodes out: each is predicted by the cubic through the two nodes on either side, and
/// the largest difference is stated. For spacings h that change slowly the prediction is off by 4/24 h^4 f'''' and the
/// resampled value by at most 0.94/24 h^4 f'''' (in the first and last cell; 0.56/24 elsewhere), a quarter of it.
class ResampledField final : public FieldSource {
 public:
  explicit ResampledField(std::unique_ptr<OrientedField> source);

  RegularGrid const& grid() const override { return grid_; }
  FieldUnits const& units() const override { return source_->units(); }
  FieldReading const& reading() const override { return source_->reading(); }
  std::vector<std::string> notes() override;
  std::string const& name() const override { return source_->name(); }
  int significant_bits() const override { return source_->significant_bits(); }
  void read_planes(int first_plane, int count, std::span<double> out) override;
  void read_rows(int plane, int first_row, int count, std::span<double> out) override;

  /// Largest difference between a node's value and its prediction from its neighbours.
  double error_bound();

 private:
  void load();

  std::unique_ptr<OrientedField> source_;
  RegularGrid grid_;
  std::vector<double> values_;  ///< once it is read
  double error_ = 0, range_ = 0;
};

}  // namespace gladstone
