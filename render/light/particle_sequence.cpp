#include "render/light/particle_sequence.h"

#include <cmath>
#include <utility>

#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/base/random.h"
#include "render/light/particle_motion.h"

namespace gladstone::inline light {
namespace {

/// Returns the seed of the particles that are drawn in a frame.
std::uint64_t drawing_seed(std::uint64_t seed, std::size_t frame) {
  return frame == 0 ? seed : mix64(mix64(seed + 0x8cb92ba72f3d8dd7ULL) + frame * 0x9e3779b97f4a7c15ULL);
}

}  // namespace

ParticleSequence::ParticleSequence(ParticleSetup setup, double count, FlowSetup flow, LaserSheet<double> const& sheet,
                                   double tolerance)
    : setup_(std::move(setup)), count_(count), flow_(std::move(flow)), sheet_(sheet), tolerance_(tolerance) {
  start();
}

void ParticleSequence::start() {
  frame_ = 0;
  if (setup_.count == ParticleCount::file) {
    Particles read = read_particles(setup_, flow_, sheet_, tolerance_);
    now_ = {std::move(read.place[0]), std::move(read.diameter)};
    path_ = read.path;
    return;
  }
  now_ = draw(0, Region::volume);
  path_ = plan_paths(setup_, flow_, now_.place, now_.diameter, flow_.dt, tolerance_);
}

ParticleSequence::Places ParticleSequence::draw(std::size_t frame, Region region) const {
  Vec3d const volume = *setup_.volume;
  // a margin for a whole interval on both sides; motion_margin() is for half an interval on one side
  Vec3d const wider = volume + 4.0 * motion_margin(flow_, volume, setup_.center);
  double const share = wider.x * wider.y * wider.z / (volume.x * volume.y * volume.z);
  auto const drawn = static_cast<std::size_t>(std::llround(count_ * share * draws_per_particle(setup_, flow_)));
  std::uint64_t const seed = drawing_seed(setup_.seed, frame);
  Places all{std::vector<Vec3d>(drawn), draw_diameters(setup_.diameter, seed, drawn)};
  std::vector<char> wanted(drawn);
  parallel_chunks(drawn, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      KeyedEngine engine(seed, RandomStream::particles, i);
      double const x = to_unit(engine()) - 0.5, y = to_unit(engine()) - 0.5, z = to_unit(engine()) - 0.5;
      Vec3d const at = setup_.center + Vec3d{x * wider.x, y * wider.y, z * wider.z};
      all.place[i] = at;
      bool const here = is_inside_volume(setup_, at) == (region == Region::volume);
      wanted[i] = here && crowds_here(flow_.flow, at, setup_.response_time(all.diameter[i]), engine) ? 1 : 0;
    }
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < drawn; ++i) {
    if (wanted[i] == 0) continue;
    all.place[kept] = all.place[i];
    all.diameter[kept++] = all.diameter[i];
  }
  all.place.resize(kept);
  all.diameter.resize(kept);
  return all;
}

Particles ParticleSequence::move() const {
  Places from = now_;
  if (setup_.count != ParticleCount::file) {
    Places const around = draw(frame_, Region::surroundings);
    from.place.insert(from.place.end(), around.place.begin(), around.place.end());
    from.diameter.insert(from.diameter.end(), around.diameter.begin(), around.diameter.end());
  }
  Particles particles;
  particles.path = path_;
  particles.resize(from.place.size());
  particles.place[0] = std::move(from.place);
  particles.diameter = std::move(from.diameter);
  parallel_chunks(particles.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ParticleVelocity const velocity = particle_velocity(setup_, flow_, particles.diameter[i]);
      particles.place[1][i] = moved(velocity, particles.place[0][i], flow_.dt, path_.steps);
    }
  });
  return particles;
}

void ParticleSequence::advance(Particles const& both) {
  now_ = {};
  for (std::size_t i = 0; i < both.size(); ++i) {
    if (!is_inside_volume(setup_, both.place[1][i])) continue;
    now_.place.push_back(both.place[1][i]);
    now_.diameter.push_back(both.diameter[i]);
  }
  ++frame_;
}

Particles ParticleSequence::pair(std::size_t number) {
  if (number < frame_) start();
  while (frame_ < number) {
    throw_if_interrupted();
    advance(move());
  }
  Particles particles = move();
  light_particles(setup_, sheet_, particles);
  std::size_t lit = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (particles.photons[0][i] > 0 || particles.photons[1][i] > 0) particles.copy(i, lit++);
  }
  particles.resize(lit);
  particles.outside_flow = count_outside(flow_, particles);
  return particles;
}

}  // namespace gladstone::inline light
