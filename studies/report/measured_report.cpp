#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "analysis/errors/error_summary.h"
#include "analysis/vectors/vector_file.h"
#include "render/base/content_hash.h"
#include "render/base/text_file.h"
#include "studies/case_files.h"
#include "studies/design/measurement_inputs.h"
#include "studies/design/sheet.h"
#include "studies/figures/map_panels.h"
#include "studies/report/bench_view.h"
#include "studies/report/case_view.h"
#include "studies/report/measured_density.h"
#include "studies/report/report.h"
#include "studies/report/simulated_twin.h"
#include "studies/sweep/job_array.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;

/// Gradients at measured vectors, with what they are uncertain by. Components along X and Y of the world.
struct MeasuredGradients {
  std::vector<Vec2d> gradient;  ///< NaN where a vector does not count [kg/m^4]
  std::vector<Vec2d> random;    ///< standard uncertainty by the displacement's
  std::vector<Vec2d> combined;  ///< with that of the setup's numbers
  std::size_t estimated = 0;    ///< of vectors whose displacement's uncertainty is the estimator's, else the formula's
  double common = 0;            ///< relative, of the setup's numbers
  std::size_t count = 0;        ///< of vectors
};

/// What the repeats of a measurement tell of its mean (JCGM 100:2008, 4.2), beside what is known of each of them.
struct MeanOfRepeats {
  DisplacementField field;  ///< of the mean, with its standard deviation for uncertainty; of one measurement as it is
  std::size_t count = 1;
  double estimated_px = 0;  ///< the mean's uncertainty by what every measurement says of itself, median over components
};

/// The mean of several measurements at the same vectors, those that count in all of them.
/// @param formula_px random error of one that does not say
MeanOfRepeats mean_of_repeats(std::vector<DisplacementField> const& all, double formula_px) {
  MeanOfRepeats mean;
  mean.field = all.front();
  mean.count = all.size();
  if (mean.count == 1) return mean;
  DisplacementField& field = mean.field;
  auto const n = static_cast<double>(mean.count);
  std::vector<double> estimated;
  field.sigma_px.assign(field.size(), {std::nan(""), std::nan("")});
  field.status.resize(field.size(), VectorStatus::valid);
  for (std::size_t i = 0; i < field.size(); ++i) {
    Vec2d sum, squares, variance;
    bool counts = true;
    for (DisplacementField const& one : all) {
      Vec2d const d = one.displacement_px[i];
      counts = counts && one.counts(i) && std::isfinite(d.x) && std::isfinite(d.y);
      sum += d;
      Vec2d own = one.sigma_px.empty() ? Vec2d{formula_px, formula_px} : one.sigma_px[i];
      if (!std::isfinite(own.x) || !std::isfinite(own.y)) own = {formula_px, formula_px};
      variance += {own.x * own.x, own.y * own.y};
    }
    if (!counts) {
      field.status[i] = VectorStatus::invalid;
      continue;
    }
    field.displacement_px[i] = sum / n;
    for (DisplacementField const& one : all) {
      Vec2d const off = one.displacement_px[i] - field.displacement_px[i];
      squares += {off.x * off.x, off.y * off.y};
    }
    field.sigma_px[i] = {std::sqrt(squares.x / (n - 1) / n), std::sqrt(squares.y / (n - 1) / n)};
    estimated.push_back(std::sqrt(variance.x) / n);
    estimated.push_back(std::sqrt(variance.y) / n);
  }
  mean.estimated_px = estimated.empty() ? std::nan("") : quantile(estimated, 0.5);
  return mean;
}

MeasuredGradients gradients_of(DisplacementField const& field, Bench<double> const& bench, double common) {
  MeasuredGradients all;
  all.common = common;
  double const per_px = 1 / bench.sensitivity(), formula = bench.random_error();
  for (std::size_t i = 0; i < field.size(); ++i) {
    bool const counts =
        field.counts(i) && std::isfinite(field.displacement_px[i].x) && std::isfinite(field.displacement_px[i].y);
    Vec2d const unknown{std::nan(""), std::nan("")};
    if (!counts) {
      all.gradient.push_back(unknown);
      all.random.push_back(unknown);
      all.combined.push_back(unknown);
      continue;
    }
    ++all.count;
    Vec2d sigma = field.sigma_px.empty() ? unknown : field.sigma_px[i];
    if (std::isfinite(sigma.x) && std::isfinite(sigma.y)) {
      ++all.estimated;
    } else {
      sigma = {formula, formula};
    }
    Vec2d const g = Vec2d{-field.displacement_px[i].x, field.displacement_px[i].y} * per_px;
    Vec2d const random = sigma * per_px;
    all.gradient.push_back(g);
    all.random.push_back(random);
    all.combined.push_back({std::hypot(random.x, common * g.x), std::hypot(random.y, common * g.y)});
  }
  return all;
}

