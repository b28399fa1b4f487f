#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "render/base/warning.h"
#include "render/optics/element_kinds.h"
#include "render/optics/lens_setup.h"

namespace gladstone::inline optics {

template <class List>
struct AnyElementOf;
template <class... Kinds>
struct AnyElementOf<ElementKinds<Kinds...>> {
  using Type = std::variant<Kinds...>;
};

/// An optical element besides the lens, of any kind. The properties are those of element_kinds.h, with defaults for
/// optional ones.
class OpticalElement {
 public:
  using Held = AnyElementOf<AllElements>::Type;

  template <class Kind>
  requires std::is_constructible_v<Held, Kind> OpticalElement(Kind const& kind) : held_(kind) {}

  /// Returns the element if it is of a kind, else null.
  template <class Kind>
  Kind const* get() const {
    return std::get_if<Kind>(&held_);
  }

  std::string_view kind() const;
  ElementSide side() const;
  Pose<double> pose() const;
  double thickness() const;
  double shift() const;
  bool deflects() const;
  bool divides_light() const;
  double to_sensor() const;
  /// Returns the f-number of the images that the element forms; 0 if it forms none.
  double image_f_number() const;
  std::optional<Warning> imaging_warning(ImagingGeometry const& imaging, double f_number) const;

  /// Name of the glass; null if the element is not made of glass.
  std::string const* glass() const;
  void set_glass(double index, double absorption);

  template <class Add>
  void add_surfaces(Pose<double> const& at, bool fresnel, Add const& add) const {
    std::visit([&](auto const& held) { held.add_surfaces(at, fresnel, add); }, held_);
  }

 private:
  Held held_;
};

/// Returns the name of an element in messages: its kind, and its number among those of its kind if these can be several
/// ("window 2").
std::string element_name(std::vector<OpticalElement> const& elements, std::size_t index);

/// Table of a setup that describes an optical element.
struct ElementTable {
  SetupTable table;
  std::string kind;  ///< kind that the table implies; empty: given by its key
};

/// Returns the tables of all optical elements: those of one kind ([[window]], [camera.lenslets]), then [[element]].
std::vector<ElementTable> element_tables(SetupTable root, SetupTable camera);

/// Reads the tables. Elements on one side of the medium are in the order of the light path. Indices of glasses are set
/// later, when the wavelength is known.
std::vector<OpticalElement> read_elements(std::vector<ElementTable> const& tables);

}  // namespace gladstone::inline optics
