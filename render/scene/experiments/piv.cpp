#include <fmt/format.h>

#include <optional>
#include <utility>

#include "render/base/units.h"
#include "render/scene/cross_check.h"
#include "render/scene/cross_check_particles.h"
#include "render/scene/setup.h"

namespace gladstone::inline scene {
namespace {

/// Reads table [sequence]; nullopt if it is absent.
std::optional<SequenceSetup> read_particle_sequence(SetupTable table) {
  if (!table.present()) return std::nullopt;
  SequenceSetup setup;
  setup.consecutive = piv_experiment.consecutive_frames;
  setup.frames = static_cast<std::size_t>(table.required_integer("frames", 2, max_sequence_frames));
  setup.dt = table.required_number("dt_us", Range::positive(1e12)) * unit::microsecond;
  auto const first = static_cast<long long>(piv_experiment.first_pair());
  setup.pair = static_cast<std::size_t>(table.integer("pair", first, first, max_sequence_frames));
  table.refuse("files", "applies to BOS only (the particles of PIV move along [flow]); remove it");
  if (setup.pair + 1 >= setup.frames) {
    table.problem("pair", fmt::format("exceeds the last pair, {}, of {} frames (pairs are counted from 0); choose a "
                                      "smaller one, or more frames",
                                      setup.frames - 2, setup.frames));
  }
  return setup;
}

/// Reports pulses that differ, although every frame is the second of one pair and the first of the next.
void check_particle_sequence(Setup const& setup, SetupTable root) {
  if (setup.medium.second_field) {
    root.table("medium").problem("second_field",
                                 "conflicts with [sequence] (in which every frame is the second of one pair and the "
                                 "first of the next); remove one");
  }
  LaserSetup const& laser = setup.piv->laser;
  for (auto const& [key, values] : {std::pair("offset_mm", laser.offset), std::pair("tilt_deg", laser.tilt)}) {
    if (values[0] == values[1]) continue;
    root.table("laser").problem(key,
                                "differs between the pulses, which [sequence] excludes (every frame is the second of "
                                "one pair and the first of the next); give one value twice");
  }
}

/// Returns the shock front of a medium of kind normal_shock, for the flow.
std::optional<ShockPlane> shock_plane(FieldSetup const& field) {
  auto const* const shock = field.closed_form<NormalShock<double>>();
  if (!shock) return std::nullopt;
  return ShockPlane{shock->mach, shock_density_ratio(shock->mach, constant::gamma_air), shock->position, shock->tilt};
}

void read_piv_z_d(Setup& setup, SetupTable geometry) {
  geometry.refuse("z_d_mm",
                  "applies to BOS only (for PIV, z_a_mm is the distance to the origin, and laser.center_mm positions "
                  "the sheet); remove it");
  setup.z_d = 0;
}

void read_piv(Setup& setup, SetupTable root) {
  setup.sequence = read_particle_sequence(root.table("sequence"));
  PivSetup piv;
  piv.laser = read_laser_setup(root.table("laser"), setup.medium.wavelength);
  piv.particles = read_particle_setup(root.table("particles"), piv.laser.wavelength);
  std::optional<double> const dt = setup.sequence ? std::optional(setup.sequence->dt) : std::nullopt;
  piv.flow = read_flow_setup(root.table("flow"), shock_plane(setup.medium.field), dt);
  if (setup.medium.second_field && piv.flow.flow.kind_word() == NormalShockFlow::kind) {
    root.table("medium").problem("second_field",
                                 "conflicts with a flow of kind \"normal_shock\", which is steady; remove one");
  }
  setup.piv = piv;
  root.refuse("target", "applies to BOS only (the sources of PIV are [particles]); remove it");
  root.refuse("calibration", "does not apply to PIV (it requires experiment = \"calibration\"); remove it");
  root.refuse("light", "applies to BOS only (in PIV, [laser] defines the light); remove it");
  if (setup.sequence) check_particle_sequence(setup, root);
}

void cross_check_piv(Setup const& setup, SetupTable root, Warnings& warnings) {
  cross_check_medium(setup, root, warnings);
  cross_check_spot(setup, root);
  cross_check_particles(setup, std::move(root), warnings);
}

}  // namespace

constinit Experiment const piv_experiment{.name = "piv",
                                          .sources = particle_sources,
                                          .focus_word = "sheet",
                                          .measures_density = false,
                                          .correlated = true,
                                          .medium_in_first_frame = true,
                                          .consecutive_frames = true,
                                          .reason_for_rays = "particles are not flat dots",
                                          .read_z_d = read_piv_z_d,
                                          .read = read_piv,
                                          .cross_check = cross_check_piv};

}  // namespace gladstone::inline scene
