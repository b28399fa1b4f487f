#include "studies/compare.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "analysis/correlation/correlator.h"
#include "analysis/errors/scattered_grid.h"
#include "analysis/errors/uncertainty_quality.h"
#include "render/base/error.h"
#include "render/base/hdf5_file.h"
#include "render/base/input_file.h"
#include "render/rays/rays_renderer.h"
#include "render/scene/build_camera.h"
#include "render/sensor/detector.h"
#include "studies/correlate.h"
#include "studies/figures/error_figures.h"
#include "studies/figures/map_figures.h"
#include "studies/json_text.h"
#include "studies/particle_points.h"
#include "studies/scene_renderer.h"
#include "studies/truth_file.h"

namespace gladstone {
namespace {

/// JSON knows no NaN: what is undefined is null.
nlohmann::json number(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr); }

nlohmann::json term_json(BudgetTerm const& term) {
  nlohmann::json json{{"bias_u_px", number(term.bias_u_px)},
                      {"bias_v_px", number(term.bias_v_px)},
                      {"random_u_px", number(term.random_u_px)},
                      {"random_v_px", number(term.random_v_px)},
                      {"rms_px", number(term.rms_px)}};
  if (!term.includes.empty()) json["includes"] = term.includes;
  return json;
}

nlohmann::json matrix_json(CovarianceMatrix const& matrix) {
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t i = 0; i < matrix.size; ++i) {
    nlohmann::json row = nlohmann::json::array();
    for (std::size_t j = 0; j < matrix.size; ++j) row.push_back(number(matrix(i, j)));
    rows.push_back(row);
  }
  return rows;
}

nlohmann::ordered_json fit_json(ConventionFit const& fit) {
  return {{"conventions", describe(fit.conventions)}, {"rms_px", number(fit.rms_px)}};
}

/// How a foreign file's vectors fit the truth by its conventions, without the offset, and by every other choice.
nlohmann::ordered_json fit_json(DetectedConventions const& detected) {
  using Verdict = DetectedConventions::Verdict;
  nlohmann::ordered_json json = fit_json(detected.fit);
  json["verdict"] = detected.verdict == Verdict::fits    ? "fits"
                    : detected.verdict == Verdict::noisy ? "noisy"
                                                         : "cannot_be_told";
  json["ambiguous"] = detected.ambiguous;
  json["signal_px"] = number(detected.fit.signal_px);
  json["slope"] = number(detected.fit.slope);
  json["offset_px"] = detected.conventions.offset_px;
  json["rms_without_offset_px"] = number(detected.without_offset.rms_px);
  json["tried"] = nlohmann::ordered_json::array();
  for (ConventionFit const& fit : detected.tried) json["tried"].push_back(fit_json(fit));
  return json;
}

/// How well the measurement's own uncertainties tell its errors against the truth on the window, and against that at
/// the point, which the window's averaging adds to; nothing where there are none.
nlohmann::ordered_json uncertainty_json(Comparison const& comparison) {
  DisplacementField const& measured = comparison.measured;
  auto const is_known = [](Vec2d sigma) { return std::isfinite(sigma.x) && std::isfinite(sigma.y); };
  if (std::none_of(measured.sigma_px.begin(), measured.sigma_px.end(), is_known)) return {};
  nlohmann::ordered_json json;
  for (auto const& [name, truth] : {std::pair("window_truth", &comparison.window.displacement_px),
                                    std::pair("ray_truth", &comparison.point.displacement_px)}) {
    UncertaintyQuality const quality =
        uncertainty_quality(measured.displacement_px, *truth, measured.sigma_px, comparison.mask);
    for (auto const& [measure, value] : quality_measures(quality)) {
      bool const is_count = measure == "count" || measure == "gross";
      json[name][std::string(measure)] = is_count ? nlohmann::json(static_cast<long long>(value)) : number(value);
    }
  }
  return json;
}

