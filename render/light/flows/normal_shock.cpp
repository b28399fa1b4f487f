#include "render/light/flows/normal_shock.h"

#include "render/base/units.h"
#include "render/light/flow.h"

namespace gladstone::inline light {
namespace {

constexpr double gas_constant_air = 287.05287;  // [J/(kg K)], ISO 2533 (1975)

}  // namespace

NormalShockFlow NormalShockFlow::read(SetupTable& table, FlowSetup& setup) {
  NormalShockFlow flow;
  double const temperature = table.number("upstream_temperature_k", 293.15, Range::positive(1e5));
  if (!setup.shock) {
    table.problem("kind",
                  "is \"normal_shock\", but the medium has no shock (flow and medium share the front); set "
                  "medium.field.kind = \"normal_shock\", or choose another flow");
    flow.upstream = flow.downstream = 1;
    return flow;
  }
  flow.upstream = setup.shock->mach * std::sqrt(constant::gamma_air * gas_constant_air * temperature);
  flow.downstream = flow.upstream / setup.shock->density_ratio;
  flow.position = setup.shock->position;
  flow.normal_x = std::cos(setup.shock->tilt);
  flow.normal_z = std::sin(setup.shock->tilt);
  return flow;
}

double NormalShockFlow::way_after(double time, double tau) const {
  if (time <= 0) return upstream * time;
  double const relaxed = tau > 0 ? -tau * std::expm1(-time / tau) : 0;
  return downstream * time + (upstream - downstream) * relaxed;
}

double NormalShockFlow::time_for(double way, double tau) const {
  if (way <= 0) return way / upstream;
  if (!(tau > 0)) return way / downstream;
  // the distance is a concave function of time: starting below the root, Newton's iteration increases monotonically and
  // ends when rounding stops the increase
  double time = way / upstream;
  while (true) {
    double const speed = downstream + (upstream - downstream) * std::exp(-time / tau);
    double const next = time + (way - way_after(time, tau)) / speed;
    if (!(next > time)) return time;
    time = next;
  }
}

Vec3d NormalShockFlow::moved(Vec3d p, double time, double tau) const {
  double const s = distance(p), way = way_after(time_for(s, tau) + time, tau) - s;
  return p + Vec3d{way * normal_x, 0, way * normal_z};
}

double NormalShockFlow::crowding(Vec3d p, double tau) const {
  double const s = distance(p);
  if (s < 0) return 1;
  double const left = tau > 0 ? std::exp(-time_for(s, tau) / tau) : 0;
  return upstream / (downstream + (upstream - downstream) * left);
}

// Integrates u_1 / v along X, which gives u_1 times the transit time over the normal's x component, and averages over
// Z.
double NormalShockFlow::mean_crowding(Vec3d volume, Vec3d center, double tau) const {
  constexpr int layers = 256;
  double sum = 0;
  for (int k = 0; k < layers; ++k) {
    Vec3d const middle = center + Vec3d{0, 0, volume.z * ((k + 0.5) / layers - 0.5)}, half{volume.x / 2, 0, 0};
    double const time = time_for(distance(middle + half), tau) - time_for(distance(middle - half), tau);
    sum += upstream * time / (normal_x * volume.x);
  }
  return sum / layers;
}

}  // namespace gladstone::inline light
