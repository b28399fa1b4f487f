#include "render/files/fields/readers/velocity_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/fields/field_units.h"
#include "render/files/fields/readers/array_axes.h"
#include "render/files/fields/readers/array_coordinates.h"
#include "render/files/fields/readers/packing.h"

namespace gladstone::inline files {
namespace {

/// Names of the arrays of the components of a velocity.
using ComponentNames = std::array<std::string_view, 3>;
constexpr std::array velocity_names{ComponentNames{"u", "v", "w"}, ComponentNames{"vx", "vy", "vz"},
                                    ComponentNames{"ux", "uy", "uz"}};

/// Arrays of the components of a velocity, and the name of the array of vectors.
struct Velocity {
  std::string name;
  std::array<std::string, 3> components;  ///< names of the arrays of the components; the third one may be empty
};

/// Returns the name of an array in lower case without its group and unit: "vx" of "flow/Vx_m_s".
std::string quantity_of(std::string const& array) {
  std::string const name = last_step(array);
  return lower_case(name.substr(0, name.size() - unit_suffix(name).ending.size()));
}

class VelocityArrays final : public ArrayFile {
 public:
  VelocityArrays(std::unique_ptr<ArrayFile const> file, std::string path)
      : file_(std::move(file)), path_(std::move(path)), names_(file_->names()) {
    std::vector<std::string> const given = names_;
    for (std::string const& first : given) {
      for (ComponentNames const& wanted : velocity_names) {
        if (quantity_of(first) == wanted[0]) join(given, first, wanted);
      }
    }
  }

 private:
  /// Adds a velocity with the array `first` as its first component, if the file contains the second component.
  void join(std::vector<std::string> const& given, std::string const& first, ComponentNames const& wanted) {
    std::string const group = first.substr(0, first.size() - last_step(first).size());
    ArrayShape shape = file_->shape(first);
    auto const find = [&](std::string_view quantity) {
      auto const found = std::find_if(given.begin(), given.end(), [&](std::string const& one) {
        return one == group + last_step(one) && quantity_of(one) == quantity && file_->shape(one) == shape;
      });
      return found == given.end() ? "" : *found;
    };
    Velocity const velocity{group + "velocity", {first, find(wanted[1]), find(wanted[2])}};
    shape.push_back(velocity.components.size());
    if (velocity.components[1].empty() || has(velocity.name) || !find_axes(shape, 3)) return;
    for (std::string const& component : velocity.components) std::erase(names_, component);
    names_.push_back(velocity.name);
    velocities_.push_back(velocity);
  }

  Velocity const* find_velocity(std::string const& array) const {
    auto const found =
        std::find_if(velocities_.begin(), velocities_.end(), [&](Velocity const& one) { return one.name == array; });
    return found == velocities_.end() ? nullptr : &*found;
  }

  std::vector<std::string> names() const override { return names_; }
  std::vector<std::string> describe_others() const override { return file_->describe_others(); }
  bool has(std::string const& array) const override { return find_velocity(array) || file_->has(array); }

  std::vector<std::size_t> shape(std::string const& array) const override {
    Velocity const* const velocity = find_velocity(array);
    if (!velocity) return file_->shape(array);
    ArrayShape shape = file_->shape(velocity->components[0]);
    shape.push_back(velocity->components.size());
    return shape;
  }

  int significant_bits(std::string const& array) const override {
    Velocity const* const velocity = find_velocity(array);
    if (!velocity) return file_->significant_bits(array);
    int bits = 0;
    for (std::string const& component : velocity->components) {
      if (component.empty()) continue;
      bool const scaled = read_packing(*file_, component).scaled();
      bits = std::max(bits, scaled ? std::numeric_limits<double>::digits : file_->significant_bits(component));
    }
    return bits;
  }

  std::vector<double> read(std::string const& array) const override { return file_->read(array); }

  /// Reads each component from its own array, since their packings may differ; the last axis counts the components.
  void read_box(std::string const& array, std::vector<std::size_t> const& start, std::vector<std::size_t> const& size,
                std::span<double> out) const override {
    Velocity const* const velocity = find_velocity(array);
    if (!velocity) return file_->read_box(array, start, size, out);
    std::size_t const width = size.back();
    ArrayShape const nodes_start(start.begin(), start.end() - 1), nodes_size(size.begin(), size.end() - 1);
    std::vector<double> values(out.size() / width);
    for (std::size_t i = 0; i < width; ++i) {
      std::string const& component = velocity->components[start.back() + i];
      std::fill(values.begin(), values.end(), 0.0);
      if (!component.empty()) {
        file_->read_box(component, nodes_start, nodes_size, values);
        Packing const packing = read_packing(*file_, component);
        if (packing.scaled() || !packing.missing.empty()) packing.unpack(values);
      }
      for (std::size_t node = 0; node < values.size(); ++node) out[node * width + i] = values[node];
    }
  }

  std::string attribute(std::string const& array, std::string const& name) const override {
    Velocity const* const velocity = find_velocity(array);
    if (!velocity) return file_->attribute(array, name);
    return name == "units" ? common_unit(*velocity) : file_->attribute(velocity->components[0], name);
  }

  std::string common_unit(Velocity const& velocity) const {
    std::string common;
    for (std::string const& component : velocity.components) {
      if (component.empty()) continue;
      std::string unit = trimmed(file_->attribute(component, "units"));
      if (!states_unit(unit)) unit = unit_suffix(last_step(component)).unit;
      if (&component != velocity.components.data() && unit != common) {
        throw DataError(ErrorCode::inconsistent, path_,
                        fmt::format("\"{}\" is in \"{}\", but \"{}\" in \"{}\"; store the components in one unit",
                                    velocity.components[0], common, component, unit));
      }
      common = unit;
    }
    return common;
  }

  std::vector<double> number_attribute(std::string const& array, std::string const& name) const override {
    return find_velocity(array) ? std::vector<double>{} : file_->number_attribute(array, name);
  }

  std::vector<std::string> dimension_scales(std::string const& array) const override {
    Velocity const* const velocity = find_velocity(array);
    std::vector<std::string> scales = file_->dimension_scales(velocity ? velocity->components[0] : array);
    if (velocity) scales.emplace_back();
    return scales;
  }

  std::vector<std::string> dimension_labels(std::string const& array) const override {
    Velocity const* const velocity = find_velocity(array);
    std::vector<std::string> labels = file_->dimension_labels(velocity ? velocity->components[0] : array);
    if (velocity) labels.emplace_back();
    return labels;
  }

  Warnings notes() const override {
    Warnings notes = file_->notes();
    for (Velocity const& velocity : velocities_) {
      if (!velocity.components[2].empty()) continue;
      notes.push_back({WarningCode::assumed, "",
                       fmt::format("\"{}\" and \"{}\" are read as a velocity whose third component is 0, since the "
                                   "file has no third array of their shape",
                                   velocity.components[0], velocity.components[1])});
    }
    return notes;
  }

  std::unique_ptr<ArrayFile const> file_;
  std::string path_;
  std::vector<std::string> names_;
  std::vector<Velocity> velocities_;
};

}  // namespace

std::unique_ptr<ArrayFile const> join_velocities(std::unique_ptr<ArrayFile const> file, std::string const& path) {
  return std::make_unique<VelocityArrays>(std::move(file), path);
}

}  // namespace gladstone::inline files
