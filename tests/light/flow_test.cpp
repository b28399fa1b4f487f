#include "render/light/flow.h"

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "render/base/units.h"
#include "render/light/flow_path.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

FlowSetup read_flow(std::string const& text) {
  SetupDocument document = SetupDocument::from_text(text, "flow.toml");
  FlowSetup const flow = read_flow_setup(document.root().table("flow"));
  document.finish();
  return flow;
}

FlowSetup flow_of(std::string const& kind, std::string const& keys) {
  return read_flow("[flow]\nkind = \"" + kind + "\"\n" + keys);
}

double distance(Vec3d a, Vec3d b) { return length(a - b); }

std::vector<FlowSetup> some_of_every_kind() {
  return {flow_of("uniform", "velocity_m_s = [3, -2, 1]"),
          flow_of("shear", "rate_1_s = 800"),
          flow_of("rotation", "rate_rad_s = 500"),
          flow_of("lamb_oseen", "circulation_m2_s = 0.3"),
          flow_of("rankine", "circulation_m2_s = -0.3\ncore_radius_mm = 4"),
          flow_of("taylor_green", "amplitude_m_s = 7"),
          flow_of("stagnation", "rate_1_s = 900"),
          flow_of("jet", "peak_m_s = 20\ndirection = [3, 4]")};
}

// All of these flows are incompressible: central differences of the velocity over 2 um result in a divergence that is
// negligible compared with the gradient. The third derivatives, at most 7 m/s over (3 mm)^3, cause an error of 1e-5
// 1/s.
TEST(Flow, OfEveryKindIsWithoutDivergence) {
  for (FlowSetup const& setup : some_of_every_kind()) {
    for (Vec3d const p : {Vec3d{1e-3, 2e-3, 0}, {-3e-3, 0.5e-3, 1e-3}, {6e-3, -7e-3, 0}}) {
      double const h = 1e-6;
      Flow const& u = setup.flow;
      double const divergence = (u(p + Vec3d{h, 0, 0}).x - u(p - Vec3d{h, 0, 0}).x + u(p + Vec3d{0, h, 0}).y -
                                 u(p - Vec3d{0, h, 0}).y + u(p + Vec3d{0, 0, h}).z - u(p - Vec3d{0, 0, h}).z) /
                                (2 * h);
      EXPECT_NEAR(divergence, 0, 1e-3);
    }
  }
}

// u_theta(r) = Gamma / (2 pi r) (1 - exp(-r^2 / r_c^2)); within a hundredth of the core radius, this is solid-body
// rotation to 5e-5.
TEST(LambOseen, TurnsAsItsFormula) {
  Flow const u = flow_of("lamb_oseen", "circulation_m2_s = 0.2\ncore_radius_mm = 5").flow;
  for (double const r : {1e-3, 5e-3, 30e-3}) {
    double const expected = 0.2 / (2 * pi * r) * (1 - std::exp(-std::pow(r / 5e-3, 2)));
    EXPECT_NEAR(u(Vec3d{0, r, 0}).x, -expected, 1e-12);
    EXPECT_NEAR(u(Vec3d{r, 0, 7}).y, expected, 1e-12);
  }
  EXPECT_NEAR(u(Vec3d{5e-5, 0, 0}).y, 0.2 / (2 * pi) * 5e-5 / 25e-6, 1e-4 * 0.064);
  EXPECT_EQ(length(u(Vec3d{})), 0);
}

// Solid-body rotation inside the core and a free vortex outside: r u_theta is Gamma / (2 pi) from the core radius on,
// and a quarter of it at half the core radius.
TEST(Rankine, IsSolidInsideAndFreeOutside) {
  Flow const u = flow_of("rankine", "circulation_m2_s = 0.2\ncore_radius_mm = 4").flow;
  double const at_core = 0.2 / (2 * pi);
  EXPECT_NEAR(2e-3 * u(Vec3d{2e-3, 0, 0}).y, at_core / 4, 1e-15);
  EXPECT_NEAR(4e-3 * u(Vec3d{4e-3, 0, 0}).y, at_core, 1e-15);
  EXPECT_NEAR(9e-3 * u(Vec3d{9e-3, 0, 0}).y, at_core, 1e-15);
}

