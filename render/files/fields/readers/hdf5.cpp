#include "render/files/fields/readers/hdf5.h"

#include "render/files/fields/readers/array_file.h"
#include "render/files/hdf5_file.h"

namespace gladstone::inline files {
namespace {

class Hdf5Arrays final : public ArrayFile {
 public:
  explicit Hdf5Arrays(std::string const& path) : file_(path) {}

 private:
  std::vector<std::string> names() const override { return file_.linked_number_datasets(); }
  std::vector<std::string> describe_others() const override { return file_.describe_other_datasets(); }
  bool has(std::string const& array) const override { return file_.has(array); }
  std::vector<std::size_t> shape(std::string const& array) const override { return file_.shape(array); }
  int significant_bits(std::string const& array) const override { return file_.significant_bits(array); }
  std::vector<double> read(std::string const& array) const override { return file_.read(array); }
  void read_box(std::string const& array, std::vector<std::size_t> const& start, std::vector<std::size_t> const& size,
                std::span<double> out) const override {
    file_.read_box(array, start, size, out);
  }
  std::string attribute(std::string const& array, std::string const& name) const override {
    return file_.attribute_of(array, name);
  }
  std::vector<double> number_attribute(std::string const& array, std::string const& name) const override {
    return file_.number_attribute(array, name);
  }
  std::vector<std::string> dimension_scales(std::string const& array) const override {
    return file_.dimension_scales(array);
  }
  std::vector<std::string> dimension_labels(std::string const& array) const override {
    return file_.dimension_labels(array);
  }

  Hdf5Reader file_;
};

}  // namespace

std::unique_ptr<CheckedSource> open_hdf5(std::string const& path, FieldSelection const& selection) {
  return open_array_field(std::make_unique<Hdf5Arrays>(path), path, selection);
}

}  // namespace gladstone::inline files
