#include <utility>

#include "render/light/calibration_target.h"
#include "render/scene/calibration_planes.h"
#include "render/scene/cross_check.h"
#include "render/scene/read_setup.h"
#include "render/scene/setup.h"

namespace gladstone::inline scene {
namespace {

void read_calibration_z_d(Setup& setup, SetupTable geometry) {
  geometry.refuse("z_d_mm", "applies to BOS only (calibration.planes_mm positions the dots); remove it");
  setup.z_d = 0;
}

void read_calibration(Setup& setup, SetupTable root) {
  if (setup.medium.field.kind != FieldKind::none) {
    root.table("medium").problem("field", "does not apply to a calibration, which is made without a flow; remove it");
  }
  root.refuse("sequence", "does not apply to a calibration (its frames are those of calibration.planes_mm); remove it");
  CalibrationTarget read = read_calibration_target(root.table("calibration"));
  setup.target = std::move(read.target);
  setup.planes = std::move(read.planes);
  root.refuse("target", "applies to BOS only (the dots of a calibration are those of [calibration]); remove it");
  refuse_piv_tables(setup, root);
}

void check_calibration(Setup const& setup, SetupTable root, Warnings& warnings) {
  cross_check_noise(setup, warnings);
  cross_check_spot(setup, root);
  cross_check_calibration(setup, std::move(root), warnings);
}

}  // namespace

constinit Experiment const calibration_experiment{.name = "calibration",
                                                  .sources = dot_sources,
                                                  .focus_word = "target",
                                                  .measures_density = false,
                                                  .correlated = false,
                                                  .medium_in_first_frame = false,
                                                  .consecutive_frames = false,
                                                  .reason_for_rays = "the dots of a calibration are on several planes",
                                                  .read_z_d = read_calibration_z_d,
                                                  .read = read_calibration,
                                                  .cross_check = check_calibration};

}  // namespace gladstone::inline scene