/// Light of a dot in each frame multiplies in the correlation: a is the product, the squared flux where it did not
/// change.
std::vector<double> correlation_flux(GroundTruth const& truth) {
  std::vector<double> flux;
  flux.reserve(truth.size());
  for (Vec2d const& both : truth.flux) flux.push_back(std::sqrt(std::max(0.0, both.x * both.y)));
  return flux;
}

/// Ray truth of the dots on a lattice, for quick look-ups anywhere in the view.
class TruthMap {
 public:
  TruthMap(GroundTruth const& truth, CameraSetup const& camera)
      : grid_{camera.columns / spacing + 1, camera.rows / spacing + 1, {0, 0}, spacing},
        maps_(map_scattered(near_view(truth.reference_px, camera), truth.displacement_px, grid_)) {}

  /// Bilinear between the lattice's points, so that half a pixel shows; NaN beyond the view by more than what codes'
  /// ways of counting pixels differ by.
  Vec2d at(Vec2d c) const {
    Vec2d const last{spacing * (grid_.columns - 1.0), spacing * (grid_.rows - 1.0)};
    Vec2d const inside{std::clamp(c.x, 0.0, last.x), std::clamp(c.y, 0.0, last.y)};
    if (!(length(c - inside) <= 2 * outside_margin_px)) return {std::nan(""), std::nan("")};
    int const column = std::clamp(static_cast<int>(inside.x / spacing), 0, std::max(0, grid_.columns - 2));
    int const row = std::clamp(static_cast<int>(inside.y / spacing), 0, std::max(0, grid_.rows - 2));
    double const fx = inside.x / spacing - column, fy = inside.y / spacing - row;
    int const right = std::min(column + 1, grid_.columns - 1), below = std::min(row + 1, grid_.rows - 1);
    auto const blend = [&](Image<double> const& map) {
      return (1 - fy) * ((1 - fx) * map(column, row) + fx * map(right, row)) +
             fy * ((1 - fx) * map(column, below) + fx * map(right, below));
    };
    return {blend(maps_.u_px), blend(maps_.v_px)};
  }

 private:
  /// Dots far from the view do not count, lest a few of them spread the smoothing over all that is seen.
  static std::vector<Vec2d> near_view(std::vector<Vec2d> places, CameraSetup const& camera) {
    double const margin = std::max(camera.columns, camera.rows);
    for (Vec2d& p : places) {
      bool const near = std::abs(p.x - 0.5 * camera.columns) <= 0.5 * camera.columns + margin &&
                        std::abs(p.y - 0.5 * camera.rows) <= 0.5 * camera.rows + margin;
      if (!near) p = {std::nan(""), std::nan("")};
    }
    return places;
  }

  static constexpr int spacing = 2;
  MapGrid grid_;
  DisplacementMaps maps_;
};

/// Leaves out what no camera can have seen. @throws DataError where nothing is left, or no place is in px
LeftOutVectors screen(VectorFile& file, std::string const& path, CameraSetup const& camera) {
  LeftOutVectors const left_out = screen_vectors(file.field, file.conventions.offset_px, camera.columns, camera.rows);
  std::string const refusal = refusal_of_places(file.field, left_out, camera.columns, camera.rows);
  if (!refusal.empty()) throw DataError(path, refusal);
  if (left_out.all() > 0) {
    spdlog::warn("{}: {} of {} vectors are left out: {}", path, left_out.all(),
                 file.field.size() + left_out.without_place(), left_out.text());
  }
  std::string const doubt = doubt_about_places(file.field, camera.columns, camera.rows);
  if (!doubt.empty()) spdlog::warn("{}: {}", path, doubt);
  return left_out;
}

