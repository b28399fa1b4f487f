#include "render/light/flow.h"

#include <cmath>
#include <string>
#include <vector>

namespace gladstone::inline light {
namespace {

template <class... Kinds>
std::vector<std::string> kind_words(FlowKinds<Kinds...>) {
  return {Kinds::kind...};
}

/// Reads the kind with the given name. @pre `word` is the name of one of the kinds
template <class... Kinds>
void read_kind(FlowKinds<Kinds...>, std::string const& word, SetupTable& table, FlowSetup& setup) {
  auto const read = [&]<class Kind>(Kind const*) {
    if (word != Kind::kind) return;
    if constexpr (requires { Kind::read(table, setup); }) {
      setup.flow.kind = Kind::read(table, setup);
    } else {
      setup.flow.kind = Kind::read(table);
    }
  };
  (read(static_cast<Kinds const*>(nullptr)), ...);
}

}  // namespace

FlowSetup read_flow_setup(SetupTable table, std::optional<ShockPlane> const& shock, std::optional<double> dt) {
  FlowSetup setup;
  setup.shock = shock;
  std::string const word = table.kind_word("kind", UniformFlow::kind, kind_words(AllFlows{}));
  read_kind(AllFlows{}, word, table, setup);
  Vec3d const fallback = word == UniformFlow::kind ? Vec3d{10, 0, 0} : Vec3d{};
  setup.flow.uniform = table.quantities("velocity_m_s", fallback, 1.0, {-1e9, 1e9});
  if (shock && word == NormalShockFlow::kind) {
    Vec3d const normal{std::cos(shock->tilt), 0, std::sin(shock->tilt)};
    if (std::abs(dot(setup.flow.uniform, normal)) > 1e-9 * length(setup.flow.uniform)) {
      table.problem("velocity_m_s",
                    "has a component normal to the shock front (which is at rest while gas crosses it at "
                    "medium.field.mach); give a velocity parallel to the front");
    }
  }
  if (dt) {
    table.refuse("dt_us", "conflicts with sequence.dt_us (both set the time between the frames); remove it");
    setup.dt = *dt;
  } else {
    setup.dt = table.quantity("dt_us", setup.dt, unit::microsecond, Range::positive(1e12));
  }
  return setup;
}

Warnings load_flow(FlowSetup& setup) {
  if (!setup.file || setup.owner) return {};
  LoadedVelocity loaded = load_velocity(*setup.file);
  setup.owner = std::move(loaded.coefficients);
  setup.flow.kind = loaded.flow;
  return loaded.warnings;
}

bool velocity_known(FlowSetup const& setup, Vec3d place) {
  return setup.flow.kind.visit([place](auto const& held) {
    if constexpr (requires { held.covers(place); }) return held.covers(place);
    return true;
  });
}

}  // namespace gladstone::inline light
