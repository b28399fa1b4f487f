#include "render/scene/experiment.h"

#include "render/scene/setup.h"
#include "render/setup/setup_node.h"

namespace gladstone::inline scene {

Experiment const& find_experiment(std::string const& name) {
  for (Experiment const* one : all_experiments)
    if (name == one->name) return *one;
  return *all_experiments.front();
}

Experiment const& find_experiment(SetupDocument const& setup) {
  SetupNode const* const name = setup.find({"experiment"});
  return find_experiment(name ? name->text : "");
}

Experiment const& Setup::experiment() const {
  if (piv) return piv_experiment;
  return planes.empty() ? bos_experiment : calibration_experiment;
}

bool Setup::has_ideal_particles() const { return piv && piv->particles.scattering == ParticleScattering::gaussian; }

}  // namespace gladstone::inline scene