MeasuredVectors load_vectors(std::string const& path, CaseSetup const& loaded, GroundTruth const& truth,
                             CompareOptions const& options) {
  VectorFile file = read_vectors(path);
  if (options.conventions) file.conventions = parse_conventions(*options.conventions, file.conventions);
  CameraSetup const& camera = loaded.setup.camera;
  LeftOutVectors const left_out = screen(file, path, camera);
  MeasuredVectors vectors{{}, loaded.correlate, file.foreign, {}, path, left_out, {}};
  if (options.conventions) {
    vectors.report = file.format + " vectors, as told: " + describe(file.conventions);
  } else if (file.foreign) {
    TruthMap const map(truth, camera);
    auto const lookup = [&map](Vec2d c) { return map.at(c); };
    vectors.detected = detect_conventions(file, lookup, camera.rows);
    vectors.report = vectors.detected->report;
    if (vectors.detected->verdict == DetectedConventions::Verdict::fits_none) throw DataError(path, vectors.report);
    file.conventions = vectors.detected->conventions;
    bool const told = vectors.detected->verdict != DetectedConventions::Verdict::cannot_be_told;
    if (!told || vectors.detected->ambiguous) spdlog::warn("{}: {}", path, vectors.report);
  }
  vectors.field = apply_conventions(std::move(file.field), file.conventions, camera.rows);
  if (!file.foreign && path.ends_with(".h5")) {
    std::string const text = Hdf5Reader(path).attribute("setup");
    if (!text.empty()) {
      SetupDocument document = SetupDocument::from_text(text, path);
      vectors.settings = read_correlation_settings(document.root().table("correlate"));
    }
  } else if (!file.foreign) {
    vectors.foreign = true;  // a CSV does not say how it was measured, so it cannot be measured again
  }
  return vectors;
}

}  // namespace

void name_sources(Comparison& comparison, ComparedFiles files) {
  comparison.verified = files.unverified.empty();
  comparison.sources = std::move(files.sources);
}

GroundTruth truth_at_points(Scene& scene, Renderer& renderer, std::vector<Vec2d> const& centres_px, TruthAt at,
                            RenderTheory theory) {
  DotPattern virtual_dots;
  virtual_dots.shape = scene.dots.shape;
  for (Vec2d const& c : centres_px) virtual_dots.centre.push_back(scene.to_target(c));
  std::uint64_t const all_rays = scene.rays_per_dot, all_at_faces = scene.rays_at_side_faces;
  auto const correct = [&](GroundTruth const& truth) {
    for (std::size_t i = 0; i < centres_px.size(); ++i) {
      Vec2d const shift = at == TruthAt::mid_position ? 0.5 * truth.displacement_px[i] : Vec2d{};
      Vec2d const miss = centres_px[i] - (truth.reference_px[i] + shift);
      if (!std::isfinite(miss.x) || !std::isfinite(miss.y)) continue;
      Vec2d const seen = truth.reference_px[i];
      virtual_dots.centre[i] = virtual_dots.centre[i] + (scene.to_target(seen + miss) - scene.to_target(seen));
    }
  };
  // a point is where its dot is, but for a little that the second round takes off
  scene.rays_per_dot = std::min<std::uint64_t>(all_rays, 128);
  scene.rays_at_side_faces = std::min<std::uint64_t>(all_at_faces, 1024);
  for (double const half_size : {0.0, scene.dots.half_size}) {
    virtual_dots.half_size = half_size;
    correct(renderer.render(scene, virtual_dots, RenderImages::no, RenderTheory::no).truth);
  }
  scene.rays_per_dot = all_rays;
  scene.rays_at_side_faces = all_at_faces;
  return renderer.render(scene, virtual_dots, RenderImages::no, theory).truth;
}

std::vector<Vec2d> ideal_lens_truth(Scene scene, Renderer& renderer, GroundTruth const& point) {
  if (method_of(scene) == RenderMethod::focused_dots && scene.setup.lens.focus == Focus::target)
    return point.displacement_px;
  DotPattern virtual_dots;
  virtual_dots.half_size = scene.dots.half_size;
  virtual_dots.shape = scene.dots.shape;
  for (Vec3d const& p : point.position_m) virtual_dots.centre.push_back({p.x, p.y});
  // on the bench the ideal lens is one that the fast renderer takes, unless rays are asked for
  bool const focusable = scene.setup.on_bench() && !scene.chief_rays_only();
  if (!focusable || scene.setup.render.method == RenderMethod::rays) return ideal_displacements(scene, virtual_dots);
  // the sensor stays where it is, and with it the magnification; the lens is made to image the target on it
  scene.setup.lens.focal_length = 1 / (1 / scene.imaging.image_distance + 1 / scene.setup.z_b());
  scene.setup.lens.focus = Focus::target;
  scene.setup.lens.f_number = scene.setup.lens.focal_length / scene.imaging.entrance_pupil;
  scene.camera = build_camera(scene.setup);
  return renderer.render(scene, virtual_dots, RenderImages::no, RenderTheory::no).truth.displacement_px;
}

