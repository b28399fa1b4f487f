#include "studies/demo.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <filesystem>

#include "analysis/scattered_grid.h"
#include "render/base/error.h"
#include "render/base/output_file.h"
#include "render/base/output_folder.h"
#include "studies/case.h"
#include "studies/compare.h"
#include "studies/correlate.h"
#include "studies/error_report.h"
#include "studies/figures/gnuplot.h"
#include "studies/figures/map_figures.h"
#include "studies/truth_file.h"

namespace gladstone {
namespace {

constexpr double gentle_strain = 0.3;

/// One instant of the demo.
struct Instant {
  char const* name;
  char const* heading;
  char const* file;
  int rays;  ///< a dot; fronts need more
};
constexpr Instant instants[] = {
    {"kepeak", "t = 2.56, just after the peak of kinetic energy", "hbdt512_kepeak_slice.h5", 512},
    {"late", "t = 6.00, decayed", "hbdt512_late_slice.h5", 256},
};

MapAxes axes_of(FieldMap const& field) {
  Vec2d const first = field.position_px(0, 0);
  MapAxes axes;
  axes.x_first = first.x;
  axes.y_first = first.y;
  axes.x_step = axes.y_step = field.spacing_px;
  return axes;
}

SeedFigure4Instant figure_instant(std::string const& heading, FieldMap const& field, GroundTruth const& truth) {
  int const columns = field.density.columns(), rows = field.density.rows();
  SeedFigure4Instant instant;
  instant.heading = heading;
  instant.density = field.density;
  for (auto* map : {&instant.gradient_x, &instant.gradient_y, &instant.theory_u, &instant.theory_v}) {
    *map = Image<double>(columns, rows);
  }
  for (std::size_t i = 0; i < field.density.size(); ++i) {
    instant.gradient_x.data()[i] = field.density_gradient.data()[i].x;
    instant.gradient_y.data()[i] = field.density_gradient.data()[i].y;
    instant.theory_u.data()[i] = field.eq9_px.data()[i].x;
    instant.theory_v.data()[i] = field.eq9_px.data()[i].y;
  }
  MapGrid const grid{columns, rows, field.position_px(0, 0), static_cast<double>(field.spacing_px)};
  DisplacementMaps rays = map_scattered(truth.reference_px, truth.displacement_px, grid);
  instant.rays_u = std::move(rays.u_px);
  instant.rays_v = std::move(rays.v_px);
  return instant;
}

/// What another scrambling of the rays would change.
std::string monte_carlo_error(Setup const& setup) {
  Scene scene = build_scene(setup);
  plan_step(scene);
  plan_rays(scene);
  RaysPlan const error = measure_rays(scene);
  return fmt::format(
      "Monte Carlo error at {} rays a dot, rms: truth {:.4f} px per component, images {:.2f} % of full scale over lit\n"
      "pixels of the worse frame (four scramblings of 96 dots).\n\n",
      error.rays, error.truth_error_px, 100 * error.image_error_levels / (std::pow(2.0, error.bits) - 1));
}

std::string table_row(std::string const& name, Comparison const& comparison, VectorMask const& mask) {
  std::vector<Vec2d> const& measured = comparison.measured.displacement_px;
  auto const rms = [&](std::vector<Vec2d> const& truth) { return summarize_errors(measured, truth, mask).rms_px; };
  ErrorSummary const against_rays = summarize_errors(measured, comparison.point.displacement_px, mask);
  std::vector<Vec2d> const zero(measured.size());
  double const signal = summarize_errors(comparison.point.displacement_px, zero, mask).rms_px;
  double const theory = summarize_errors(comparison.point.eq9_px, comparison.point.displacement_px, mask).rms_px;
  double const cone = summarize_errors(comparison.point.eq9_cone_px, comparison.point.displacement_px, mask).rms_px;
  return fmt::format("| {} | {} | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {:.1f} % |\n", name,
                     against_rays.count, signal, theory, cone, against_rays.rms_px,
                     rms(comparison.window.displacement_px), rms(comparison.point.eq9_cone_px),
                     rms(comparison.point.eq9_px), 100 * against_rays.gross_fraction);
}

}  // namespace

std::string shared_folder() {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::path const executable = fs::read_symlink("/proc/self/exe", error);
  fs::path const installed = executable.parent_path().parent_path() / "share" / "gladstone";
  for (fs::path const& folder : {installed, fs::path(GLADSTONE_SOURCE_DIR)}) {
    if (fs::exists(folder / "studies" / "cases" / "table1.toml")) return folder.string();
  }
  throw DataError(installed.string(),
                  "studies/cases/table1.toml is not there (incomplete installation); install gladstone again");
}

std::string run_demo(std::string const& folder, Device const& device) {
  namespace fs = std::filesystem;
  auto const start = std::chrono::steady_clock::now();
  std::string const shared = shared_folder();
  std::string rows, reports;
  std::vector<SeedFigure4Instant> panels;
  MapAxes axes;  // of both: one camera
  OutputFile const tried((fs::path(folder) / "summary.md").string());
  for (Instant const& instant : instants) OutputFolder((fs::path(folder) / instant.name).string(), case_content());
  for (Instant const& instant : instants) {
    spdlog::info("{}: {}", instant.name, instant.heading);
    std::string const place = (fs::path(folder) / instant.name).string();
    CaseSetup loaded = load_case_setup(shared + "/studies/cases/table1.toml",
                                       {fmt::format("medium.field.file=\"{}/data/fields/{}\"", shared, instant.file),
                                        fmt::format("render.rays_per_dot={}", instant.rays)});
    refuse_case_over_inputs(place, loaded.document.file_names());
    FinishedCase const made = render_to_folder(loaded, *device.renderer, place);
    spdlog::info("{}: correlating", instant.name);
    Measurement const measured = correlate_case(place, "", nullptr, device);
    spdlog::info("{}: {} vectors in {:.1f} s; comparing with truth and theory", instant.name, measured.field.size(),
                 measured.seconds);
    GroundTruth const& dots = made.rendered.rendering->truth;
    Comparison comparison = compare_vectors(
        made.prepared, dots, &made.rendered, {measured.field, loaded.correlate, false, "", place},
        truth_of_vectors(made.prepared, *device.renderer, measured.field.position_px, TruthAt::mid_position), device);
    name_sources(comparison, compared_files(place, ""));
    OutputFile::write_text(in_case(place, case_file::errors), errors_json(comparison));
    rows += table_row(fmt::format("{}, all vectors", instant.name), comparison, comparison.mask);
    VectorMask const gentle =
        gentle_mask(comparison, made.prepared.scene, loaded.correlate.window_px.back(), gentle_strain);
    rows += table_row(fmt::format("{}, strain <= {}", instant.name, gentle_strain), comparison, gentle);
    VectorMask steep = comparison.mask;
    for (std::size_t i = 0; i < steep.size(); ++i) steep[i] = steep[i] && !gentle[i];
    rows += table_row(fmt::format("{}, strain > {}", instant.name, gentle_strain), comparison, steep);
    reports += fmt::format("## {}: {}\n\n{}```\n{}```\n\n", instant.name, instant.heading,
                           monte_carlo_error(loaded.setup), error_report(comparison));
    try {
      draw_comparison(place, comparison);
    } catch (GnuplotMissing const& missing) {
      spdlog::warn("{}", missing.what());
    }
    std::string const truth_path = in_case(place, case_file::truth);
    FieldMap const field = read_field_map(truth_path);
    axes = axes_of(field);
    panels.push_back(figure_instant(instant.heading, field, dots));
  }
  try {
    write_seed_figure4((fs::path(folder) / "figure4.png").string(), axes, panels);
  } catch (GnuplotMissing const& missing) {
    spdlog::warn("{}", missing.what());
  }
  double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::string const text =
      "# The seed's experiment\n\n"
      "Rajendran, Bane & Vlachos, section 4, Table 1: Z_A 0.75 m, Z_D 0.25 m, 105 mm, f/11, 10 um pixels, 512 x 512 "
      "px, 20 dots in\n"
      "32 x 32 px, density field 10 mm deep. Root mean squares in px per component. Vectors are told apart by the "
      "largest strain of\n"
      "Eq. 9 on their window: where it exceeds 0.3 a single ray's displacement changes by a third of the way to its "
      "neighbour, and\n"
      "at 1 rays cross. The earlier instant has such fronts; the late one is the quantitative case.\n\n"
      "| vectors | count | signal | Eq. 9 - rays | cone Eq. 9 - rays | measured - rays | measured - rays on the window "
      "| measured - cone "
      "Eq. 9 | measured - Eq. 9 | over 1 px |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n" +
      rows + "\n" + reports +
      fmt::format(
          "Made in {:.0f} s on {}. Each folder holds the images, truth.h5, vectors.h5, errors.json and figures.\n",
          seconds, device.name());
  OutputFile::write_text((fs::path(folder) / "summary.md").string(), text);
  return text;
}

}  // namespace gladstone
