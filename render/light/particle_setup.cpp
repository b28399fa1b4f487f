#include "render/light/particle_setup.h"

#include <fmt/format.h>

#include <array>
#include <limits>

#include "render/base/units.h"
#include "render/light/existing_file.h"
#include "render/light/particle_material.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline light {
namespace {

constexpr double most_particles = 4e9;
constexpr double widest_um = 1e4;  // maximum diameter [um]

void read_count(SetupTable& table, ParticleSetup& setup) {
  std::array<char const*, 4> const keys{"number", "per_mm3", "per_pixel", "file"};
  std::string chosen = "number";
  bool found = false;
  for (char const* const key : keys) {
    if (!table.has(key)) continue;
    if (found)
      table.refuse(key, fmt::format("conflicts with {} (both set the number of particles); remove one", chosen));
    if (!found) chosen = key;
    found = true;
  }
  if (chosen == "number") {
    setup.amount = table.number("number", setup.amount, Range::at_least(1, most_particles));
  } else if (chosen == "per_mm3") {
    setup.count = ParticleCount::per_mm3;
    setup.amount = table.number("per_mm3", 10, Range::positive(1e9));
  } else if (chosen == "per_pixel") {
    setup.count = ParticleCount::per_pixel;
    setup.amount = table.number("per_pixel", 0.05, Range::positive(100));
  } else {
    setup.count = ParticleCount::file;
    setup.file = existing_file(table);
  }
}

DiameterSetup read_diameter(SetupTable& table) {
  DiameterSetup setup;
  Range const size = Range::positive(widest_um);
  if (!table.is_table("diameter_um")) {
    setup.middle = table.quantity("diameter_um", setup.middle, unit::micrometre, size);
    return setup;
  }
  SetupTable spread = table.table("diameter_um");
  std::string const kind = spread.kind_word("kind", "lognormal", {"lognormal", "normal", "table"});
  if (kind == "lognormal") {
    setup.spread = DiameterSpread::lognormal;
    setup.middle = spread.quantity("median_um", setup.middle, unit::micrometre, size);
    setup.width = spread.number("sigma", 0.3, Range::at_least(0, 3));
  } else if (kind == "normal") {
    setup.spread = DiameterSpread::normal;
    setup.middle = spread.quantity("mean_um", setup.middle, unit::micrometre, size);
    setup.width = spread.number("std_um", 0.1, Range::at_least(0, widest_um)) * unit::micrometre;
    if (setup.width > setup.middle / 3) {
      spread.problem("std_um",
                     "is more than a third of mean_um (at least one in a thousand diameters would be negative); use a "
                     "smaller one, or kind = \"lognormal\"");
    }
  } else {
    setup.spread = DiameterSpread::table;
    setup.file = existing_file(spread);
  }
  return setup;
}

}  // namespace

ParticleSetup read_particle_setup(SetupTable table, double wavelength) {
  ParticleSetup setup;
  read_count(table, setup);
  bool const listed = setup.count == ParticleCount::file;
  if (!listed || table.has("volume_mm")) {
    auto const size = table.numbers("volume_mm", {40, 40, 3}, 3, Range::positive(1e6));
    setup.volume = size.size() == 3 ? Vec3d{size[0], size[1], size[2]} * unit::millimetre : Vec3d{1, 1, 1};
  }
  setup.center = table.quantities("center_mm", setup.center, unit::millimetre, {-1e6, 1e6});
  if (listed) {
    table.refuse("diameter_um", "conflicts with file (which gives the diameter of each particle); remove it");
  } else {
    setup.diameter = read_diameter(table);
  }
  setup.scattering = table.choice("scattering", setup.scattering,
                                  {{"mie", ParticleScattering::mie},
                                   {"lambert", ParticleScattering::lambert},
                                   {"gaussian", ParticleScattering::gaussian}});
  setup.index = read_particle_index(table, wavelength);
  if (table.has("density_kg_m3")) {
    setup.density = table.number("density_kg_m3", 1000.0, Range::positive(1e6));
    setup.viscosity = table.number("viscosity_pa_s", setup.viscosity, Range::positive(1e6));
  } else {
    table.refuse(
        "viscosity_pa_s",
        "applies only to particles with lag, for which density_kg_m3 is given; add density_kg_m3, or remove this key");
  }
  setup.seed = static_cast<std::uint64_t>(
      table.integer("seed", static_cast<long long>(setup.seed), 0, std::numeric_limits<long long>::max()));
  return setup;
}

}  // namespace gladstone::inline light