PointTruth truth_of_vectors(PreparedCase const& prepared, Renderer& renderer, std::vector<Vec2d> const& position_px,
                            TruthAt at) {
  Scene scene = prepared.scene;  // a copy: virtual dots may want a wider pupil than the images were made with
  PointTruth truth;
  if (scene.setup.piv) {
    ParticlePoints points = particle_points(scene, renderer, position_px, at);
    return {std::move(points.seen), {}, std::move(points.flow_px), std::move(points.ambient_px)};
  }
  truth.point = truth_at_points(scene, renderer, position_px, at, RenderTheory::yes);
  truth.thin_lens = ideal_lens_truth(scene, renderer, truth.point);
  return truth;
}

Comparison compare_case(std::string const& folder, Device const& device, CompareOptions const& options) {
  ComparedFiles files = compared_files(folder, options.vectors);
  if (!files.unverified.empty()) {
    spdlog::warn(
        "unverified: {} carries no SHA-256 of its frames, so nothing tells whether {} was measured on this case",
        files.unverified, files.vectors);
  }
  CaseSetup loaded = load_case_setup(files.setup, {});
  GroundTruth const dots = read_truth(files.truth);
  MeasuredVectors vectors = load_vectors(files.vectors, loaded, dots, options);
  PreparedCase const prepared = prepare_case(loaded);
  std::optional<RenderedCase> rendered;
  if (!vectors.foreign) rendered = render_case(prepared, *device.renderer, RenderTheory::no);
  PointTruth point = truth_of_vectors(prepared, *device.renderer, vectors.field.position_px, options.truth_at);
  Comparison comparison = compare_vectors(prepared, dots, rendered ? &*rendered : nullptr, std::move(vectors),
                                          std::move(point), device, options.truth_at);
  name_sources(comparison, std::move(files));
  return comparison;
}