std::vector<double> finite_components(std::vector<Vec2d> const& values) {
  std::vector<double> found;
  for (Vec2d const& value : values) {
    for (double const one : {value.x, value.y}) {
      if (std::isfinite(one)) found.push_back(one);
    }
  }
  return found;
}

double rms_of(std::vector<double> const& values) {
  double sum = 0;
  for (double const value : values) sum += value * value;
  return values.empty() ? std::nan("") : std::sqrt(sum / static_cast<double>(values.size()));
}

void add_map(nlohmann::json& fields, std::string const& name, std::string const& title, std::string const& unit,
             std::vector<Vec2d> const& values) {
  fields.push_back({{"name", name},
                    {"title", title},
                    {"unit", unit},
                    {"u", component_json(values, &Vec2d::x)},
                    {"v", component_json(values, &Vec2d::y)}});
}

/// Where the displacements' uncertainty comes from.
std::string source_of_sigma(MeasuredGradients const& all) {
  if (all.estimated == all.count) return "the estimator's own, from the images";
  if (all.estimated == 0) return "by the formula of the random error (F26), since the vectors have none";
  return fmt::format(
      "the estimator's own, from the images, at {} vectors, and by the formula of the random error (F26) at {} that "
      "have none",
      all.estimated, all.count - all.estimated);
}

/// Displacement, gradient and its combined standard uncertainty on the lattice of the vectors.
std::string draw_maps(std::string const& path, DisplacementField const& field, MeasuredGradients const& all) {
  MapFigure figure;
  figure.title = "Measured displacement, density gradient and its combined standard uncertainty";
  figure.axes.x_first = field.position_px.front().x;
  figure.axes.y_first = field.position_px.front().y;
  figure.axes.x_step = field.position_px[1].x - figure.axes.x_first;
  figure.axes.y_step = field.position_px[static_cast<std::size_t>(field.columns)].y - figure.axes.y_first;
  auto const add = [&](std::string const& title, std::vector<Vec2d> const& values, double Vec2d::*component,
                       ColourScale scale, std::string const& group) {
    Image<double> map(field.columns, field.rows);
    for (std::size_t i = 0; i < values.size(); ++i) map.data()[i] = values[i].*component;
    figure.panels.push_back({title, std::move(map), scale, group});
  };
  add("u [px]", field.displacement_px, &Vec2d::x, ColourScale::diverging, "displacement");
  add("v [px]", field.displacement_px, &Vec2d::y, ColourScale::diverging, "displacement");
  add("∂ρ/∂x [kg/m⁴]", all.gradient, &Vec2d::x, ColourScale::diverging, "gradient");
  add("∂ρ/∂y [kg/m⁴]", all.gradient, &Vec2d::y, ColourScale::diverging, "gradient");
  add("u_c of ∂ρ/∂x [kg/m⁴]", all.combined, &Vec2d::x, ColourScale::magnitude, "uncertainty");
  add("u_c of ∂ρ/∂y [kg/m⁴]", all.combined, &Vec2d::y, ColourScale::magnitude, "uncertainty");
  write_map_figure(path, figure);
  return path;
}

