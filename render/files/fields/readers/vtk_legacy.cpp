#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>

#include "render/base/error.h"
#include "render/base/nearest_name.h"
#include "render/base/text.h"
#include "render/files/fields/readers/vtk.h"
#include "render/files/fields/readers/vtk_legacy_array.h"
#include "render/files/fields/readers/vtk_numbers.h"
#include "render/files/fields/readers/vtk_source.h"
#include "render/files/fields/readers/word_cursor.h"
#include "render/files/input_file.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

/// Decodes a name, in which blanks and other characters are written as %20.
std::string decoded_name(std::string const& name) {
  std::string text;
  for (std::size_t i = 0; i < name.size(); ++i) {
    int code = 0;
    bool const coded = name[i] == '%' && i + 2 < name.size() &&
                       std::from_chars(&name[i + 1], &name[i + 1] + 2, code, 16).ptr == &name[i + 1] + 2;
    text += coded ? static_cast<char>(code) : name[i];
    if (coded) i += 2;
  }
  return text;
}

class LegacyReader {
 public:
  LegacyReader(std::string const& path, FieldSelection const& selection)
      : file_(std::make_shared<InputFile>(path, "a field file")), cursor_(*file_), selection_(selection) {
    if (!cursor_.line().starts_with("# vtk DataFile"))
      refuse(ErrorCode::wrong_format, "is not a legacy VTK file (it does not begin with # vtk)");
    cursor_.line();  // title
    std::string const encoding = lower_case(cursor_.word());
    if (encoding != "ascii" && encoding != "binary")
      refuse(ErrorCode::damaged, "is declared neither as ASCII nor as BINARY; copy it again");
    text_ = encoding == "ascii";
    read_grid();
    read_arrays();
  }

  VtkField field() && {
    std::vector<VtkLegacyArray> fitting;
    std::vector<std::string> names;
    for (VtkLegacyArray const& array : arrays_) {
      if (marks_ghosts(array.name) && array.name != selection_.dataset) continue;
      names.push_back(array.name);
      bool const fits = array.components == static_cast<std::uint64_t>(selection_.values);
      if (array.name == selection_.dataset && !fits) {
        refuse(ErrorCode::wrong_shape, fmt::format("data array \"{}\" has {} values per point, but {} are needed",
                                                   excerpt(array.name), array.components, selection_.values));
      }
      if (fits && (selection_.dataset.empty() || array.name == selection_.dataset)) fitting.push_back(array);
    }
    if (fitting.empty()) refuse(ErrorCode::missing_content, no_such_array(selection_, names));
    if (fitting.size() > 1 && selection_.dataset.empty()) {
      refuse(ErrorCode::undetermined, "has several such fields; select one with dataset = " + quoted_list(names));
    }
    VtkLegacyArray const& chosen = fitting.front();
    VtkField field{chosen.name, chosen.place, chosen.number.significant_bits, grid_, {}, {}};
    if (fitting.size() > 1)
      field.notes.push_back(
          {WarningCode::ignored, "", fmt::format("\"{}\" occurs twice; the first one is used", chosen.name)});
    field.load = [file = file_, chosen, text = text_] { return load_legacy_array(*file, chosen, text); };
    return field;
  }

 private:
  [[noreturn]] void refuse(ErrorCode code, std::string const& why) const { throw DataError(code, file_->path(), why); }

  template <class Number>
  Number number(std::string const& what) {
    std::string const word = cursor_.word();
    Number value{};
    auto const [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) {
      refuse(ErrorCode::syntax, fmt::format("{}: \"{}\" is not a number; copy it again", what, excerpt(word)));
    }
    return value;
  }

  VtkNumber number_type(std::string const& name) const {
    std::string const type = lower_case(name);
    auto const* const found = std::find_if(vtk_numbers.begin(), vtk_numbers.end(),
                                           [&type](VtkNumber const& one) { return lower_case(one.legacy) == type; });
    if (found == vtk_numbers.end())
      refuse(ErrorCode::wrong_type, fmt::format("has data of type \"{}\", which is not numeric", excerpt(name)));
    return *found;
  }

