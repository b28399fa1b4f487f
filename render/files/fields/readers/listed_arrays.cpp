#include "render/files/fields/readers/listed_arrays.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <optional>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/nearest_name.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {

std::vector<std::string> ListedArrays::names() const {
  std::vector<std::string> names;
  for (ListedArray const& one : arrays_) names.push_back(one.name);
  return names;
}

std::vector<std::string> ListedArrays::describe_others() const {
  std::vector<std::string> texts;
  for (OtherEntry const& other : others_)
    texts.push_back(fmt::format("\"{}\" of {}", excerpt(other.name), other.content));
  return texts;
}

bool ListedArrays::has(std::string const& array) const {
  return std::any_of(arrays_.begin(), arrays_.end(), [&](ListedArray const& one) { return one.name == array; });
}

ListedArray const& ListedArrays::find(std::string const& array) const {
  for (ListedArray const& one : arrays_) {
    if (one.name == array) return one;
  }
  for (OtherEntry const& other : others_) {
    if (other.name != array) continue;
    throw DataError(ErrorCode::wrong_type, path_,
                    fmt::format("\"{}\" holds {}, not real numbers; store it as an array of numbers", excerpt(array),
                                other.content));
  }
  std::vector<std::string> const known = names();
  auto const nearest = nearest_name(array, known);
  throw DataError(ErrorCode::missing_content, path_,
                  fmt::format("has no dataset \"{}\"{}", excerpt(array),
                              nearest         ? fmt::format("; did you mean \"{}\"?", *nearest)
                              : known.empty() ? "; it has no numbers at all"
                                              : "; it has " + quoted_list(known)));
}

std::vector<double> ListedArrays::read(std::string const& array) const {
  ListedArray const& found = find(array);
  std::size_t const bytes = checked_bytes(found.shape, sizeof(double), path_, array);
  require_memory(path_, "array \"" + excerpt(array) + '"', static_cast<double>(bytes));
  std::vector<double> values(bytes / sizeof(double));
  found.read(0, values);
  return values;
}

void ListedArrays::read_box(std::string const& array, std::vector<std::size_t> const& start,
                            std::vector<std::size_t> const& size, std::span<double> out) const {
  ListedArray const& found = find(array);
  std::vector<std::size_t> const& shape = found.shape;
  GLADSTONE_EXPECTS(start.size() == shape.size() && size.size() == shape.size());
  if (out.empty()) return;
  // Trailing axes that are read completely form one run of consecutive values together with the axis before them.
  std::size_t outer = shape.size(), run = 1, stride = 1;
  while (outer > 0) {
    --outer;
    run *= size[outer];
    if (size[outer] != shape[outer]) break;
  }
  std::vector<std::size_t> strides(shape.size());
  for (std::size_t axis = shape.size(); axis-- > 0; stride *= shape[axis]) strides[axis] = stride;
  for (std::size_t done = 0; done < out.size(); done += run) {
    std::size_t first = 0, number = done / run;
    for (std::size_t axis = shape.size(); axis-- > 0;) {
      std::size_t const at = axis >= outer ? 0 : number % size[axis];
      if (axis < outer) number /= size[axis];
      first += (start[axis] + at) * strides[axis];
    }
    found.read(first, out.subspan(done, run));
  }
}

std::string ListedArrays::attribute(std::string const& array, std::string const& name) const {
  if (name == "units") return find(array).units;
  return name == "MATLAB_class" ? find(array).matlab_class : "";
}

ReadValues load_once(std::function<ValueStore()> load) {
  auto const store = std::make_shared<std::optional<ValueStore>>();
  return [load = std::move(load), store](std::size_t first, std::span<double> out) {
    if (!*store) *store = load();
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = (**store)[first + i];
  };
}

std::size_t checked_bytes(std::vector<std::size_t> const& shape, std::size_t value_bytes, std::string const& path,
                          std::string const& name) {
  double const bytes =
      std::accumulate(shape.begin(), shape.end(), static_cast<double>(value_bytes),
                      [](double product, std::size_t size) { return product * static_cast<double>(size); });
  if (bytes > 1e15) {
    throw DataError(ErrorCode::damaged, path,
                    fmt::format("array \"{}\" has an implausible shape [{}]; it is damaged", excerpt(name),
                                fmt::join(shape, ", ")));
  }
  return static_cast<std::size_t>(bytes);
}

}  // namespace gladstone::inline files