Comparison compare_vectors(PreparedCase const& prepared, GroundTruth const& dots, RenderedCase const* rendered,
                           MeasuredVectors vectors, PointTruth truth, Device const& device, TruthAt at) {
  Comparison comparison;
  comparison.measured = std::move(vectors.field);
  comparison.report = vectors.report;
  comparison.foreign = vectors.foreign;
  comparison.left_out = vectors.left_out;
  comparison.detected = vectors.detected;
  comparison.point = std::move(truth.point);
  comparison.thin_lens = std::move(truth.thin_lens);
  comparison.flow_px = std::move(truth.flow_px);
  comparison.ambient_px = std::move(truth.ambient_px);
  if (prepared.scene.setup.piv) comparison.chain = BudgetChain::piv;
  DisplacementField const& measured = comparison.measured;

  CorrelationSettings const& settings = vectors.settings;
  WindowWeight const weight{[&settings](double dx, double dy) { return window_weight(settings, dx, dy); },
                            window_support_px(settings)};
  comparison.window =
      window_truth(dots.reference_px, dots.displacement_px, correlation_flux(dots), measured.position_px, weight, at);
  if (rendered) {
    Detector const detector(prepared.scene.setup.camera, rendered->exposure_e);
    DisplacementField again = correlate_frames(*rendered->rendering->kept->ideal(detector), settings, device).field;
    if (again.size() == measured.size()) comparison.noise_free = std::move(again.displacement_px);
  }

  bool const piv = comparison.chain == BudgetChain::piv;
  std::vector<std::span<Vec2d const>> references{comparison.point.displacement_px, comparison.window.displacement_px};
  if (piv) {
    references.insert(references.end(), {comparison.flow_px, comparison.ambient_px});
  } else {
    references.insert(references.end(), {comparison.point.eq9_px, comparison.point.eq9_cone_px, comparison.thin_lens});
  }
  if (!comparison.noise_free.empty()) references.emplace_back(comparison.noise_free);
  comparison.mask = common_mask(measured, references);
  if (std::none_of(comparison.mask.begin(), comparison.mask.end(), [](auto counts) { return counts != 0; })) {
    throw DataError(
        vectors.name,
        "has no vector that can be compared: none is valid, in view and has truth on its window (three dots); check "
        "the vectors and --conventions");
  }
  std::vector<BudgetStage> stages{{"window", comparison.window.displacement_px},
                                  {"noise_free", comparison.noise_free},
                                  {"measured", measured.displacement_px}};
  if (piv) {
    stages.insert(
        stages.end(),
        {{"flow", comparison.flow_px}, {"ambient", comparison.ambient_px}, {"seen", comparison.point.displacement_px}});
  } else {
    stages.insert(stages.end(), {{"eq9", comparison.point.eq9_px},
                                 {"straight", comparison.point.chief_px},
                                 {"eq9_cone", comparison.point.eq9_cone_px},
                                 {"thin_lens", comparison.thin_lens},
                                 {"lens", comparison.point.displacement_px}});
  }
  comparison.budget = error_budget(stages, comparison.mask, comparison.chain);
  return comparison;
}

nlohmann::ordered_json errors_of(Comparison const& comparison) {
  nlohmann::ordered_json json;
  auto const summary = [&](std::vector<Vec2d> const& truth) {
    nlohmann::ordered_json measures;
    for (auto const& [name, value] :
         error_measures(comparison.measured.displacement_px, truth, comparison.mask, comparison.vectors_in_file())) {
      measures[std::string(name)] = name == "count" ? nlohmann::json(static_cast<long long>(value)) : number(value);
    }
    return measures;
  };
  json["ray_truth"] = summary(comparison.point.displacement_px);
  if (comparison.chain == BudgetChain::piv) {
    json["flow"] = summary(comparison.flow_px);
    json["ambient_truth"] = summary(comparison.ambient_px);
    json["eq9"] = json["eq9_cone"] = nullptr;  // it is of BOS
  } else {
    json["eq9"] = summary(comparison.point.eq9_px);
    json["eq9_cone"] = summary(comparison.point.eq9_cone_px);
  }
  json["window_truth"] = summary(comparison.window.displacement_px);
  if (nlohmann::ordered_json const quality = uncertainty_json(comparison); !quality.empty())
    json["uncertainty"] = quality;
  nlohmann::ordered_json budget;
  nlohmann::json names = nlohmann::json::array();
  for (BudgetTerm const& term : comparison.budget.terms) {
    budget["terms"][term.name] = term_json(term);
    names.push_back(term.name);
  }
  budget["total"] = term_json(comparison.budget.total);
  budget["covariance"] = {{"terms", names},
                          {"both_px2", matrix_json(comparison.budget.covariance)},
                          {"u_px2", matrix_json(comparison.budget.covariance_u)},
                          {"v_px2", matrix_json(comparison.budget.covariance_v)}};
  budget["peak_locking_px"] = number(comparison.budget.peak_locking_px);
  budget["closure_px"] = number(comparison.budget.closure_px);
  json["budget"] = budget;
  json["vectors"] = {{"total", comparison.vectors_in_file()},
                     {"left_out_fewer_than_three_dots", comparison.window.left_out},
                     {"conventions", comparison.report}};
  LeftOutVectors const& left_out = comparison.left_out;
  if (comparison.foreign || left_out.all() > 0) {  // what a study measures itself has none
    json["vectors"].update({{"left_out_place_not_finite", left_out.place_not_finite},
                            {"left_out_outside_image", left_out.outside_image},
                            {"left_out_displacement_not_finite", left_out.displacement_not_finite},
                            {"left_out_displacement_beyond_image", left_out.displacement_beyond_image}});
  }
  if (comparison.detected) json["vectors"]["fit"] = fit_json(*comparison.detected);
  if (!comparison.sources.all().empty()) {
    nlohmann::ordered_json made_from;
    for (SourceFiles::Source const& source : comparison.sources.all()) {
      if (!source.name.empty()) made_from[source.name + "_sha256"] = source.sha256;
    }
    made_from["frames"] = comparison.verified ? "verified" : "unverified";
    json["made_from"] = made_from;
  }
  return json;
}

