#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/one_of.h"
#include "render/light/flows/file.h"
#include "render/light/flows/jet.h"
#include "render/light/flows/lamb_oseen.h"
#include "render/light/flows/normal_shock.h"
#include "render/light/flows/rankine.h"
#include "render/light/flows/rotation.h"
#include "render/light/flows/shear.h"
#include "render/light/flows/stagnation.h"
#include "render/light/flows/taylor_green.h"
#include "render/light/flows/uniform.h"
#include "render/light/velocity_file.h"

namespace gladstone {

template <class... Kinds>
struct FlowKinds {};

/// Every velocity field: a struct with `kind`, `read(SetupTable&)`, or `read(SetupTable&, FlowSetup&)` where it needs
/// more, and velocity by place, in a file of its own. Where particles' paths are known in closed form it has `moved`
/// and what goes with it (NormalShockFlow).
using AllFlows = FlowKinds<UniformFlow, ShearFlow, RotationFlow, LambOseenFlow, RankineFlow, TaylorGreenFlow,
                           StagnationFlow, JetFlow, FileFlow, NormalShockFlow>;

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

  std::string_view kind_word() const {
    return kind.visit([]<class Held>(Held const&) { return std::string_view(Held::kind); });
  }
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
  double dt = 10e-6;                                ///< between the pulses [s]
  std::optional<ShockPlane> shock;                  ///< of the medium, if it has one
  std::optional<VelocityFile> file;                 ///< of kind "file"
  std::shared_ptr<std::vector<float> const> owner;  ///< keeps the memory that the flow sees; null before load_flow()
};

/// @param shock the front of a medium of kind normal_shock
FlowSetup read_flow_setup(SetupTable table, std::optional<ShockPlane> const& shock = std::nullopt);

/// Reads the file of a flow of kind "file", which is at rest before; of others nothing happens.
/// @return what had to be assumed of the file; empty: nothing @throws DataError
std::string load_flow(FlowSetup& setup);

/// Whether the velocity is known at a place [m]: everywhere but beyond a file's field.
bool velocity_known(FlowSetup const& setup, Vec3d place);

}  // namespace gladstone
