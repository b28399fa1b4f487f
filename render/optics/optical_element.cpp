#include "render/optics/optical_element.h"

namespace gladstone::inline optics {
namespace {

template <class... Kinds>
std::vector<std::string> kind_words(ElementKinds<Kinds...>) {
  return {Kinds::kind...};
}

void append_root_tables(char const* name, char const* kind, SetupTable& root, std::vector<ElementTable>& tables) {
  for (SetupTable& table : root.tables(name)) {
    table.mark_as_read("cameras");  // names of the cameras that look through the element, in setups with several
                                    // cameras
    tables.push_back({table, kind});
  }
}

/// Appends the tables of one kind that are not called [[element]].
template <class Kind>
void append_own_tables(SetupTable& root, SetupTable& camera, std::vector<ElementTable>& tables) {
  if constexpr (requires { Kind::root_table; }) {
    append_root_tables(Kind::root_table, Kind::kind, root, tables);
  }
  if constexpr (requires { Kind::camera_table; }) {
    if (SetupTable const table = camera.table(Kind::camera_table); table.present())
      tables.push_back({table, Kind::kind});
  }
}
template <class... Kinds>
void append_own_tables(SetupTable& root, SetupTable& camera, std::vector<ElementTable>& tables,
                       ElementKinds<Kinds...>) {
  (append_own_tables<Kinds>(root, camera, tables), ...);
}

/// Reads an element of the kind with the given name.
template <class... Kinds>
void append_element(std::string const& word, SetupTable& table, std::vector<OpticalElement>& elements,
                    ElementKinds<Kinds...>) {
  auto const read = [&]<class Kind>(Kind const*) {
    if (word == Kind::kind) elements.emplace_back(Kind::read(table));
  };
  (read(static_cast<Kinds const*>(nullptr)), ...);
}

/// Returns a property of an element; the fallback if its kind does not have the property.
template <class T, class Get>
T property_or(OpticalElement::Held const& element, T const& fallback, Get const& get) {
  return std::visit(
      [&](auto const& held) -> T {
        if constexpr (requires { get(held); })
          return get(held);
        else
          return fallback;
      },
      element);
}

}  // namespace

std::vector<ElementTable> element_tables(SetupTable root, SetupTable camera) {
  std::vector<ElementTable> tables;
  append_own_tables(root, camera, tables, AllElements{});
  append_root_tables("element", "", root, tables);
  return tables;
}

std::vector<OpticalElement> read_elements(std::vector<ElementTable> const& tables) {
  std::vector<OpticalElement> elements;
  std::vector<std::string> const words = kind_words(AllElements{});
  for (auto [table, kind] : tables) {
    if (kind.empty())
      kind = table.has("kind") ? table.kind_word("kind", words.front(), words) : table.required_word("kind", words);
    append_element(kind, table, elements, AllElements{});
  }
  return elements;
}

std::string_view OpticalElement::kind() const {
  return std::visit([](auto const& held) { return std::string_view(held.kind); }, held_);
}

ElementSide OpticalElement::side() const {
  return std::visit([](auto const& held) { return held.side; }, held_);
}

Pose<double> OpticalElement::pose() const {
  return property_or(held_, Pose<double>{}, [](auto const& held) -> decltype(held.pose()) { return held.pose(); });
}

double OpticalElement::thickness() const {
  return property_or(held_, 0.0, [](auto const& held) -> decltype(held.thickness) { return held.thickness; });
}

double OpticalElement::shift() const {
  return property_or(held_, 0.0, [](auto const& held) -> decltype(held.shift()) { return held.shift(); });
}

bool OpticalElement::deflects() const {
  return property_or(held_, false, [](auto const& held) -> decltype(held.deflects()) { return held.deflects(); });
}

bool OpticalElement::divides_light() const {
  return property_or(held_, false, [](auto const& held) -> decltype(held.divides_light) { return held.divides_light; });
}

double OpticalElement::to_sensor() const {
  return property_or(held_, 0.0, [](auto const& held) -> decltype(held.to_sensor) { return held.to_sensor; });
}

double OpticalElement::image_f_number() const {
  return property_or(held_, 0.0,
                     [](auto const& held) -> decltype(held.image_f_number()) { return held.image_f_number(); });
}

std::optional<Warning> OpticalElement::imaging_warning(ImagingGeometry const& imaging, double f_number) const {
  return property_or(held_, std::optional<Warning>(),
                     [&](auto const& held) -> decltype(held.imaging_warning(imaging, f_number)) {
                       return held.imaging_warning(imaging, f_number);
                     });
}

std::string const* OpticalElement::glass() const {
  std::string const* const none = nullptr;
  return property_or(held_, none, [](auto const& held) -> decltype(&held.glass) { return &held.glass; });
}

void OpticalElement::set_glass(double index, double absorption) {
  std::visit(
      [&](auto& held) {
        if constexpr (requires { held.glass; }) {
          held.index = index;
          held.absorption = absorption;
        }
      },
      held_);
}

std::string element_name(std::vector<OpticalElement> const& elements, std::size_t index) {
  std::string const kind(elements[index].kind());
  if (elements[index].side() == ElementSide::image_plane) return kind;
  std::size_t number = 1;
  for (std::size_t i = 0; i < index; ++i) number += elements[i].kind() == kind ? 1 : 0;
  return kind + ' ' + std::to_string(number);
}

}  // namespace gladstone::inline optics
