#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "studies/design/bos_sheet.h"
#include "studies/design/piv_sheet.h"
#include "studies/design/sheet.h"
#include "studies/design/sheet_text.h"
#include "studies/figures/design_map.h"
#include "studies/figures/layout_figure.h"
#include "studies/figures/piv_map.h"
#include "tests/studies/support/table1_design.h"
#include "tests/support/numbers_in.h"

namespace gladstone {
namespace {

constexpr char const* sheet_setup = R"(schema = 1
[medium.field]
kind = "uniform_gradient"
gradient_kg_m4 = [10.0, 0.0, 0.0]
[correlate]
window_px = [64, 32, 16]
)";

/// A sheet and its inputs.
struct MadeSheet {
  explicit MadeSheet(CaseSetup setup)
      : loaded(std::move(setup)),
        given(collect_fixed_parameters(loaded)),
        bench(make_design_point(loaded.setup, given)),
        sheet(bos_sheet(loaded.setup, bench)) {}

  CaseSetup loaded;
  FixedDesignParameters given;
  DesignPoint<double> bench;
  DesignSheet sheet;
};

std::unique_ptr<MadeSheet> sheet_of(std::string const& text) {
  return std::make_unique<MadeSheet>(load_case_setup(SetupDocument::from_text(text, "setup.toml")));
}

// The defaults of a setup are those of Table 1; K = 2.26e-4, 10 kg/m^4 over 10 mm.
TEST(DesignSheet, HasEveryFormulaOfBosFromF1ToF27) {
  auto const made = sheet_of(sheet_setup);
  std::set<std::string> ids;
  for (ResultRow const& row : made->sheet.rows) {
    ids.insert(row.id);
    EXPECT_TRUE(std::isfinite(row.value)) << row.key;
    EXPECT_FALSE(row.formula.empty() || row.source.empty() || row.label.empty()) << row.key;
  }
  for (int number = 1; number <= 27; ++number)
    EXPECT_EQ(ids.count(std::string("F").append(std::to_string(number))), 1u) << number;
}

// A formula is one row: text, JSON and CSV follow from it.
TEST(DesignSheet, IsTextJsonAndCsvOfTheSameRows) {
  DesignSheet sheet = sheet_of(sheet_setup)->sheet;
  sheet.rows.push_back({.id = "F99", .key = "new_mm", .symbol = "x", .label = "new", .value = 1.5, .unit = "mm"});
  std::string const text = sheet_text(sheet), csv = rows_csv(sheet.rows);
  nlohmann::ordered_json const json = sheet_json(sheet);
  ASSERT_EQ(json["rows"].size(), sheet.rows.size());
  for (std::size_t i = 0; i < sheet.rows.size(); ++i) {
    ResultRow const& row = sheet.rows[i];
    EXPECT_EQ(json["rows"][i]["value"], row.value) << row.key;
    EXPECT_THAT(text, testing::HasSubstr("  " + row.id));
    EXPECT_THAT(text, testing::HasSubstr(row.label));
    EXPECT_THAT(csv, testing::HasSubstr('\n' + row.key + ',' + row.symbol + ','));
  }
  EXPECT_EQ(json["new_mm"], 1.5);
  EXPECT_THAT(text, testing::ContainsRegex("F99 new, x +1.5 mm"));
  EXPECT_THAT(csv, testing::HasSubstr("\nnew_mm,x,new,1.5,mm,\n"));
}

TEST(DesignSheet, IsTableOneToThePrintedDigits) {
  DesignSheet const sheet = sheet_of(sheet_setup)->sheet;
  EXPECT_NEAR(sheet["magnification"], 0.117318436, 5e-10);
  EXPECT_NEAR(sheet["sensitivity_px_per_kg_m4"], 0.006626657, 5e-10);
  EXPECT_NEAR(sheet["cone_diameter_mm"], 2.386364, 5e-7);
  EXPECT_NEAR(sheet["diffraction_diameter_px"], 1.5954, 5e-5);
  EXPECT_NEAR(sheet["displacement_px"], 0.06626657, 5e-9);
  EXPECT_NEAR(sheet["deflection_urad"], 22.5937, 5e-4);  // 3.1: tan theta 2.25937e-5
  EXPECT_NEAR(sheet["cone_wavelength_mm"], 2.386364 / 0.5145, 1e-5);
  EXPECT_NEAR(sheet["fresnel_scale_mm"], 0.32, 0.005);               // fact 11
  EXPECT_NEAR(sheet["share_of_sensitivity"], 0.25, 1e-12);           // F8, half at Z_D = Z_A
  EXPECT_NEAR(sheet["small_angle_at_edge"], 4.8e-4, 5e-6);           // F27
  EXPECT_NEAR(sheet["field_of_view_mm"], 5.12 / 0.156424581, 1e-6);  // M_A = M Z_B / Z_A
  // F27 with matched faces: eps^2 (1/6 + L_z / (24 Z_D)), 8.6e-11 less with sinh than with tan, for 10 kg/m^4
  EXPECT_NEAR(sheet["small_angle_on_axis"], 2.25937e-5 * 2.25937e-5 * (1.0 / 6 + 0.04 / 24), 1e-15);
}

// In a slab with a uniform gradient tan theta = sinh(eps) at the exit. Behind a face that refracts sin theta =
// sinh(eps), so that the error of the small angle is eps^2 (2/3 + 7 L_z / (24 Z_D)), 3.463e-10.
TEST(DesignSheet, SmallAnglesThroughRefractingFacesAreTheSlabs) {
  std::string text = sheet_setup;
  text.replace(text.find("[medium.field]"), 0, "[medium]\nfaces = \"refract\"\n");
  EXPECT_NEAR(sheet_of(text)->sheet["small_angle_on_axis"], 3.463e-10, 5e-14);
}

// A stop of f/4 makes the cone 2.75 times as wide, 6.56 mm, compared with windows of 1.02 mm; at f/32 the PSF is 4.6 px
// wide.
TEST(DesignSheet, MarginsSayWhatIsViolated) {
  auto const at = [](std::string const& stop) {
    return sheet_of(std::string(sheet_setup) + "[lens]\nf_number = " + stop + "\n")->sheet;
  };
  EXPECT_EQ(at("4").row("cone_diameter_mm").margin, Margin::violated);
  EXPECT_EQ(at("4").row("f_number_floor").margin, Margin::violated);
  EXPECT_EQ(at("32").row("diffraction_diameter_px").margin, Margin::marginal);
  EXPECT_EQ(at("11").row("diffraction_diameter_px").margin, Margin::green);
  EXPECT_STREQ(margin_word(Margin::violated), "violated");
  EXPECT_EQ(at_least(7, 8, 5), Margin::marginal);
  EXPECT_EQ(at_most(7, 5, 8), Margin::marginal);
}

// F22: a lamp dimmer by the square of f-number over limit gives dots with 20 times their noise. With a ninth of the
// light required no f-number remains, and the smallest f-number states the missing factor.
TEST(DesignSheet, LightLimitsTheStop) {
  auto const under = [](double radiance, char const* stop) {
    return sheet_of(std::string(sheet_setup) + "[camera.noise]\n[light]\nradiance_w_m2_sr = " +
                    std::to_string(radiance) + "\nexposure_us = 20\n[lens]\nf_number = " + stop + "\n")
        ->sheet;
  };
  DesignSheet const bright = under(8000, "11");
  double const ceiling = bright["f_number_light"];
  DesignSheet const dim = under(8000 * std::pow(11 / ceiling, 2), "11");
  EXPECT_NEAR(dim["signal_to_noise"], 20, 1e-4);
  EXPECT_NEAR(dim["f_number_light"], 11, 1e-4);
  EXPECT_EQ(dim.row("f_number_light").margin, Margin::green);
  double const floor = dim["f_number_floor"], missing = std::pow(floor / 11, 2);
  EXPECT_GT(missing, 1.1);
  EXPECT_THAT(dim.row("f_number_floor").note,
              testing::AllOf(testing::HasSubstr("f/11"), testing::HasSubstr("2.386 mm")));
  EXPECT_THAT(dim.row("f_number_floor").note, testing::HasSubstr(fmt::format("{:.3g}", missing)));
  DesignSheet const automatic = sheet_of(sheet_setup)->sheet;
  EXPECT_TRUE(std::none_of(automatic.rows.begin(), automatic.rows.end(), [](ResultRow const& row) {
    return row.key == "f_number_light";
  })) << "exposure = \"auto\" takes what light it needs";
}

// The study covers f/4 to f/32 and noise of 0.6 to 11 % of the peak: values outside this range are reported and never
// green.
TEST(DesignSheet, SaysWhereTheRandomErrorWasNotMeasured) {
  auto const row = [](std::string const& more) {
    return sheet_of(std::string(sheet_setup) + more)->sheet.row("random_error_px");
  };
  std::string const noise = "[camera.noise]\nfull_well_e = 10000\n";
  ResultRow const within = row(noise);
  EXPECT_EQ(within.margin, Margin::green);
  for (auto const& [more, limit] : {std::pair<std::string, char const*>{"", "0.6 %"},
                                    {noise + "[lens]\nf_number = 45\n", "0.8 px"},
                                    {noise + "[target]\ndots_per_32px_window = 8\n", " 5 "}}) {
    EXPECT_EQ(row(more).margin, Margin::marginal) << limit;
    EXPECT_THAT(row(more).note, testing::HasSubstr(limit));
    EXPECT_GT(numbers_in(row(more).note).size(), numbers_in(within.note).size()) << limit;
  }
}

// F29: the largest deflection by a plume is sqrt(2 pi / e) dn / n0, which is a mean gradient of 1.520347 A / L_z.
TEST(DesignSheet, PlumesHaveTheGradientOfTheirAbelTransform) {
  auto const made = sheet_of(
      "schema = 1\n[medium]\nthickness_mm = 50.0\n[medium.field]\nkind = \"gaussian_plume\"\namplitude_kg_m3 = -0.4\n"
      "radius_mm = 5.0\n");
  EXPECT_NEAR(made->given.largest_gradient, 1.520347 * 0.4 / 0.05, 1e-5);
}

// The light cone of a dot on the axis is as wide at the medium as its lines in the figure, and the edge of the sensor
// sees the edge of the dots through the middle of the lens.
TEST(DesignSheet, LayoutIsToScale) {
  FixedDesignParameters const given = table1_given();
  OpticalLayout const l = make_optical_layout(table1_design(given));
  EXPECT_DOUBLE_EQ(l.lens_z - l.dots_z, 1.0);
  EXPECT_NEAR(l.cone_radius / l.pupil_radius, -l.dots_z / (l.lens_z - l.dots_z), 1e-12);
  EXPECT_NEAR(l.dots_half / (l.lens_z - l.dots_z), l.sensor_half / (l.sensor_z - l.lens_z), 1e-12);
  EXPECT_NEAR(l.medium_half / l.lens_z, l.sensor_half / (l.sensor_z - l.lens_z), 1e-12);
  EXPECT_NEAR(l.sensor_half, 2.56e-3, 1e-12);
}

// On the map the resolution is never finer than that of the cone, which by F23 depends on sensitivity and f-number
// only.
TEST(DesignSheet, MapLiesAboveTheInvariant) {
  FixedDesignParameters const given = table1_given();
  for (DesignCurve const& curve : design_curves(table1_design(given))) {
    ASSERT_FALSE(curve.z_d.empty());
    for (std::size_t i = 0; i < curve.z_d.size(); ++i) {
      // slices of a thick field near the dots have narrower cones and shorter lever arms: 1 % at the smallest Z_D
      EXPECT_GT(curve.resolution[i], 0.98 * curve.cone[i] / 0.51450) << curve.f_number << ' ' << curve.z_d[i];
    }
  }
}

constexpr char const* droplets = R"(schema = 1
experiment = "piv"
[camera]
pixels = [512, 512]
pixel_pitch_um = 5.0
[lens]
f_number = 8.0
[particles]
number = 20000
volume_mm = [40.0, 40.0, 3.0]
[laser]
thickness_mm = 1.0
[flow]
kind = "uniform"
velocity_m_s = [3.0, 4.0, 20.0]
dt_us = 20.0
[correlate]
window_px = [64, 32]
)";

