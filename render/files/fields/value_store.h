#pragma once

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "render/base/available_memory.h"

namespace gladstone::inline files {

/// Values of a field in memory, stored as float if that preserves all significant bits, else as double.
class ValueStore {
 public:
  /// Allocates `count` values. @throws DataError (code `memory`) naming the file and `what`
  void allocate(std::size_t count, int significant_bits, std::string const& path, std::string const& what) {
    bool const single = significant_bits <= 24;
    require_memory(path, what, static_cast<double>(count) * (single ? sizeof(float) : sizeof(double)));
    if (single) {
      values_ = std::vector<float>(count);
    } else {
      values_ = std::vector<double>(count);
    }
  }
  std::size_t size() const {
    return std::visit([](auto const& values) { return values.size(); }, values_);
  }
  double operator[](std::size_t i) const {
    if (auto const* const single = std::get_if<std::vector<float>>(&values_)) return static_cast<double>((*single)[i]);
    return std::get<std::vector<double>>(values_)[i];
  }
  void set(std::size_t i, double value) {
    if (auto* const single = std::get_if<std::vector<float>>(&values_)) {
      (*single)[i] = static_cast<float>(value);
    } else {
      std::get<std::vector<double>>(values_)[i] = value;
    }
  }

 private:
  std::variant<std::vector<float>, std::vector<double>> values_;
};

}  // namespace gladstone::inline files