/// Statements in the words of the GUM (JCGM 100:2008).
std::vector<std::string> statements(MeasuredGradients const& all, PropagatedResult const& gradient,
                                    std::vector<MeasurementInput> const& inputs, SimulatedTwin const* twin,
                                    double sensitivity, MeanOfRepeats const& mean) {
  std::vector<double> const combined = finite_components(all.combined);
  double const median = quantile(combined, 0.5);
  std::vector<std::string> said;
  said.push_back(fmt::format(
      "The measurand is the density gradient, averaged over the thickness, at each of {} vectors: rms {:.4g} kg/m^4. "
      "Its "
      "combined standard uncertainty is {:.3g} kg/m^4 in the median of the components ({:.3g} to {:.3g} kg/m^4 for 10 "
      "to "
      "90 % of them).",
      all.count, rms_of(finite_components(all.gradient)), median, quantile(combined, 0.1), quantile(combined, 0.9)));
  said.push_back(fmt::format(
      "The expanded uncertainty in the median is U = {:.3g} kg/m^4 = k u_c with a coverage factor k = {:.2f} "
      "(effective "
      "degrees of freedom {}) for a coverage probability of 95.45 %.",
      gradient.coverage_factor * median, gradient.coverage_factor,
      gradient.degrees_of_freedom < 1e6 ? fmt::format("{:.3g}", gradient.degrees_of_freedom) : "infinite"));
  if (mean.count > 1) {
    said.push_back(fmt::format(
        "The uncertainty of the displacement is of type A: the standard deviation of the mean of {} repeats, {:.3g} px "
        "rms over vectors and components, with {} degrees of freedom at each of them. What the measurements say of "
        "themselves, of type B, would make it {:.3g} px in the median; it is not added.",
        mean.count, inputs.front().sigma, mean.count - 1, mean.estimated_px));
  } else {
    said.push_back(fmt::format(
        "The uncertainty of the displacement is of type B: {}. There is no evaluation of type A, for which the "
        "measurement would have to be repeated (--repeats).",
        source_of_sigma(all)));
  }
  if (inputs.size() > 1) {
    said.push_back(fmt::format(
        "The numbers of the setup that are written with their uncertainty are of type B, {}, and the same at all "
        "vectors: together {:.3g} % of the gradient. {}",
        correlation_texts(inputs).empty() ? "taken for independent"
                                          : fmt::format("correlated ({})", fmt::join(correlation_texts(inputs), "; ")),
        100 * all.common,
        gradient.linear
            ? "The first order holds (JCGM 101:2008)."
            : "The propagation is not linear, or not normal: intervals of samples (JCGM 101:2008) differ."));
  } else {
    said.emplace_back(
        "No number of the setup is written with its uncertainty, { value = ..., sigma = ... }: distances, focal "
        "length, "
        "pixel pitch, K and thickness count as known exactly.");
  }
  if (twin && twin->failed.empty()) {
    said.push_back(fmt::format(
        "Not in it is the uncorrected bias. In the simulated twin, which has the density that was measured as its "
        "medium, what repeats share is off by {:.3g} px rms, {:.3g} kg/m^4; what is finer than the measurement "
        "resolved is "
        "not in the twin, so that the bias may be larger.",
        twin->bias_px, twin->bias_px / sensitivity));
  } else {
    said.emplace_back("Not in it is the uncorrected bias, which is not known: there is no simulated twin.");
  }
  return said;
}

TextTable inputs_table(std::vector<MeasurementInput> const& inputs, PropagatedResult const& gradient,
                       MeanOfRepeats const& mean) {
  TextTable table{"What the gradient of a vector of typical displacement is uncertain by",
                  {"input", "type", "value", "standard uncertainty", "distribution", "degrees of freedom",
                   "part of u(gradient) [kg/m^4]", "share of the variance [%]"},
                  {}};
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    Contribution const& part = gradient.contributions[i];
    bool const finite = std::isfinite(inputs[i].degrees_of_freedom);
    table.rows.push_back({{inputs[i].key},
                          {i == 0 && mean.count > 1 ? "A" : "B"},
                          TableCell::of(inputs[i].value),
                          TableCell::of(inputs[i].sigma),
                          {to_string(inputs[i].distribution)},
                          finite ? TableCell::of(inputs[i].degrees_of_freedom) : TableCell{"infinite"},
                          TableCell::of(part.standard),
                          TableCell::of(100 * part.share)});
  }
  return table;
}

DisplacementField read_measured(std::string const& path, ReportOptions const& options, CameraSetup const& camera) {
  VectorFile file = read_vectors(path);
  if (!options.conventions.empty()) file.conventions = parse_conventions(options.conventions, file.conventions);
  DisplacementField field = file.foreign || !options.conventions.empty()
                                ? apply_conventions(std::move(file.field), file.conventions, camera.rows)
                                : std::move(file.field);
  if (field.columns == 0) arrange_as_grid(field);
  return field;
}