CaseSetup load_droplets() { return load_case_setup(SetupDocument::from_text(droplets, "piv.toml")); }

// The droplets of the example in docs/piv.md: the sheet agrees with info particles, and states how far they may move.
TEST(DesignSheet, OfPivLimitsTheDisplacementBetweenThePulses) {
  CaseSetup const loaded = load_droplets();
  DesignSheet const sheet = piv_sheet(loaded);
  double const pixel = 5e-6 / (105.0 / 645);
  EXPECT_NEAR(sheet["displacement_px"], 5 * 20e-6 / pixel, 1e-9);
  EXPECT_NEAR(sheet["in_plane_max_m_s"], 16 * pixel / 20e-6, 1e-9);
  EXPECT_NEAR(sheet["out_of_plane_max_m_s"], 1e-3 / 4 / 20e-6, 1e-9);  // limit 12.5 m/s; the flow has 20 m/s
  EXPECT_EQ(sheet.row("out_of_plane_max_m_s").margin, Margin::violated);
  EXPECT_EQ(sheet.row("in_plane_max_m_s").margin, Margin::green);
  // 20000 in 40 x 40 x 3 mm, 1 mm of it illuminated, in windows of 32 px
  EXPECT_NEAR(sheet["particles_per_window"], 20000.0 / 4800 * std::pow(32 * pixel * 1e3, 2), 1e-6);
}

