#include "studies/examples/demo.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <filesystem>

#include "analysis/errors/scattered_grid.h"
#include "analysis/vectors/vector_file.h"
#include "render/base/units.h"
#include "render/files/output_file.h"
#include "render/files/output_folder.h"
#include "render/planning.h"
#include "studies/case/case.h"
#include "studies/case/shared_folder.h"
#include "studies/case/truth_file.h"
#include "studies/case/write_case.h"
#include "studies/compare/compare.h"
#include "studies/compare/comparison_results.h"
#include "studies/compare/correlate.h"
#include "studies/drawing/draw_figure.h"
#include "studies/examples/demo_story.h"
#include "studies/figures/agreement_figure.h"
#include "studies/figures/comparison_figures.h"
#include "studies/figures/draw_or_warn.h"
#include "studies/figures/map_figures.h"

namespace gladstone::inline examples {
namespace {

/// One instant of the turbulence field.
struct Instant {
  char const* name;
  char const* time;
  char const* what;
  char const* file;
};
constexpr Instant instants[] = {
    {"kepeak", "t = 2.56", "just after the peak of kinetic energy", "hbdt512_kepeak_slice.h5"},
    {"late", "t = 6.00", "decayed", "hbdt512_late_slice.h5"},
};

/// Number of nodes across 32.7 mm, and the corresponding spacing.
struct Fineness {
  int nodes;
  double spacing_mm;
};
/// Resolutions of the planes. The first one equals that of the authors' sample field.
constexpr Fineness finenesses[] = {{64, 0.519}, {128, 0.2575}, {256, 0.1282}, {512, 0.06399}};

constexpr int rays_of_case = 256, rays_of_planes = 64;  // rays per dot

CaseSetup load_instant(std::string const& shared, Instant const& instant, Fineness fineness, int rays) {
  return load_case_setup(shared + "/studies/cases/table1.toml",
                         {fmt::format("medium.field.file=\"{}/data/fields/{}\"", shared, instant.file),
                          fmt::format("medium.field.spacing_mm=[{0}, {0}, {0}]", fineness.spacing_mm),
                          fmt::format("render.rays_per_dot={}", rays)});
}

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
  instant.theory.name = "Eq. 9";
  for (auto* map : {&instant.gradient_x, &instant.gradient_y, &instant.theory.u_px, &instant.theory.v_px}) {
    *map = Image<double>(columns, rows);
  }
  for (std::size_t i = 0; i < field.density.size(); ++i) {
    instant.gradient_x.data()[i] = field.density_gradient.data()[i].x;
    instant.gradient_y.data()[i] = field.density_gradient.data()[i].y;
    instant.theory.u_px.data()[i] = field.eq9_px.data()[i].x;
    instant.theory.v_px.data()[i] = field.eq9_px.data()[i].y;
  }
  MapGrid const grid{columns, rows, field.position_px(0, 0), static_cast<double>(field.spacing_px)};
  auto const on_grid = [&](char const* name, std::vector<Vec2d> const& displacement_px) {
    DisplacementMaps maps = map_scattered(truth.reference_px, displacement_px, grid);
    return NamedMaps{name, std::move(maps.u_px), std::move(maps.v_px)};
  };
  instant.cone = on_grid("aperture average", truth.eq9_cone_px);
  instant.rays = on_grid("light rays", truth.displacement_px);
  return instant;
}

/// Correlates the frames of a case in memory and writes its vectors.
/// @param place  folder of the case
Measurement correlate_instant(CaseSetup const& loaded, WrittenCase const& made, std::string const& place,
                              Backend const& device) {
  Measurement measured = correlate_frames(in_case(place, case_file::reference), in_case(place, case_file::flow),
                                          *made.frames.levels, loaded.correlate, device);
  FileOrigin origin{"gladstone vectors", 1, loaded.document.resolved(), loaded.setup.render.seed, measured.device};
  origin.sources.add_known("reference", made.outcome.reference_sha256);
  origin.sources.add_known("flow", made.outcome.flow_sha256);
  write_vectors(in_case(place, case_file::vectors), measured.field, origin);
  return measured;
}

/// Returns the results of the paper's case over the compared vectors.
DemoInstant::Paper paper_numbers(Comparison const& comparison) {
  VectorMask const& mask = comparison.mask;
  DemoInstant::Paper paper;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i]) paper.sums.add(comparison.point, i);
  }
  auto const rms = [&](std::vector<Vec2d> const& one, std::vector<Vec2d> const& other) {
    return summarize_errors(one, other, mask)["rms_px"];
  };
  std::vector<Vec2d> const& measured = comparison.measured.displacement_px;
  paper.cone_minus_rays_px = rms(comparison.point.eq9_cone_px, comparison.point.displacement_px);
  paper.measured_minus_rays_px = rms(measured, comparison.point.displacement_px);
  paper.measured_minus_window_px = rms(measured, comparison.window.displacement_px);
  paper.report = error_report(comparison);
  return paper;
}

