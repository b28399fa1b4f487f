#include "studies/case/case.h"

#include <fmt/format.h>

#include "render/base/units.h"
#include "render/files/text_encoding.h"
#include "render/focused_dots/focused_dots.h"
#include "render/ideal_images/ideal_images.h"
#include "render/method.h"
#include "render/planning.h"
#include "render/scene/cross_check.h"
#include "render/scene/field_coverage.h"
#include "render/scene/particle_scene.h"
#include "render/scene/read_setup.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/cameras.h"
#include "studies/case/case_kind.h"
#include "studies/case/case_warnings.h"
#include "studies/case/correlation_setup.h"
#include "studies/case/light_exposure.h"
#include "studies/case/sequence_pair.h"
#include "studies/case/uncertain_inputs.h"
#include "studies/case/usual_values.h"
#include "studies/case/warning_log.h"

namespace gladstone::inline cases {
namespace {

constexpr double least_displacement_px = 1e-6;  // displacements below this value count as zero

/// Reports a refusal by check_memory() at its key of the setup.
void cross_check_memory(CaseSetup& loaded, FieldMemory field) {
  try {
    check_memory(loaded.setup, field, focused_dots_memory(loaded.setup));
  } catch (DataError const& error) {
    if (error.code() != ErrorCode::memory) return;  // a file that cannot be read is reported by its reader
    SetupTable root = loaded.document.root();
    auto const place = [&](std::string const& path, std::vector<SetupTable> tables) {
      if (error.key() != path) return;
      SetupTable table = tables.empty() ? root.table(path.substr(0, path.find('.'))) : tables.front();
      table.problem(path.substr(path.rfind('.') + 1), error.message(), error.code());
    };
    place("camera.pixels", root.tables("camera"));
    place("medium.field.file", root.table("medium").tables("field"));
    place("medium.second_field.file", root.table("medium").tables("second_field"));
    place("target.dots_per_32px_window", {});
    place("render.rays_per_dot", {});
    place("flow.file", {});
    for (char const* const key : {"number", "per_mm3", "per_pixel", "volume_mm"}) {
      place(std::string("particles.") + key, {});
    }
  }
}

/// Rejects ideal images (method = "formula") where they are not valid, and ray tracing of particles without a
/// scattering model.
void cross_check_formula(CaseSetup& loaded) {
  Setup const& setup = loaded.setup;
  SetupTable root = loaded.document.root();
  bool const needed = setup.has_ideal_particles();
  bool const wanted = setup.render.method == RenderMethod::formula;
  std::string const reason = needed || wanted ? reason_against_ideal_images(setup) : "";
  if (wanted && !reason.empty()) {
    root.table("render").problem("method", "is not valid here (" + reason + "); use \"auto\" or \"rays\"");
  } else if (needed && !reason.empty()) {
    root.table("particles")
        .problem("scattering", "requires ideal images, which are not valid here (" + reason +
                                   "); use \"mie\" or \"lambert\", which are traced ray by ray");
  } else if (needed && setup.render.method == RenderMethod::rays) {
    root.table("render").problem("method",
                                 "conflicts with particles.scattering = \"gaussian\", which uses no rays; use "
                                 "\"formula\", or scattering = \"mie\" or \"lambert\"");
  }
}

/// Rejects the fast renderer where it is not valid.
void cross_check_method(CaseSetup& loaded) {
  cross_check_formula(loaded);
  if (loaded.setup.render.method != RenderMethod::focused_dots) return;
  std::string const reason = reason_against_focused_dots(loaded.setup);
  if (reason.empty()) return;
  loaded.document.root().table("render").problem("method",
                                                 "is not valid here (" + reason + "); use \"auto\" or \"rays\"");
}

/// Warns of a field whose size or position does not fit the view, or that ends within it without decaying to ambient.
void warn_of_field(Scene const& scene, Warnings& warnings) {
  if (scene.setup.medium.field.kind == FieldKind::none || !scene.setup.experiment().measures_density) return;
  Bounds<double> const box = std::visit([](auto const& view) { return view.bounds(); }, scene.medium.view);
  for (auto const& warning :
       {field_coverage(box, scene.setup).warning(), side_face_warning(scene.medium, scene.setup)}) {
    if (warning) warn(warnings, *warning);
  }
}

/// Warns if the defocus of ideal images is neglected although it is visible, or approximated with a visible error.
void warn_of_blur(Scene const& scene, Warnings& warnings) {
  if (resolve_render_method(scene) != RenderMethod::formula) return;
  IdealImages const ideal = *build_ideal_images(scene);
  double const blur = ideal.largest_blur_px(scene.particles), spot = 4 * scene.spot_sigma_px();
  if (scene.setup.has_ideal_particles()) {
    if (blur < 0.5 * spot) return;
    warn(warnings,
         {WarningCode::approximated, "render.method",
          fmt::format("ideal images neglect defocus, but particles of this sheet have a blur of up to {:.3g} px in "
                      "addition to the diffraction image of {:.3g} px; use a thinner sheet, a larger f-number or rays",
                      blur, spot)});
    return;
  }
  double const error = ideal.largest_blur_error(scene.particles);
  if (!(error > accurate_blur_error)) return;
  warn(warnings, {WarningCode::approximated, "render.method",
                  fmt::format("ideal images approximate a blur of up to {:.3g} px by Gaussians, with errors of up to "
                              "{:.2g} % of the brightest image; use a thinner sheet, a larger f-number or rays",
                              blur, 100 * error)});
}

/// Throws SetupError for the file of a study, in place of one problem for each of its keys.
void refuse_study(SetupDocument& document) {
  SetupTable root = document.root();
  if (!root.has("axes")) return;
  throw SetupError({{root.where("axes"),
                     "axes: belongs to a study, which varies a setup (this command requires a setup); give the setup "
                     "that its key base names, or compute the study with gladstone sweep plan",
                     "axes", ErrorCode::unknown_key}});
}

/// Reads the tables of a setup without comparing them with each other. Its document contains the problems.
CaseSetup read_tables(SetupDocument document) {
  refuse_study(document);
  std::vector<UncertainInput> uncertain = extract_uncertain_inputs(document);
  bool const first_pair_only = describes_sequence(document);
  select_pair(document);
  CaseSetup loaded{.document = with_own_lens(std::move(document)),
                   .setup = {},
                   .correlate = {},
                   .warnings = {},
                   .uncertain = std::move(uncertain),
                   .first_pair_only = first_pair_only};
  SetupTable root = loaded.document.root();
  loaded.light = read_light(root);
  loaded.setup = read_setup(root);
  if (loaded.setup.experiment().correlated) {
    loaded.correlate = read_correlation_settings(root.table("correlate"));
  } else {
    root.mark_as_read("correlate");
  }
  for (char const* const table : design_tables) root.mark_as_read(table);
  if (!loaded.correlate.window_px.empty()) loaded.setup.view_margin_px = loaded.correlate.window_px.front();
  for (std::string const& name : loaded.document.file_names()) {
    if (is_utf8(name)) continue;
    loaded.document.add_problem(
        name, "contains bytes that are not valid UTF-8, which setups require; rename the file or the folder");
  }
  return loaded;
}

/// Adds unusual values to the warnings of a setup; logs them if it has problems, which a wrong unit may cause.
void add_unusual_values(CaseSetup& loaded) {
  Warnings const unusual = unusual_values(loaded.document);
  if (loaded.document.has_problems()) {
    log_warnings(unusual);
  } else {
    loaded.warnings.insert(loaded.warnings.begin(), unusual.begin(), unusual.end());
  }
}

}  // namespace

CaseSetup load_case_setup(std::string const& path, std::vector<std::string> const& overrides) {
  return load_case_setup(read_setup_document(path, overrides));
}

CaseSetup load_case_setup(SetupDocument document, FieldMemory field) {
  CaseSetup loaded = read_tables(std::move(document));
  check_case_setup(loaded, field);
  return loaded;
}

void check_case_setup(CaseSetup& loaded, FieldMemory field) {
  SetupTable root = loaded.document.root();
  if (!loaded.document.has_problems()) {
    loaded.warnings = cross_check(loaded.setup, root);
    if (loaded.first_pair_only) {
      loaded.warnings.push_back(
          {WarningCode::ignored, "sequence",
           fmt::format("only its first pair, pair = {}, is considered; gladstone render renders all pairs",
                       loaded.setup.sequence ? loaded.setup.sequence->pair : 0)});
    }
    case_kind(loaded.setup).cross_check(loaded);
    cross_check_method(loaded);
  }
  if (loaded.light && !loaded.document.has_problems()) {
    loaded.setup.camera.exposure_e = exposure_from_light(*loaded.light, loaded.setup);
  }
  if (!loaded.document.has_problems()) cross_check_memory(loaded, field);
  add_unusual_values(loaded);
  loaded.document.finish();
}

void check_setup_keys(SetupDocument document) {
  CaseSetup loaded = read_tables(std::move(document));
  add_unusual_values(loaded);
  loaded.document.finish();
}

PreparedCase prepare_case(CaseSetup& loaded, ReusableParts const& known) {
  PreparedCase prepared;
  prepared.correlate = loaded.correlate;
  warn(prepared.warnings, loaded.warnings);
  prepared.scene = build_scene(loaded.setup, known.medium);
  Scene const& scene = prepared.scene;
  warn(prepared.warnings, scene.medium.warnings);
  if (scene.second_medium) warn(prepared.warnings, scene.second_medium->warnings);
  warn_of_field(scene, prepared.warnings);  // warn before rays are traced through the field
  prepared.plan = known.plan ? *known.plan : plan_rendering(scene, known.step);
  prepared.plan.seed = loaded.setup.render.seed;  // a repetition reuses the plan of a case with another seed
  RenderPlan const& plan = prepared.plan;
  if (IntegrationStep const& step = plan.step_estimate; step.change_px >= 1e-4) {
    warn(prepared.warnings,
         {WarningCode::low_accuracy, "medium.step_mm",
          fmt::format("halving the step of {:.4g} mm would still shift dot {} by {:.2g} px; use a smaller one",
                      step.step_mm, step.limiting_dot, step.change_px)});
  }
  case_kind(scene.setup).warn_of_view(scene, prepared.warnings);
  warn_of_blur(scene, prepared.warnings);
  if (loaded.setup.medium.field.kind != FieldKind::none && loaded.setup.experiment().measures_density) {
    prepared.strain = known.strain ? *known.strain : strain_in_view(scene, plan);
    if (prepared.strain.largest_px < least_displacement_px) {
      warn(prepared.warnings,
           {WarningCode::unsuitable, "medium.field",
            fmt::format("no displacement: according to Eq. 9 the field displaces no point in the view by more than "
                        "{:.2g} px; check quantity, scale, spacing and position of medium.field, or its amplitude",
                        prepared.strain.largest_px)});
    } else if (prepared.strain.largest_px < measurable_displacement_px) {
      warn(prepared.warnings,
           {WarningCode::unsuitable, "medium.field",
            fmt::format("displacements are too small to measure: according to Eq. 9 the field displaces no point in "
                        "the view by more than {:.2g} px (correlation resolves {} px at best); increase "
                        "geometry.z_d_mm or the focal length, or check quantity, scale and spacing of medium.field",
                        prepared.strain.largest_px, measurable_displacement_px)});
    }
    if (prepared.strain.caustic_fraction > 0) {
      warn(prepared.warnings,
           {WarningCode::unsuitable, "medium.field",
            fmt::format(
                "caustic: over {:.2g} % of the view the strain is 1 or more and rays cross before they reach the lens "
                "(the images of dots are folded there); reduce Z_D or the gradients, or exclude these vectors",
                100 * prepared.strain.caustic_fraction)});
    }
  }
  SetupTable root = loaded.document.root();
  root.table("medium").resolve("step_mm", plan.step_estimate.step_mm);
  // "auto" stays in the resolved setup if the number of rays differs between sources
  bool const by_table = plan.method == RenderMethod::focused_dots;
  if ((by_table || plan.adaptive_criteria) && !loaded.setup.render.rays_per_dot) {
    root.table("render").resolve("rays_per_dot", std::string("auto"));
  } else {
    root.table("render").resolve("rays_per_dot", static_cast<long long>(plan.rays));
  }
  if (loaded.setup.experiment().sources.on_target && loaded.setup.target.kind != TargetKind::points) {
    Vec2d const extent = loaded.setup.target_extent();
    root.table("target").resolve("extent_mm",
                                 std::vector<double>{extent.x / unit::millimetre, extent.y / unit::millimetre});
  }
  return prepared;
}
}  // namespace gladstone::inline cases