  void read_grid() {
    if (lower_case(cursor_.word()) != "dataset") refuse(ErrorCode::damaged, "has no line DATASET; copy it again");
    std::string const kind = lower_case(cursor_.word());
    bool const image = kind == "structured_points";
    if (!image && kind != "rectilinear_grid") {
      refuse(ErrorCode::unsupported,
             fmt::format("holds VTK's \"{}\" (fields on a regular grid are read, STRUCTURED_POINTS and "
                         "RECTILINEAR_GRID); resample it to an image",
                         excerpt(kind)));
    }
    for (std::string key = lower_case(cursor_.word());; key = lower_case(cursor_.word())) {
      if (key == "dimensions") {
        for (std::size_t i = 0; i < 3; ++i) {
          int const points = number<int>("DIMENSIONS");
          if (points < 1) refuse(ErrorCode::out_of_range, "DIMENSIONS must be positive");
          grid_.extent[2 * i + 1] = points - 1;
        }
        check_grid(grid_, selection_.values, file_->path());
      } else if (key == "origin") {
        for (double& value : grid_.origin) value = number<double>("ORIGIN");
      } else if (key == "spacing" || key == "aspect_ratio") {
        for (double& value : grid_.spacing) value = number<double>("SPACING");
      } else if (key.size() == 13 && key.ends_with("_coordinates") && key[0] >= 'x' && key[0] <= 'z') {
        read_coordinates(static_cast<std::size_t>(key[0] - 'x'));
      } else if (key == "field") {
        read_field(VtkPlace::points, false);
      } else if (key == "metadata") {
        skip_metadata();
      } else {
        next_key_ = key;
        break;
      }
    }
    check_grid(grid_, selection_.values, file_->path());
    if (!image &&
        std::any_of(grid_.coordinates.begin(), grid_.coordinates.end(), [](auto const& x) { return x.empty(); })) {
      refuse(ErrorCode::damaged, "has no coordinates of its RECTILINEAR_GRID; copy it again");
    }
  }

  void read_coordinates(std::size_t axis) {
    VtkLegacyArray array;
    array.name = fmt::format("{}_COORDINATES", "XYZ"[axis]);
    array.tuples = number<std::uint64_t>(array.name);
    array.number = number_type(cursor_.word());
    begin_data(array);
    ValueStore const values = load_legacy_array(*file_, array, text_);
    grid_.coordinates[axis].clear();
    for (std::size_t i = 0; i < values.size(); ++i) grid_.coordinates[axis].push_back(values[i]);
    skip_data(array);
  }

  std::uint64_t nodes(VtkPlace place) const {
    std::uint64_t all = 1;
    for (std::size_t i = 0; i < 3; ++i) all *= static_cast<std::uint64_t>(VtkGrid::count(grid_.extent, i, place));
    return all;
  }

  /// Reads the attributes of points and cells in sequence.
  void read_arrays() {
    std::optional<VtkPlace> place;
    for (std::string key = next_key_; !key.empty(); key = lower_case(cursor_.word())) {
      if (key == "point_data" || key == "cell_data") {
        place = key == "point_data" ? VtkPlace::points : VtkPlace::cells;
        std::uint64_t const there = number<std::uint64_t>(key);
        if (there != nodes(*place)) {
          refuse(ErrorCode::damaged,
                 fmt::format("has {} values in its {}, but its grid has {} {}; copy it again", there, key,
                             nodes(*place), *place == VtkPlace::points ? "points" : "cells"));
        }
      } else if (key == "metadata") {
        skip_metadata();
      } else if (!place) {
        refuse(ErrorCode::damaged,
               fmt::format("has \"{}\" instead of POINT_DATA or CELL_DATA; copy it again", excerpt(key)));
      } else if (!read_attribute(key, *place)) {
        return;  // the length of an unknown attribute is not defined, so that reading must stop here
      }
    }
  }

  /// Reads type and number of components of SCALARS, and skips a LOOKUP_TABLE that follows.
  void read_scalars(VtkLegacyArray& array) {
    array.number = number_type(cursor_.word());
    std::string const rest = trimmed(cursor_.line());
    if (!rest.empty() && std::from_chars(rest.data(), rest.data() + rest.size(), array.components).ec != std::errc()) {
      refuse(ErrorCode::syntax,
             fmt::format("SCALARS {}: \"{}\" is not a number of components", excerpt(array.name), excerpt(rest)));
    }
    std::string next(12, ' ');
    next.resize(file_->read(cursor_.place(), next.data(), next.size()));
    if (lower_case(next) == "lookup_table") {
      cursor_.word();
      cursor_.word();
    } else {
      cursor_.go_to(cursor_.place() - 1);  // go back to the preceding line end
    }
  }