// The edge of the sensor sees the edge of the view in the sheet through the middle of the lens.
TEST(DesignSheet, LayoutOfPivIsToScale) {
  CaseSetup const loaded = load_droplets();
  OpticalLayout const l = make_camera_layout(loaded.setup);
  EXPECT_DOUBLE_EQ(l.lens_z, 0.75);
  EXPECT_NEAR(l.sensor_z - l.lens_z, 1 / (1 / 0.105 - 1 / 0.75), 1e-12);
  EXPECT_NEAR(l.dots_half / l.lens_z, l.sensor_half / (l.sensor_z - l.lens_z), 1e-12);
  EXPECT_NEAR(l.pupil_radius, 0.105 / 8 / 2, 1e-12);
  EXPECT_DOUBLE_EQ(l.sheet_half_thickness, 0.5e-3);
  EXPECT_DOUBLE_EQ(l.dots_z, 0);
  EXPECT_EQ(l.medium_half_thickness, 0.0) << "without a field there is no medium to draw";
}

// At the f-number of the setup the map agrees with the sheet. Up to f/2.8 images are far smaller than a pixel: the peak
// contains all the light, which decreases with the square of the f-number; from f/16 on the PSF spreads it, by another
// square.
TEST(DesignSheet, MapOfPivFollowsTheStop) {
  CaseSetup const loaded = load_droplets();
  DesignSheet const sheet = piv_sheet(loaded);
  std::vector<PivStop> const stops = piv_stops(loaded.setup);
  auto const at = [&](double f_number) {
    return *std::find_if(stops.begin(), stops.end(), [&](PivStop const& row) { return row.f_number == f_number; });
  };
  EXPECT_DOUBLE_EQ(at(8).image_px, sheet["image_diameter_px"]);
  EXPECT_DOUBLE_EQ(at(8).edge_px, sheet["image_diameter_sheet_edge_px"]);
  EXPECT_DOUBLE_EQ(at(8).peak_electrons[1], sheet["peak_electrons"]);
  EXPECT_NEAR(std::log(at(1.4).peak_electrons[1] / at(2.8).peak_electrons[1]) / std::log(2.0), 2, 0.05);
  EXPECT_NEAR(std::log(at(16).peak_electrons[1] / at(32).peak_electrons[1]) / std::log(2.0), 4, 0.3);
  EXPECT_GT(at(1.4).edge_px, 2 * at(1.4).image_px) << "defocus at half the thickness of the sheet";
}

}  // namespace
}  // namespace gladstone
