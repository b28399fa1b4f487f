#include "render/scene/particle_scene.h"
#include "render/scene/source_kind.h"

namespace gladstone::inline scene {
namespace {

/// Returns the memory of particles, of the medium at the second pulse, and of the velocity field.
std::vector<MemoryRequirement> memory_with_particles(Setup const& setup) {
  std::vector<MemoryRequirement> needs{particle_memory(setup)};
  if (setup.medium.second_field) {
    double const bytes = static_cast<double>(medium_bytes_needed(select_second_pulse(setup.medium)));
    needs.push_back({"medium.second_field.file", "second field", bytes});
  }
  if (std::optional<VelocityFile> const& file = setup.piv->flow.file) {
    needs.push_back({"flow.file", "velocity", velocity_bytes(*file)});
  }
  return needs;
}

std::size_t particles_in_scene(Scene const& scene) { return scene.particles.size(); }

Vec3d place_of_particle(Scene const& scene, std::size_t particle, std::size_t frame) {
  return scene.particles.place[frame][particle];
}

bool is_particle_in_view(Scene const& scene, std::size_t particle) {
  auto const pixel = scene.camera.project(scene.particles.place[0][particle]);
  return pixel && scene.camera.sensor.covers(*pixel);
}

std::size_t retain_particles(Scene& scene, std::function<bool(Vec2d pixel)> const& near) {
  std::size_t lit = 0;
  Particles& particles = scene.particles;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    auto const pixel = scene.camera.project(particles.place[0][i]);
    bool const retained = scene.setup.divides_light() || (pixel && near(*pixel));
    if (!retained) particles.photons[0][i] = particles.photons[1][i] = 0;
    if (particles.photons[0][i] > 0 || particles.photons[1][i] > 0) ++lit;
  }
  return lit;
}

}  // namespace

constinit SourceKind const particle_sources{.one = "particle",
                                            .many = "particles",
                                            .seed_table = "particles",
                                            .on_target = false,
                                            .in_photons = true,
                                            .memory = memory_with_particles,
                                            .add = add_particles,
                                            .count = particles_in_scene,
                                            .place = place_of_particle,
                                            .in_view = is_particle_in_view,
                                            .retain = retain_particles};

}  // namespace gladstone::inline scene