// Pathlines of a rotation by an angle of 0.8: the error of n Runge-Kutta steps decreases as n^-4.
TEST(FlowPath, IsOfFourthOrder) {
  ParticleVelocity const u{flow_of("rotation", "rate_rad_s = 800").flow};
  Vec3d const start{5e-3, 0, 0}, end{5e-3 * std::cos(0.8), 5e-3 * std::sin(0.8), 0};
  double const coarse = distance(moved(u, start, 1e-3, 2), end), fine = distance(moved(u, start, 1e-3, 4), end);
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.15);
  EXPECT_LT(distance(moved(u, start, 1e-3, 64), end), 1e-11);
}

// Shear: the path x + rate y t is linear in time and exact up to rounding. Stagnation flow: the paths are x exp(a t), y
// exp(-a t), and sixteen steps of a dt = 0.05 have a relative error of 0.05^5 / 120 each.
TEST(FlowPath, FollowsShearAndStagnation) {
  ParticleVelocity const shear{flow_of("shear", "rate_1_s = 800").flow};
  EXPECT_LT(distance(moved(shear, {1e-3, 2e-3, 3e-3}, 1e-3, 3), {1e-3 + 0.8 * 2e-3, 2e-3, 3e-3}), 1e-17);
  ParticleVelocity const stagnation{flow_of("stagnation", "rate_1_s = 800").flow};
  Vec3d const end{1e-3 * std::exp(0.8), 2e-3 * std::exp(-0.8), 0};
  EXPECT_LT(distance(moved(stagnation, {1e-3, 2e-3, 0}, 1e-3, 16), end), 16 * std::pow(0.05, 5) / 120 * 4e-3);
}

// A vortex carries particles around at constant radius, by the angle u_theta t / r.
TEST(FlowPath, GoesRoundAVortex) {
  ParticleVelocity const u{flow_of("lamb_oseen", "circulation_m2_s = 0.2\ncore_radius_mm = 5").flow};
  double const r = 4e-3, angle = u({r, 0, 0}).y / r * 2e-4;
  Vec3d const end = moved(u, {r, 0, 0}, 2e-4, 16);
  EXPECT_LT(distance(end, {r * std::cos(angle), r * std::sin(angle), 0}), 1e-12);
}

// In solid-body rotation at the rate W, a heavy particle moves as exp(L t) with tau L^2 + L = i W. To first order in
// tau, L = i W + tau W^2, so that it spirals outwards. The next term, -2 i tau^2 W^3, is reported as neglected.
TEST(LaggingParticle, SpiralsOutOfARotation) {
  double const w = 500, tau = 2e-5, time = 1e-3, r = 5e-3;
  ParticleVelocity const v{flow_of("rotation", "rate_rad_s = 500").flow, tau, 1e-6};
  Vec3d const end = moved(v, {r, 0, 0}, time, 64);
  double const grown = r * std::exp(tau * w * w * time);
  EXPECT_LT(distance(end, {grown * std::cos(w * time), grown * std::sin(w * time), 0}), 1e-6 * r);
  // central differences with a rotation of 5e-4 per time step have a relative error of the square of that
  EXPECT_NEAR(length(v.neglected({r, 0, 0})), 2 * tau * tau * w * w * w * r, 1e-5 * 2 * tau * tau * w * w * w * r);
  // velocity to first order in tau, without the neglected term
  EXPECT_NEAR(length(v({r, 0, 0}) - Vec3d{tau * w * w * r, w * r, 0}), 0, 1e-6 * w * r);
}

/// Returns the flow through the front of a normal shock at Mach 2, inclined by 30 degrees, in air at 300 K.
FlowSetup shock_flow() {
  SetupDocument document =
      SetupDocument::from_text("kind = \"normal_shock\"\nupstream_temperature_k = 300", "flow.toml");
  return read_flow_setup(document.root(), ShockPlane{2, 8.0 / 3, 1e-3, 30 * unit::degree});
}

