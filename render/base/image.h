#pragma once

#include <cstddef>
#include <vector>

#include "render/base/contracts.h"

namespace gladstone::inline base {

/// Row-major image: column x to the right, row y downwards, pixel centres at integer coordinates from 0.
template <class T>
class Image {
 public:
  Image() = default;
  Image(int columns, int rows, T value = T{})
      : columns_(columns), rows_(rows), pixels_(static_cast<std::size_t>(columns) * rows, value) {
    GLADSTONE_EXPECTS(columns >= 0 && rows >= 0);
  }

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  std::size_t size() const { return pixels_.size(); }
  bool empty() const { return pixels_.empty(); }
  T& operator()(int column, int row) { return pixels_[static_cast<std::size_t>(row) * columns_ + column]; }
  T const& operator()(int column, int row) const { return pixels_[static_cast<std::size_t>(row) * columns_ + column]; }
  T* data() { return pixels_.data(); }
  T const* data() const { return pixels_.data(); }
  auto begin() { return pixels_.begin(); }
  auto end() { return pixels_.end(); }
  auto begin() const { return pixels_.begin(); }
  auto end() const { return pixels_.end(); }

 private:
  int columns_ = 0;
  int rows_ = 0;
  std::vector<T> pixels_;
};

}  // namespace gladstone::inline base