/// A measurement and its repeats. @throws DataError where one has its vectors elsewhere
std::vector<DisplacementField> read_repeats(std::string const& vectors_file, ReportOptions const& options,
                                            CameraSetup const& camera) {
  std::vector<DisplacementField> all{read_measured(vectors_file, options, camera)};
  for (std::string const& file : options.repeats) {
    DisplacementField one = read_measured(file, options, camera);
    bool same = one.size() == all.front().size();
    for (std::size_t i = 0; same && i < one.size(); ++i) {
      same = length(one.position_px[i] - all.front().position_px[i]) < 1e-3;
    }
    if (!same) {
      throw DataError(file, "has its vectors at other places than " + vectors_file +
                                " (the scatter of repeats is told at every vector); correlate all of them with one "
                                "configuration");
    }
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace

ReportPage measured_report(ReportOptions const& options, Device const& device) {
  std::string const own_vectors = in_case(options.source, case_file::vectors);
  std::string const setup_file = (fs::path(options.source) / case_file::setup).string();
  SetupDocument document = SetupDocument::from_file(setup_file);
  std::vector<UncertainInput> const uncertain = take_uncertain_inputs(document);
  CaseSetup const loaded = load_case_setup(std::move(document));
  if (loaded.setup.piv || loaded.setup.calibration() || !loaded.setup.on_bench()) {
    throw DataError(
        setup_file,
        "is of no BOS bench (the uncertainty of a measurement is told of a thin lens on the axis, square to "
        "the dots); describe the measurement by one");
  }
  std::string const vectors_file = options.vectors.empty() ? own_vectors : options.vectors;
  BenchGiven const given = bench_given(loaded);
  Bench<double> const bench = bench_of(loaded.setup, given);
  MeanOfRepeats const mean =
      mean_of_repeats(read_repeats(vectors_file, options, loaded.setup.camera), bench.random_error());
  DisplacementField const& field = mean.field;

  // a vector of typical displacement and uncertainty stands for all in the table
  std::vector<double> displacement = finite_components(field.displacement_px);
  std::vector<double> sigma = finite_components(field.sigma_px);
  if (displacement.empty())
    throw DataError(vectors_file, "has no vector with a displacement; correlate the images anew");
  bool const repeated = mean.count > 1;
  double const typical_sigma = repeated        ? rms_of(sigma)  // of few repeats the median is too small
                               : sigma.empty() ? bench.random_error()
                                               : quantile(sigma, 0.5);
  double const degrees = repeated ? static_cast<double>(mean.count - 1) : std::numeric_limits<double>::infinity();
  // where nothing moved, a displacement that is too small to count: the parts of the setup's numbers are relative to it
  constexpr double least_typical_px = 1e-9;
  double const typical_px = std::max(rms_of(displacement), least_typical_px);
  std::vector<MeasurementInput> inputs{{"displacement_px", typical_px, typical_sigma, InputDistribution::normal,
                                        degrees, GradientInput::displacement, 1, 1, std::nullopt}};
  for (MeasurementInput& input : measurement_inputs(loaded, uncertain, *device.renderer))
    inputs.push_back(std::move(input));
  PropagatedResult const gradient =
      propagate(gradient_measurement(loaded.setup, given.window.window_px(), inputs.front().value), inputs).front();
  MeasuredGradients const all = gradients_of(field, bench, common_relative_uncertainty(inputs, gradient));

  std::optional<SimulatedTwin> twin;
  bool const gridded = field.columns > 1 && field.rows > 1;
  if (gridded) {
    double const spacing = (field.position_px[1].x - field.position_px[0].x) * bench.pixel_at_medium();
    Vec2d const middle = (field.position_px.front() + field.position_px.back()) / 2.0;
    Vec2d const axis{(loaded.setup.camera.columns - 1) / 2.0, (loaded.setup.camera.rows - 1) / 2.0};
    Vec2d const centre = Vec2d{middle.x - axis.x, axis.y - middle.y} * bench.pixel_at_medium();
    twin = simulate_twin(loaded, integrated_density(all.gradient, field.columns, field.rows, spacing), spacing, centre,
                         open_device(device.name()));
  }

  ReportPage page;
  page.title = "Measurement " + fs::absolute(options.source).lexically_normal().filename().string();
  page.question = fmt::format("How certain are the density gradients of this measurement? {} vectors of {}.",
                              field.size(), fs::path(vectors_file).filename().string());
  std::vector<std::string> const said =
      statements(all, gradient, inputs, twin ? &*twin : nullptr, bench.sensitivity(), mean);
  page.findings = {said[0], said[1], said.back()};
  std::optional<BenchView> const drawn_bench = bench_view(load_case_setup(setup_file, {}));
  if (drawn_bench) page.sections.push_back(bench_section(*drawn_bench, "the measurement"));
  if (fs::exists(fs::path(options.source) / case_file::reference) &&
      fs::exists(fs::path(options.source) / case_file::flow)) {
    page.sections.push_back({"Images", {frame_pictures(options.source, "The two frames")}});
  }
  if (gridded) {
    nlohmann::json fields = nlohmann::json::array();
    add_map(fields, "measured", "measurement", "px", field.displacement_px);
    add_map(fields, "gradient", "density gradient, along X and Y", "kg/m^4", all.gradient);
    add_map(fields, "combined", "combined standard uncertainty of the gradient", "kg/m^4", all.combined);
    add_map(fields, "random", "part of the displacement in it", "kg/m^4", all.random);
    page.data["fields"] = std::move(fields);
    page.data["grid"] = {{"columns", field.columns},
                         {"rows", field.rows},
                         {"x", component_json(field.position_px, &Vec2d::x)},
                         {"y", component_json(field.position_px, &Vec2d::y)}};
    page.sections.push_back({"Maps", {Chart{"field", "Displacement, gradient and their uncertainty", said[0]}}});
  }
  page.sections.push_back({"Uncertainty", {TextList{said}, inputs_table(inputs, gradient, mean)}});
  ReportSection causes{"Causes of error, by the simulated twin", {}};
  if (twin && twin->failed.empty()) {
    causes.blocks.push_back(
        Paragraph{fmt::format("The density that the vectors integrate to was put before the setup's camera (its middle "
                              "{} x {} px), rendered with "
                              "its noise {} times, and measured again. Random error between repeats {:.3g} px, "
                              "systematic error {:.3g} px rms.",
                              twin->columns, twin->rows, twin->repeats, twin->random_px, twin->bias_px)});
    causes.blocks.push_back(budget_table(
        "Budget by cause, of the simulated twin and not of the measurement itself [px]", twin->comparison.budget));
  } else {
    causes.blocks.push_back(Paragraph{twin ? "There is no simulated twin: " + twin->failed
                                           : "There is no simulated twin: the vectors are no complete lattice."});
  }
  page.sections.push_back(std::move(causes));
  auto const draw = [&](std::string const& folder, std::string const& format) {
    std::vector<std::string> drawn;
    if (gridded) drawn.push_back(draw_maps(folder + "/measured_maps." + format, field, all));
    if (!drawn_bench) return drawn;
    for (std::string& path : draw_bench(folder, format, *drawn_bench)) drawn.push_back(std::move(path));
    return drawn;
  };
  if (ReportSection figures = drawn_figures(options, draw); !figures.blocks.empty()) {
    page.sections.push_back(std::move(figures));
  }
  page.sections.push_back({"Settings", {Verbatim{"The setup", read_text_file(setup_file)}}});
  std::string const place = shell_word(options.source);
  std::vector<std::pair<std::string, std::string>> sources{{"setup", file_hash(setup_file)},
                                                           {"vectors", file_hash(vectors_file)}};
  std::string command = "gladstone report " + place;
  if (!options.vectors.empty()) command += " --vectors " + shell_word(options.vectors);
  for (std::string const& file : options.repeats) {
    sources.emplace_back(fmt::format("repeat {}", sources.size()), file_hash(file));
    command += (file == options.repeats.front() ? " --repeats " : " ") + shell_word(file);
  }
  page.sections.push_back(how_it_was_made(sources, {command}));
  return page;
}

}  // namespace gladstone