  /// Reads one attribute. @return false if it is unknown, so that the next one cannot be found
  bool read_attribute(std::string const& key, VtkPlace place) {
    if (key == "field") {
      read_field(place, true);
      return true;
    }
    VtkLegacyArray array;
    array.place = place;
    array.tuples = nodes(place);
    if (key == "lookup_table") {  // RGBA colours: four bytes each, or numbers in text
      cursor_.word();
      array.tuples = number<std::uint64_t>(key);
      array.components = 4;
      array.number = number_type(text_ ? "float" : "unsigned_char");
      begin_data(array);
      skip_data(array);
      return true;
    }
    array.name = decoded_name(cursor_.word());
    if (key == "scalars") {
      read_scalars(array);
    } else if (key == "vectors" || key == "normals") {
      array.number = number_type(cursor_.word());
      array.components = 3;
    } else if (key == "tensors") {
      array.number = number_type(cursor_.word());
      array.components = 9;
    } else if (key == "texture_coordinates") {
      array.components = number<std::uint64_t>(key);
      array.number = number_type(cursor_.word());
    } else if (key == "color_scalars") {
      array.components = number<std::uint64_t>(key);
      array.number = number_type(text_ ? "float" : "unsigned_char");
    } else {
      return false;
    }
    begin_data(array);
    skip_data(array);
    if (key != "color_scalars") arrays_.push_back(array);
    return true;
  }

  void read_field(VtkPlace place, bool kept) {
    cursor_.word();  // skip the name of the FIELD
    std::uint64_t const count = number<std::uint64_t>("FIELD");
    for (std::uint64_t i = 0; i < count; ++i) {
      VtkLegacyArray array;
      array.place = place;
      std::string const name = cursor_.word();
      if (lower_case(name) == "metadata") {
        skip_metadata();
        --i;
        continue;
      }
      if (name.empty())
        refuse(ErrorCode::damaged, "is cut short: a FIELD has fewer arrays than it declares; copy it again");
      array.name = decoded_name(name);
      array.components = number<std::uint64_t>("FIELD");
      array.tuples = number<std::uint64_t>("FIELD");
      array.number = number_type(cursor_.word());
      begin_data(array);
      skip_data(array);
      if (kept && array.tuples == nodes(place)) arrays_.push_back(array);
    }
  }

  /// Skips METADATA, which ends with an empty line.
  void skip_metadata() {
    cursor_.line();
    while (cursor_.peek() >= 0 && !trimmed(cursor_.line()).empty()) {
    }
  }

  void begin_data(VtkLegacyArray& array) {
    if (!text_) cursor_.line();
    array.begin = cursor_.place();
    double const values = static_cast<double>(array.components) * static_cast<double>(array.tuples);
    double const least = text_ ? 2 * values - 1 : values * static_cast<double>(array.number.bytes);
    if (least > static_cast<double>(file_->size() - std::min(file_->size(), array.begin)))
      refuse_incomplete(*file_, array);
  }

  void skip_data(VtkLegacyArray const& array) {
    if (!text_) {
      cursor_.go_to(array.begin + array.values() * array.number.bytes);
      return;
    }
    for (std::uint64_t i = 0; i < array.values(); ++i) {
      if (cursor_.word().empty()) refuse_incomplete(*file_, array);
    }
  }

  std::shared_ptr<InputFile> file_;
  WordCursor cursor_;
  FieldSelection const& selection_;
  bool text_ = false;
  VtkGrid grid_;
  std::string next_key_;
  std::vector<VtkLegacyArray> arrays_;
};

}  // namespace

std::unique_ptr<CheckedSource> open_vtk_legacy(std::string const& path, FieldSelection const& selection) {
  return make_vtk_source(path, LegacyReader(path, selection).field(), selection);
}

}  // namespace gladstone::inline files
