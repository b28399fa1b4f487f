#include "tests/architecture/adding_rows.h"

namespace gladstone::architecture {
namespace {

/// Finds the definitions of functions whose names begin with a prefix.
std::regex function(std::string const& prefix) { return std::regex("\\b(" + prefix + "_\\w+)\\([^;{}]*\\) \\{"); }

}  // namespace

std::vector<Row> const& rows() {
  static std::string const fields = "render/medium/fields", flows = "render/light/flows";
  static std::regex const kind("struct (\\w+)[^;{]*\\{\\s+(?:using [^;]+;\\s+)*static constexpr char const\\* kind");
  static std::vector<Row> const table{
      {"density field",
       fields,
       kind,
       {"render/medium/closed_forms.h"},
       // a moving shock and the density behind it are set by one table; a uniform gradient is the cost of a cheap
       // medium
       {{"NormalShock", {"render/scene/experiments/piv.cpp"}}, {"UniformGradient", {"studies/case/render_cost.cpp"}}}},
      {"velocity field",
       flows,
       kind,
       {"render/light/flow.h"},
       {{"NormalShockFlow", {"render/light/flow.cpp", "render/scene/experiments/piv.cpp"}},
        {"UniformFlow", {"render/light/flow.cpp"}},  // the flow of a setup without [flow]
        // it refers to memory that its owner keeps, on the host and on a GPU
        {"FileFlow",
         {"render/light/velocity_file.h", "render/light/velocity_file.cpp",
          "cuda/ideal_images/cuda_pair_batches.cpp"}}}},
      {"optical element",
       "render/optics/elements",
       kind,
       {"render/optics/element_kinds.h"},
       // views are those of a plenoptic camera, and so is what an overview says about them
       {{"LensletSetup",
         {"studies/case/plenoptic_views.h", "studies/case/plenoptic_views.cpp", "studies/design/setup_overview.cpp"}}}},
      {"lens surface",
       "render/optics",
       std::regex("struct (\\w+) \\{\\n(?:[^\\n]*\\n){1,8}?  GLADSTONE_HD T sag\\("),
       {"render/optics/lens_surface.h", "render/optics/lens.cpp"},
       // the number of their terms limits what files may prescribe; faces of plates and stops are planes
       {{"EvenAsphere",
         {"render/optics/prescription_readers/zmx_surface.cpp", "render/optics/prescription_readers/seq_surface.cpp",
          "render/optics/prescription_readers/toml.cpp"}},
        {"RadialAsphere", {"render/optics/prescription.h", "render/optics/prescription_readers/zmx_surface.cpp"}},
        {"Quadric",
         {"render/optics/even_asphere.h", "render/optics/radial_asphere.h", "render/optics/elements/glass_plate.h",
          "render/scene/build_camera.cpp"}}}},
      {"reader of fields",
       "render/files/fields/readers",
       std::regex(
           "^std::unique_ptr<CheckedSource> (open_(?!array_field)\\w+)\\([^;{}]*FieldSelection const& selection\\) \\{",
           std::regex::multiline),
       {"render/files/fields/field_file.cpp", "render/files/fields/readers/vtk.h"},
       {{"open_hdf5", {"render/files/fields/readers/matlab.cpp"}}}},  // MATLAB 7.3 writes HDF5
      {"reader of lens prescriptions",
       "render/optics/prescription_readers",
       std::regex("^Prescription (read_\\w+)\\([^;]*\\{", std::regex::multiline),
       {"render/optics/prescription.cpp", "render/optics/prescription_readers/readers.h"}},
      {"reader of vectors",
       "analysis/vectors/vector_readers",
       std::regex("\\bbool (is_\\w+)\\(TextTable const& table\\) \\{"),
       {"analysis/vectors/vector_file.cpp", "analysis/vectors/vector_readers/vector_readers.h"}},
      {"correlator",
       "analysis/correlation/methods",
       function("correlate"),
       {"analysis/correlation/correlation_methods.cpp", "analysis/correlation/correlation_methods.h"}},
      {"subpixel fit",
       "analysis/correlation/subpixel",
       function("fit"),
       {"analysis/correlation/subpixel_fit.cpp", "analysis/correlation/subpixel_fit.h"},
       // the default, which is computed for several windows at a time; an uncertainty method is defined by this fit
       {{"fit_gauss3",
         {"analysis/correlation/interrogation_job.h", "analysis/correlation/lane_peaks.cpp",
          "analysis/correlation/subpixel/centroid.cpp", "analysis/uncertainty/moment_of_correlation.cpp"}}}},
      {"mask",
       "analysis/preparation/masks",
       function("make"),
       {"analysis/preparation/frame_changes.h", "studies/case/preparation_setup.cpp"}},
      {"preprocessing step",
       "analysis/preparation/steps",
       function("make"),
       {"analysis/preparation/frame_changes.h", "studies/case/preparation_setup.cpp"}},
      {"kind of experiment",
       "render/scene/experiments",
       std::regex("\\bExperiment const (\\w+_experiment)\\{"),
       // the list, the experiment of a setup in memory, and the rows of overview, design sheet and layout
       {"render/scene/experiment.h", "render/scene/experiment.cpp", "studies/design/setup_overview.cpp",
        "studies/design/design.cpp", "studies/report/layout_view.cpp"},
       // the cases and comparisons of the experiment, and commands for this experiment alone
       {{"bos_experiment",
         {"studies/case/kinds/bos.cpp", "studies/compare/kinds/bos.cpp", "studies/compare/reconstruct_case.cpp",
          "studies/compare/tomography_view.cpp"}},
        {"piv_experiment",
         {"studies/case/kinds/piv.cpp", "studies/compare/kinds/piv.cpp", "studies/compare/stereo_input.cpp",
          "studies/commands/info_particles.cpp"}},
        {"calibration_experiment", {"studies/case/kinds/calibration.cpp", "studies/compare/calibrate.cpp"}}}},
      {"uncertainty method",
       "analysis/uncertainty",
       std::regex("\\bstd::vector<Vec2d> (\\w+)\\(UncertaintyInput const& \\w+\\) \\{"),
       {"analysis/uncertainty/uncertainty.h", "analysis/uncertainty/uncertainty.cpp"},
       // computed on a GPU, and recommended by messages
       {{"correlation_statistics",
         {"cuda/correlation/correlation_statistics.cu", "cuda/correlation/cuda_correlator.cpp",
          "studies/compare/stereo_input.cpp", "studies/compare/stereo_warnings.cpp",
          "studies/compare/reconstruct.cpp"}}}},
      {"light source",
       "render/scene",
       std::regex("\\bSourceKind const (\\w+)\\{"),
       {"render/scene/source_kind.h"},
       {{"dot_sources", {"render/scene/experiments/bos.cpp", "render/scene/experiments/calibration.cpp"}},
        // also a function, which returns the particles of a scene
        {"particle_sources",
         {"render/scene/experiments/piv.cpp", "render/rays/trace_particles.h", "render/rays/stop_rule.h",
          "render/rays/particle_tracer.h", "cuda/rays/trace_particles.h"}}},
       false,
       2},
      {"name of a correlation method",
       "analysis/correlation",
       std::regex("CorrelationMethod\\{\\.name = \"(\\w+)\""),
       {"analysis/correlation/correlation_methods.cpp",
        "studies/benchmark/benchmark_run.cpp"},  // estimators of `gladstone benchmark`
       // the default; "tracking" is also a table of a setup
       {{"scc", {"analysis/correlation/correlation_settings.h", "analysis/tracking/tracking_correlator.cpp"}},
        {"tracking", {"studies/case/correlation_setup.cpp"}}},
       true},
      {"name of a subpixel fit",
       "analysis/correlation",
       std::regex("SubpixelMethod\\{\\.name = \"(\\w+)\""),
       {"analysis/correlation/subpixel_fit.cpp", "studies/benchmark/benchmark_run.cpp"},
       {{"gauss3", {"analysis/correlation/correlation_settings.h"}}},  // the default
       true},
      {"name of an uncertainty method",
       "analysis/uncertainty",
       std::regex("NamedUncertainty\\{\"(\\w+)\""),
       {"analysis/uncertainty/uncertainty.cpp"},
       // recommended by a message; also a column of vector files; learnt from the others
       {{"correlation_statistics", {"studies/compare/stereo_input.cpp"}},
        {"peak_ratio",
         {"analysis/vectors/vector_readers/netcdf.cpp", "analysis/vectors/vector_readers/named_columns.cpp",
          "analysis/vectors/vector_readers/gladstone.cpp", "analysis/vectors/vector_readers/own_columns.cpp",
          "analysis/vectors/vector_writers/netcdf.cpp", "analysis/vectors/vector_writers/vector_columns.cpp",
          "python/src/bind_field.cpp"}},
        {"combination", {"studies/benchmark/benchmark_coverage.cpp"}}},
       true},
      {"name of a density solver",
       "analysis/density",
       std::regex("(?:IntegrationMethod|AbelMethod)\\{\"(\\w+)\""),
       {"analysis/density/density_methods.cpp"},
       // defaults
       {{"wls", {"analysis/density/density_integrator.h", "studies/compare/reconstruct.h"}},
        {"direct", {"analysis/density/axisymmetric_inversion.h", "studies/compare/reconstruct.h"}}},
       true},
      {"requirement of a design",
       "studies/design",
       std::regex("Bound\\{\\.name = \"([^\"]+)\""),
       {"studies/design/bounds.cpp"},
       // it can contradict the limits of the distances
       {{"limits.z_total_max_mm", {"studies/design/question.cpp"}}},
       true},
      {"name of an error measure",
       "analysis/errors",
       std::regex("ErrorMeasure\\{(?:\\.name = )?\"(\\w+)\""),
       // the table, texts and figures that select some measures, and the budget, whose terms have some of these keys
       {"analysis/errors/error_summary.cpp", "studies/benchmark/benchmark_page.cpp",
        "studies/benchmark/benchmark_results.cpp", "studies/report/case_view.cpp", "studies/figures/error_figures.cpp",
        "studies/compare/comparison_results.cpp"},
       // also keys of other results
       {{"count",
         {"analysis/errors/uncertainty_quality.cpp", "analysis/errors/error_summary.h",
          "studies/benchmark/benchmark_results.cpp", "studies/compare/stereo_scores.cpp",
          "studies/compare/density_file.cpp", "studies/compare/stereo_file.cpp"}},
        {"gross",
         {"analysis/errors/uncertainty_quality.cpp", "studies/benchmark/benchmark_results.cpp",
          "studies/compare/stereo_scores.cpp"}},
        {"rms_px",
         {"studies/sweep/case_runner.cpp", "studies/examples/demo.cpp", "studies/compare/calibration_results.cpp",
          "studies/compare/comparison_warnings.cpp", "studies/compare/stereo_scores.cpp",
          "studies/compare/stereo_file.cpp", "python/src/bind_case.cpp"}}},
       true},
      {"kind of comparison",
       "studies/compare/kinds",
       std::regex("\\bComparisonKind const (\\w+_comparison)\\{"),
       {"studies/compare/comparison_kind.h"},
       // the uncertainty of a density and its report concern BOS alone
       {{"bos_comparison", {"studies/design/measurement_inputs.cpp", "studies/report/measured_findings.cpp"}}},
       false,
       2},
      {"writer of vectors",
       "analysis/vectors/vector_writers",
       std::regex("^void (write_vector_(?!bytes|columns)\\w+)\\([^;{}]*\\) \\{", std::regex::multiline),
       {"analysis/vectors/vector_file.cpp", "analysis/vectors/vector_writers/vector_writers.h"}},
      {"template of init",
       "studies/commands",
       std::regex("Template\\{\"\\w+\", &embedded::(\\w+)"),
       {"studies/commands/embedded_text.h"}},
      {"kind of case",
       "studies/case/kinds",
       std::regex("\\bCaseKind const (\\w+_case_kind)\\{"),
       {"studies/case/case_kind.h"}},
      {"command",
       "studies/commands",
       function("attach"),
       {"studies/commands/command.h", "studies/main.cpp",
        "studies/commands/sweep.cpp"}},  // plan, run, collect: in sweep
  };
  return table;
}

}  // namespace gladstone::architecture
