#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/files/fields/readers/array_file.h"
#include "render/files/fields/value_store.h"

namespace gladstone::inline files {

/// Reads consecutive values of an array, in the order of its shape, from number `first` on.
using ReadValues = std::function<void(std::size_t first, std::span<double> out)>;

/// Array of numbers in a file without attributes.
struct ListedArray {
  std::string name;
  std::vector<std::size_t> shape;  ///< slowest axis first
  int significant_bits = 53;
  ReadValues read;
  std::string units = "";         ///< attribute "units"; empty: not stated
  std::string matlab_class = "";  ///< attribute "MATLAB_class"; empty: not an array of MATLAB
};

/// Entry of a file that holds no real numbers.
struct OtherEntry {
  std::string name;
  std::string content;  ///< "Python objects", "text"
};

/// File of arrays that are known when it is opened.
class ListedArrays final : public ArrayFile {
 public:
  ListedArrays(std::string path, std::vector<ListedArray> arrays, std::vector<OtherEntry> others = {},
               Warnings notes = {})
      : path_(std::move(path)), arrays_(std::move(arrays)), others_(std::move(others)), notes_(std::move(notes)) {}

 private:
  std::vector<std::string> names() const override;
  std::vector<std::string> describe_others() const override;
  bool has(std::string const& array) const override;
  std::vector<std::size_t> shape(std::string const& array) const override { return find(array).shape; }
  int significant_bits(std::string const& array) const override { return find(array).significant_bits; }
  std::vector<double> read(std::string const& array) const override;
  void read_box(std::string const& array, std::vector<std::size_t> const& start, std::vector<std::size_t> const& size,
                std::span<double> out) const override;
  std::string attribute(std::string const& array, std::string const& name) const override;
  std::vector<double> number_attribute(std::string const&, std::string const&) const override { return {}; }
  std::vector<std::string> dimension_scales(std::string const& array) const override {
    return std::vector<std::string>(find(array).shape.size());
  }
  std::vector<std::string> dimension_labels(std::string const& array) const override { return dimension_scales(array); }
  Warnings notes() const override { return notes_; }

  ListedArray const& find(std::string const& array) const;

  std::string path_;
  std::vector<ListedArray> arrays_;
  std::vector<OtherEntry> others_;
  Warnings notes_;
};

/// Returns a function that loads all values at its first call, and keeps them.
ReadValues load_once(std::function<ValueStore()> load);

/// Returns the number of values of a shape times the bytes of a value.
/// @throws DataError if a size is above 1e15 bytes
std::size_t checked_bytes(std::vector<std::size_t> const& shape, std::size_t value_bytes, std::string const& path,
                          std::string const& name);

}  // namespace gladstone::inline files
