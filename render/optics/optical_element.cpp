#include "render/optics/optical_element.h"

namespace gladstone {
namespace {

template <class... Kinds>
std::vector<std::string> kind_words(ElementKinds<Kinds...>) {
  return {Kinds::kind...};
}

void append_root_tables(char const* name, char const* kind, SetupTable& root, std::vector<ElementTable>& tables) {
  for (SetupTable& table : root.tables(name)) {
    table.mark_as_read("cameras");  // the cameras that look through it, in setups with several
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
  return std::visit(
      [](auto const& held) {
        if constexpr (requires { held.pose(); }) return held.pose();
        return Pose<double>{};
      },
      held_);
}

double OpticalElement::thickness() const {
  return std::visit(
      [](auto const& held) {
        if constexpr (requires { held.thickness; }) return held.thickness;
        return 0.0;
      },
      held_);
}

double OpticalElement::shift() const {
  return std::visit(
      [](auto const& held) {
        if constexpr (requires { held.shift(); }) return held.shift();
        return 0.0;
      },
      held_);
}

bool OpticalElement::deflects() const {
  return std::visit(
      [](auto const& held) {
        if constexpr (requires { held.deflects(); }) return held.deflects();
        return false;
      },
      held_);
}

bool OpticalElement::divides_light() const {
  return std::visit(
      [](auto const& held) {
        return requires { held.divides_light; };
      },
      held_);
}

double OpticalElement::to_sensor() const {
  return std::visit(
      [](auto const& held) {
        if constexpr (requires { held.to_sensor; }) return held.to_sensor;
        return 0.0;
      },
      held_);
}

double OpticalElement::image_f_number() const {
  return std::visit(
      [](auto const& held) {
        if constexpr (requires { held.image_f_number(); }) return held.image_f_number();
        return 0.0;
      },
      held_);
}

std::string OpticalElement::imaging_warning(ImagingGeometry const& imaging, double f_number) const {
  return std::visit(
      [&](auto const& held) {
        if constexpr (requires { held.imaging_warning(imaging, f_number); })
          return held.imaging_warning(imaging, f_number);
        return std::string();
      },
      held_);
}

std::string const* OpticalElement::glass() const {
  return std::visit(
      [](auto const& held) -> std::string const* {
        if constexpr (requires { held.glass; }) return &held.glass;
        return nullptr;
      },
      held_);
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

}  // namespace gladstone