std::string errors_json(Comparison const& comparison) { return json_text(errors_of(comparison)) + "\n"; }

std::vector<std::string> draw_comparison(std::string const& folder, Comparison const& comparison,
                                         std::string const& format) {
  DisplacementField const& measured = comparison.measured;
  bool const piv = comparison.chain == BudgetChain::piv;
  std::vector<std::string> drawn;
  auto const next = [&](char const* name) { return drawn.emplace_back(folder + '/' + name + '.' + format); };
  auto const difference = [&](std::vector<Vec2d> const& from) {
    std::vector<Vec2d> error(measured.size());
    for (std::size_t i = 0; i < error.size(); ++i) {
      error[i] = comparison.mask[i] ? measured.displacement_px[i] - from[i] : Vec2d{std::nan(""), std::nan("")};
    }
    return error;
  };
  if (measured.columns > 1 && measured.rows > 1) {
    auto const maps = [&](std::string name, std::vector<Vec2d> const& values) {
      NamedMaps both{std::move(name), Image<double>(measured.columns, measured.rows),
                     Image<double>(measured.columns, measured.rows)};
      for (std::size_t i = 0; i < values.size(); ++i) {
        both.u_px.data()[i] = values[i].x;
        both.v_px.data()[i] = values[i].y;
      }
      return both;
    };
    MapAxes axes;
    axes.x_first = measured.position_px.front().x;
    axes.x_step = measured.position_px[1].x - axes.x_first;
    axes.y_first = measured.position_px.front().y;
    axes.y_step = measured.position_px[static_cast<std::size_t>(measured.columns)].y - axes.y_first;
    std::vector<NamedMaps> drawings{maps("ray truth", comparison.point.displacement_px)};
    if (piv) {
      drawings.push_back(maps("flow", comparison.flow_px));
      drawings.push_back(maps("without medium", comparison.ambient_px));
    } else {
      drawings.push_back(maps("Eq. 9", comparison.point.eq9_px));
      drawings.push_back(maps("cone-filtered Eq. 9", comparison.point.eq9_cone_px));
    }
    drawings.push_back(maps("measurement", measured.displacement_px));
    write_displacement_maps(next("displacement_maps"), "Displacement, and differences from ray truth", axes, drawings);
  }
  std::vector<ErrorSeries> series{{"against ray truth", difference(comparison.point.displacement_px)}};
  if (piv) {
    series.push_back({"against the flow", difference(comparison.flow_px)});
    series.push_back({"against truth without medium", difference(comparison.ambient_px)});
  } else {
    series.push_back({"against Eq. 9", difference(comparison.point.eq9_px)});
    series.push_back({"against cone-filtered Eq. 9", difference(comparison.point.eq9_cone_px)});
  }
  write_error_histograms(next("error_histograms"), "Measurement error", series);
  if (measured.columns > 1 && measured.rows > 1) {
    DisplacementField truth = measured;
    truth.displacement_px = comparison.point.displacement_px;
    write_error_against_gradient(next("error_against_gradient"), "Measurement error against the local gradient", truth,
                                 series);
  }
  write_budget_bars(
      next("error_budget"),
      piv ? "Error budget, from the flow to the measurement" : "Error budget, from Eq. 9 to the measurement",
      comparison.budget);
  return drawn;
}

}  // namespace gladstone
