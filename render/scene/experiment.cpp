#include "render/scene/experiment.h"

#include "render/scene/setup.h"

namespace gladstone::inline scene {

Experiment const& find_experiment(std::string const& name) {
  for (Experiment const* one : all_experiments)
    if (name == one->name) return *one;
  return bos_experiment;
}

Experiment const& Setup::experiment() const {
  if (piv) return piv_experiment;
  return planes.empty() ? bos_experiment : calibration_experiment;
}

bool Setup::has_ideal_particles() const { return piv && piv->particles.scattering == ParticleScattering::gaussian; }

}  // namespace gladstone::inline scene
