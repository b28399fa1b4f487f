#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/one_of.h"
#include "render/base/warning.h"
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

/// Keeps nvcc from inlining all flows wherever a kernel evaluates one, which takes a minute to compile.
#if defined(__CUDACC__)
#define GLADSTONE_FLOW_CALL __noinline__
#else
#define GLADSTONE_FLOW_CALL
#endif

namespace gladstone::inline light {

template <class... Kinds>
struct FlowKinds {};

/// List of all velocity fields. Each is a struct with `kind` (its name in a setup), read(SetupTable&) or
/// read(SetupTable&, FlowSetup&), and operator()(p) -> velocity [m/s], in a separate file. A field with closed-form
/// particle paths also has moved(p, time, tau) and the seeding functions of NormalShockFlow.
using AllFlows = FlowKinds<UniformFlow, ShearFlow, RotationFlow, LambOseenFlow, RankineFlow, TaylorGreenFlow,
                           StagnationFlow, JetFlow, FileFlow, NormalShockFlow>;

template <class List>
struct AnyFlowOf;
template <class... Kinds>
struct AnyFlowOf<FlowKinds<Kinds...>> {
  using Type = OneOf<Kinds...>;
};

/// Steady velocity field: one of the kinds plus a uniform velocity. Trivially copyable.
struct Flow {
  AnyFlowOf<AllFlows>::Type kind = UniformFlow{};
  Vec3d uniform{};  ///< uniform velocity added to the field [m/s]

  std::string_view kind_word() const {
    return kind.visit([]<class Held>(Held const&) { return std::string_view(Held::kind); });
  }
  /// Returns the fluid velocity [m/s] at a point p [m].
  template <class T>
  GLADSTONE_HD GLADSTONE_FLOW_CALL Vec3<T> operator()(Vec3<T> const& p) const {
    Vec3<T> const own = kind.visit([&p](auto const& held) { return held(p); });
    return {own.x + T(uniform.x), own.y + T(uniform.y), own.z + T(uniform.z)};
  }
};

/// Table [flow] of a setup, in SI: velocity field and time between the laser pulses.
struct FlowSetup {
  Flow flow;
  double dt = 10e-6;                                ///< time between the laser pulses [s]
  std::optional<ShockPlane> shock;                  ///< shock front of the medium, if the medium has one
  std::optional<VelocityFile> file;                 ///< keys of a field of kind "file"
  std::shared_ptr<std::vector<float> const> owner;  ///< memory of the coefficients; null before load_flow()
};

/// Reads table [flow].
/// @param shock  shock front of a medium of kind normal_shock
/// @param dt     time between the frames of a sequence [s], in place of the key dt_us, which is then refused
FlowSetup read_flow_setup(SetupTable table, std::optional<ShockPlane> const& shock = std::nullopt,
                          std::optional<double> dt = std::nullopt);

/// Loads the velocity file of a field of kind "file", which has zero velocity until then. Does nothing for other kinds.
/// @return warnings about assumptions made in reading the file
/// @throws DataError
Warnings load_flow(FlowSetup& setup);

/// Returns false if a point [m] is outside the velocity field of a file, where the velocity is extrapolated.
bool velocity_known(FlowSetup const& setup, Vec3d place);

}  // namespace gladstone::inline light
