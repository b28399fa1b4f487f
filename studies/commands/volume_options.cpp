#include "studies/commands/volume_options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <system_error>

#include "render/base/error.h"
#include "render/base/units.h"

namespace gladstone::inline commands {

VolumeSupport parse_support(std::string const& text) {
  std::size_t const colon = text.find(':');
  std::string const shape = text.substr(0, colon);
  if (colon != std::string::npos && (shape == "sphere" || shape == "cylinder")) {
    double radius_mm = 0.0;
    char const *first = text.data() + colon + 1, *last = text.data() + text.size();
    auto const [rest, error] = std::from_chars(first, last, radius_mm);
    if (error == std::errc() && rest == last && radius_mm > 0.0 && std::isfinite(radius_mm))
      return {shape == "sphere" ? VolumeSupport::Shape::sphere : VolumeSupport::Shape::cylinder, radius_mm * unit::mm};
  }
  throw SetupError({SetupProblem{
      "--support", fmt::format("expected sphere:MM or cylinder:MM with a positive radius, got \"{}\"", text)}});
}

}  // namespace gladstone::inline commands
