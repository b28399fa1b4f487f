#pragma once

#include "render/base/one_of.h"
#include "render/light/flows/jet.h"
#include "render/light/flows/lamb_oseen.h"
#include "render/light/flows/rankine.h"
#include "render/light/flows/rotation.h"
#include "render/light/flows/shear.h"
#include "render/light/flows/stagnation.h"
#include "render/light/flows/taylor_green.h"
#include "render/light/flows/uniform.h"

namespace gladstone {

template <class... Kinds>
struct FlowKinds {};

/// Every velocity field: a struct with `kind`, `read(SetupTable&)` and velocity by place, in a file of its own.
using AllFlows = FlowKinds<UniformFlow, ShearFlow, RotationFlow, LambOseenFlow, RankineFlow, TaylorGreenFlow,
                           StagnationFlow, JetFlow>;

template <class List>
struct AnyFlowOf;
template <class... Kinds>
struct AnyFlowOf<FlowKinds<Kinds...>> {
  using Type = OneOf<Kinds...>;
};

/// A steady velocity field: one of the kinds plus a uniform velocity. Trivially copyable.
struct Flow {
  AnyFlowOf<AllFlows>::Type kind = UniformFlow{};
  Vec3d uniform{};  ///< [m/s]

  /// u at p [m/s, m].
  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    Vec3<T> const own = kind.visit([&p](auto const& held) { return held(p); });
    return {own.x + T(uniform.x), own.y + T(uniform.y), own.z + T(uniform.z)};
  }
};

/// Table [flow] of a setup: what moves particles, and how long.
struct FlowSetup {
  Flow flow;
  double dt = 10e-6;  ///< between the pulses [s]
};

FlowSetup read_flow_setup(SetupTable table);

}  // namespace gladstone
