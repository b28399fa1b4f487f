#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "render/base/units.h"
#include "render/files/hdf5_file.h"
#include "render/planning.h"
#include "render/render.h"
#include "render/scene/field_map.h"
#include "render/scene/scene.h"
#include "studies/design/bos_sheet.h"
#include "studies/design/sheet.h"
#include "studies/report/layout_view.h"
#include "tests/support/folder_fixture.h"

namespace gladstone {
namespace {

constexpr double slope = 100;  // density gradient of the files along X [kg/m^4]

/// A folder with volume.h5, 16 x 16 x 30 mm (35 mm deep if periodic along Z), and plane.h5, 16 x 16 mm, of the density
/// 1.225 + 100 x.
class DepthOfTheMedium : public FolderFixture {
 protected:
  void SetUp() override {
    FolderFixture::SetUp();
    write_field("volume.h5", 7);
    write_field("plane.h5", 1);
  }

  void write_field(std::string const& name, std::size_t planes) const {
    std::vector<double> values;
    for (std::size_t k = 0; k < planes * 9; ++k) {
      for (int i = 0; i < 9; ++i) values.push_back(1.225 + slope * 2e-3 * (i - 4));
    }
    Hdf5Writer file((folder_ / name).string(), {"test field", 1, "", 0, "cpu"});
    file.write("density", values, {planes, 9, 9}, "kg m-3", "a ramp", "z, y, x");
    file.close();
  }
  CaseSetup load(std::string const& medium, std::string const& field) const {
    std::string const text = "schema = 1\n[camera]\npixels = [128, 128]\n[medium]\n" + medium + "\n[medium.field]\n" +
                             field + "\n[correlate]\nwindow_px = [32, 16]\n";
    return load_case_setup(SetupDocument::from_text(text, "setup.toml", folder_.string()));
  }
  static DesignSheet sheet_of(CaseSetup const& loaded) {
    FixedDesignParameters const given = collect_fixed_parameters(loaded);
    return bos_sheet(loaded.setup, make_design_point(loaded.setup, given));
  }
};

/// Largest displacement by Eq. 9 in the truth of a rendering, over all pixels [px].
double rendered_displacement(CaseSetup const& loaded) {
  Scene const scene = build_scene(loaded.setup);
  double largest = 0;
  for (Vec2d const one : map_field(scene, plan_step(scene).step, 1).eq9_px) largest = std::max(largest, length(one));
  return largest;
}

// For every kind of field, with a correct, a wrong or no given depth: the displacement of the sheet (F6) is that of the
// rendering, with the gradient and the depth of the same medium, and the resolved setup has the same sheet. Within 1 %:
// if the slope increases up to the edge of the view, the centre of the last pixel is 0.5 of 64 px from it, 0.8 %; the
// sheet samples the shock every 4 px = 0.26 mm, at most (2 0.13 / 3)^2 = 0.7 % from its maximum; an obliquity of 4 mm
// in 1 m changes 1e-5.
TEST_F(DepthOfTheMedium, DesignEqualsRenderForEveryKindOfField) {
  std::string const volume = "kind = \"file\"\nfile = \"volume.h5\"\nspacing_mm = [2.0, 2.0, 5.0]",
                    plane = "kind = \"file\"\nfile = \"plane.h5\"\nspacing_mm = [2.0, 2.0, 5.0]\nextrude = true",
                    plume = "kind = \"gaussian_plume\"\namplitude_kg_m3 = -0.1\nradius_mm = ",
                    blob = "kind = \"gaussian_blob\"\namplitude_kg_m3 = -0.1\nradius_mm = ",
                    wave = "kind = \"sinusoid\"\namplitude_kg_m3 = 0.1\ndirection = [0.6, 0.8]\nwavelength_mm = ",
                    shock = "kind = \"normal_shock\"\nmach = 1.2\nupstream_density_kg_m3 = 1.0\nshock_thickness_mm = 3";
  struct Field {
    std::string text;
    double depth_mm;  ///< if none is given
    bool own_depth;   ///< whatever depth is given
  };
  for (Field const& field :
       {Field{volume, 30, true},
        {volume + "\nperiodic = [false, false, true]", 35, true},
        {volume + "\ncenter_mm = [0.0, 0.0, 8.0]", 30, true},
        {plane, 10, false},
        {plume + "3.0", 21, false},
        {plume + "40.0", 280, false},  // its steepest part is out of view
        {blob + "3.0", 21, false},
        {wave + "4.0", 10, false},
        {wave + "200.0\nphase_rad = 1.5707963", 10, false},  // crest in the middle, no steepest place
        {"kind = \"uniform_gradient\"\ngradient_kg_m4 = [10.0, 5.0, 0.0]", 10, false},
        {shock, 10, false}}) {
    for (std::string const given : {"", "thickness_mm = 30", "thickness_mm = 6"}) {
      SCOPED_TRACE(field.text + '\n' + given);
      CaseSetup loaded = load(given, field.text);
      double const depth_mm = given.empty() || field.own_depth ? field.depth_mm : std::stod(given.substr(15));
      EXPECT_NEAR(loaded.setup.medium.thickness / unit::millimetre, depth_mm, 1e-9);
      DesignSheet const sheet = sheet_of(loaded);
      double const rendered = rendered_displacement(loaded);
      EXPECT_GT(rendered, 1e-3);
      EXPECT_NEAR(sheet["displacement_px"], rendered, 0.01 * rendered);
      // rendering writes the depth into the setup; reading it again changes nothing
      CaseSetup const again =
          load_case_setup(SetupDocument::from_text(loaded.document.resolved(), "resolved", folder_.string()));
      for (char const* const key : {"displacement_px", "sensitivity_px_per_kg_m4", "gradient_min_kg_m4"}) {
        EXPECT_NEAR(sheet_of(again)[key], sheet[key], 1e-9 * sheet[key]) << key;
      }
      EXPECT_EQ(!loaded.warnings.empty() && loaded.warnings.front().code == WarningCode::ignored,
                field.own_depth && !given.empty() && depth_mm != std::stod(given.substr(15)));
    }
  }
}

// Three times the depth has three times the sensitivity: M Z_D K L_z / (n0 p) is 0.006626657 px per kg/m^4 for 10 mm
// (Table 1).
TEST_F(DepthOfTheMedium, SensitivityIsThatOfTheVolume) {
  CaseSetup const loaded = load("", "kind = \"file\"\nfile = \"volume.h5\"\nspacing_mm = [2.0, 2.0, 5.0]");
  DesignSheet const sheet = sheet_of(loaded);
  EXPECT_NEAR(sheet["sensitivity_px_per_kg_m4"], 3 * 0.006626657, 2e-9);
  EXPECT_NEAR(sheet["displacement_px"], slope * 3 * 0.006626657, 1e-3);
  // the design map of a report uses the same depth, although it reads no field
  std::optional<LayoutView> const view = layout_view(load("",
                                                          "kind = \"file\"\nfile = \"volume.h5\"\nspacing_mm = [2.0, "
                                                          "2.0, 5.0]"));
  ASSERT_TRUE(view);
  EXPECT_NEAR(view->bench.sensitivity(), 3 * 0.006626657, 2e-9);
}

}  // namespace
}  // namespace gladstone