// Mach 2 at 300 K: u_1 = 2 sqrt(1.4 * 287.05287 * 300) = 694.4 m/s, and u_2 is 3/8 of it (NACA 1135, eq. 94: 6 M^2 /
// (M^2 + 5) = 8/3). A time t after crossing the front, a particle is at the distance x(t) = u_2 t + (u_1 - u_2) tau (1
// - exp(-t / tau)) behind it.
TEST(NormalShockFlow, SlowsParticlesDownExponentially) {
  FlowSetup const flow = shock_flow();
  double const u1 = 2 * std::sqrt(1.4 * 287.05287 * 300), u2 = u1 * 3 / 8, tau = 3e-6;
  Vec3d const normal{std::cos(pi / 6), 0, 0.5}, front{1e-3, 0, 0};
  EXPECT_LT(distance(flow.flow(front - 1e-4 * normal), u1 * normal), 1e-9);
  EXPECT_LT(distance(flow.flow(front + 1e-4 * normal), u2 * normal), 1e-9);
  for (double const lag : {0.0, tau}) {
    ParticleVelocity const v{flow.flow, lag, 1e-8};
    ASSERT_TRUE(v.exact());
    double const before = 2e-6;
    for (double const t : {1e-7, 1e-6, 5e-6, 40e-6}) {
      double const s = u2 * t + (u1 - u2) * lag * (lag > 0 ? 1 - std::exp(-t / lag) : 0.0);
      Vec3d const start = front - u1 * before * normal + Vec3d{0, 3e-3, 0};
      Vec3d const end = moved(v, start, before + t, 1);
      EXPECT_LT(distance(end, front + s * normal + Vec3d{0, 3e-3, 0}), 1e-15) << t << ' ' << lag;
      // backwards; rounding errors grow as exp(t / tau)
      EXPECT_LT(distance(moved(v, end, -before - t, 1), start), 1e-13);
    }
  }
}

// Continuity of the particles: the flux n v = n_1 u_1 is the same through any plane in front of and behind the shock. v
// is a difference of positions over 1 ns; its error is v' / 2 times that time, 3e-4.
TEST(NormalShockFlow, CrowdsParticlesAsContinuitySays) {
  FlowSetup const flow = shock_flow();
  auto const held = flow.flow.kind.visit([](auto const& one) {
    NormalShockFlow found;
    if constexpr (requires { one.fastest(); }) found = one;
    return found;
  });
  double const u1 = length(held.fastest()), tau = 3e-6;
  for (double const x : {-1e-3, 1.1e-3, 2e-3, 4e-3, 30e-3}) {
    Vec3d const p{x, 0, 0};
    double const v = distance(held.moved(p, 1e-9, tau), p) / 1e-9;
    EXPECT_NEAR(held.crowding(p, tau) * v, u1, 5e-4 * u1) << x;
  }
  EXPECT_NEAR(held.crowding({30e-3, 0, 0}, 0), 8.0 / 3, 1e-12);
  // a volume that the inclined front divides into halves: mean of both densities
  EXPECT_NEAR(held.mean_crowding({4e-3, 1e-3, 2e-3}, {1e-3, 0, 0}, 0), (1 + 8.0 / 3) / 2, 1e-9);
}

TEST(NormalShockFlow, SharesTheFrontOfTheMedium) {
  EXPECT_THAT([] { flow_of("normal_shock", ""); }, ThrowsSetupError(ErrorCode::invalid_value, "flow.kind"));
  EXPECT_EQ(error_of([] {
              SetupDocument document =
                  SetupDocument::from_text("kind = \"normal_shock\"\nvelocity_m_s = [1, 2, 0]", "flow.toml");
              read_flow_setup(document.root(), ShockPlane{2, 8.0 / 3, 0, 0});
              document.finish();
            }),
            "invalid_value at flow.toml:2:1");
}

TEST(FlowSetup, RefusesWhatMovesNothing) {
  using testing::HasSubstr;
  using testing::ThrowsMessage;
  EXPECT_THAT([] { read_flow("[flow]\ndt_us = 0\n"); }, ThrowsSetupError(ErrorCode::out_of_range, "flow.dt_us"));
  EXPECT_THAT([] { flow_of("jet", "direction = [0, 0]"); },
              ThrowsSetupError(ErrorCode::invalid_value, "flow.direction"));
  EXPECT_THAT([] { flow_of("lamb-oseen", ""); }, ThrowsSetupError(ErrorCode::unknown_choice, "flow.kind"));
  EXPECT_THAT([] { flow_of("rankine", "rate_1_s = 3"); }, ThrowsSetupError(ErrorCode::unknown_key, "flow.rate_1_s"));
}

}  // namespace
}  // namespace gladstone