/// Traces and predicts the planes of an instant, from coarse to fine.
std::vector<DemoInstant::Plane> trace_planes(Setup const& setup, GradientSpectrum const& spectrum, Renderer& renderer) {
  std::vector<DemoInstant::Plane> planes;
  for (Fineness const& fineness : finenesses) {
    double const spacing = fineness.spacing_mm * unit::millimetre;
    planes.push_back({fineness.nodes, spectrum.structure_size() * spacing / cone_width(setup),
                      agreement_over_plane(setup, fineness.nodes, spacing, renderer),
                      predicted_agreement(spectrum, spacing, setup)});
  }
  return planes;
}

/// Returns points and curve of an instant for the agreement figure.
AgreementSeries agreement_series(Setup const& setup, GradientSpectrum const& spectrum, DemoInstant const& instant) {
  AgreementSeries series;
  series.name = instant.time;
  for (DemoInstant::Plane const& plane : instant.planes) {
    series.points.push_back({plane.size_over_cone, plane.nodes, plane.traced.sums.agreement(), plane.traced.error});
  }
  for (double const size : agreement_sizes()) {
    double const spacing = size * cone_width(setup) / spectrum.structure_size();
    series.prediction.push_back({size, predicted_agreement(spectrum, spacing, setup)});
  }
  return series;
}

}  // namespace

std::string run_demo(std::string const& folder, Backend const& device) {
  namespace fs = std::filesystem;
  auto const start = std::chrono::steady_clock::now();
  std::string const shared = shared_folder();
  std::vector<DemoInstant> found;
  std::vector<SeedFigure4Instant> panels;
  std::vector<AgreementSeries> series;
  MapAxes axes;  // common to both instants: same camera
  Setup paper;   // setup of the paper's case; only the field differs between instants
  OutputFile const tried((fs::path(folder) / "summary.md").string());
  for (Instant const& instant : instants) OutputFolder((fs::path(folder) / instant.name).string(), case_content());
  for (Instant const& instant : instants) {
    DemoInstant& result = found.emplace_back();
    result.time = instant.time;
    result.heading = fmt::format("{}, {}", instant.time, instant.what);
    spdlog::info("{}: {}", instant.name, result.heading);
    std::string const place = (fs::path(folder) / instant.name).string();
    CaseSetup loaded = load_instant(shared, instant, finenesses[0], rays_of_case);
    paper = loaded.setup;
    refuse_case_over_inputs(place, loaded.document.file_names());
    WrittenCase const made = render_to_folder(loaded, *device.renderer, place);
    spdlog::info("{}: correlating", instant.name);
    Measurement const measured = correlate_instant(loaded, made, place, device);
    spdlog::info("{}: {} vectors in {:.1f} s; comparing with truth and theory", instant.name, measured.field.size(),
                 measured.seconds);
    GroundTruth const& dots = made.rendered.rendering->truth;
    Comparison comparison = compare_vectors(
        made.prepared, dots, &made.rendered, {.field = measured.field, .settings = loaded.correlate, .name = place},
        truth_of_vectors(made.prepared, *device.renderer, measured.field.position_px, TruthAt::mid_position), device);
    name_sources(comparison, compared_files(place, ""));
    OutputFile::write_text(in_case(place, case_file::errors), errors_json(comparison));
    result.paper = paper_numbers(comparison);
    draw_or_warn([&] { draw_comparison(place, comparison); });
    FieldMap const field = field_in_view(made.prepared.scene, made.rendered.rendering->plan, truth_map_spacing_px);
    axes = axes_of(field);
    panels.push_back(figure_instant(result.heading, field, dots));
    spdlog::info("{}: tracing finer fields", instant.name);
    Setup plane = loaded.setup;
    plane.render.rays_per_dot = rays_of_planes;
    GradientSpectrum const spectrum = gradient_spectrum(field_plane(plane.medium.field));
    result.planes = trace_planes(plane, spectrum, *device.renderer);
    series.push_back(agreement_series(plane, spectrum, result));
  }
  draw_or_warn([&] {
    draw_figure(make_seed_figure4(axes, panels), (fs::path(folder) / "figure4.png").string());
    std::vector<double> single_wave;
    for (double const size : agreement_sizes())
      single_wave.push_back(std::abs(cone_transfer(paper, size * cone_width(paper))));
    draw_figure(make_agreement_figure(series, single_wave), (fs::path(folder) / "agreement.png").string());
  });
  double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::string const text = "# The demo\n\n" + demo_story(paper, found) + "\n" + demo_details(found) +
                           fmt::format(
                               "Computed in {:.0f} s on {}. Each folder contains the images, truth.h5, vectors.h5, "
                               "errors.json and the figures.\n",
                               seconds, device.name());
  OutputFile::write_text((fs::path(folder) / "summary.md").string(), text);
  return text;
}

}  // namespace gladstone::inline examples
