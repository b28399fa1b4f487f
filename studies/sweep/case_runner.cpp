#include "studies/sweep/case_runner.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "analysis/vectors/vector_file.h"
#include "render/base/contracts.h"
#include "render/base/not_a_number.h"
#include "render/files/content_hash.h"
#include "render/files/output_file.h"
#include "render/files/output_folder.h"
#include "render/focused_dots/focused_dots.h"
#include "render/method.h"
#include "render/scene/light_through_lens.h"
#include "render/setup/setup_node.h"
#include "studies/case/backend.h"
#include "studies/case/log_silencer.h"
#include "studies/case/write_case.h"
#include "studies/compare/comparison_results.h"
#include "studies/compare/correlate.h"
#include "studies/compare/thinned_vectors.h"
#include "studies/compare/tracked_dots.h"
#include "studies/sweep/case_keys.h"
#include "studies/sweep/case_measures.h"
#include "studies/sweep/lru_cache.h"

namespace gladstone::inline sweep {
namespace {

namespace fs = std::filesystem;

/// Maximum total size of the cached media when a new one is added [bytes].
constexpr std::size_t kept_media_bytes = std::size_t{1} << 30;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string hash_of_input(std::string const& path, ManifestCase const& one) {
  try {
    return file_hash(path);
  } catch (DataError const&) {
    throw DataError(ErrorCode::changed, path,
                    fmt::format("can no longer be read, as it was when the study was planned ({}); restore it, "
                                "or plan the study again into another folder",
                                one.title()));
  }
}

/// Returns true if the error would also affect the next case.
bool stops_the_run(std::exception const& error) {
  return dynamic_cast<OutputError const*>(&error) || dynamic_cast<DeviceError const*>(&error) ||
         dynamic_cast<Interrupted const*>(&error);
}

/// Writes vectors and errors of a case into a folder that already contains its other files.
void write_kept_results(std::string const& folder, DisplacementField const& vectors, Comparison comparison,
                        FileOrigin const& origin) {
  write_vectors((fs::path(folder) / case_file::vectors).string(), vectors, origin);
  name_sources(comparison, compared_files(folder, ""));
  OutputFile::write_text((fs::path(folder) / case_file::errors).string(), errors_json(comparison));
}

}  // namespace

struct CaseRunner::Shared {
  /// State of a file when it was last hashed; it is not read again as long as time and size are unchanged.
  struct HashedFile {
    fs::file_time_type time;
    std::uintmax_t size = 0;
    std::string hash;
  };
  struct Plan {
    IntegrationStep step;
    StrainMap strain;
  };
  std::map<std::string, HashedFile> files;
  LruCache<BuiltMedium> media{8};
  LruCache<Plan> plans{64};
  LruCache<RenderPlan> rays{64};
  LruCache<RenderedCase> renderings{2};
  LruCache<PointTruth> truths{4};
};

CaseRunner::CaseRunner(Backend device, Sharing sharing, int least_apart_px)
    : device_(std::move(device)),
      sharing_(sharing),
      least_apart_px_(least_apart_px),
      shared_(std::make_unique<Shared>()) {}
CaseRunner::~CaseRunner() = default;

void CaseRunner::check_inputs(ManifestCase const& one) {
  if (one.device != device_.name()) {
    throw DeviceError(fmt::format("{} was planned for {} and not for {}; plan the study again", one.title(), one.device,
                                  device_.name()));
  }
  for (auto const& [path, hash] : one.inputs) {
    Shared::HashedFile& known = shared_->files[path];
    std::error_code error;
    auto const time = fs::last_write_time(path, error);
    auto const size = error ? 0 : fs::file_size(path, error);
    if (error || known.hash.empty() || known.time != time || known.size != size) {
      known = {time, size, hash_of_input(path, one)};
    }
    if (known.hash == hash) continue;
    throw DataError(ErrorCode::changed, path,
                    fmt::format("has changed since the study was planned ({}); restore the old file, or plan the "
                                "study again into another folder",
                                one.title()));
  }
}

CaseResult CaseRunner::run(ManifestCase const& one, std::string const& keep, CaseObserver const& observe,
                           CaseParts parts) {
  GLADSTONE_EXPECTS(parts == CaseParts::all || !keep.empty());
  check_inputs(one);
  CaseResult result;
  result.index = one.index;
  result.line_hash = one.line_hash;
  result.device = device_.name();
  result.build = build_text();
  CaseResult const fresh = result;
  LogSilencer const quiet;
  try {
    try {
      compute(one, keep, observe, parts, result);
    } catch (std::exception const& error) {
      if (!is_out_of_memory(error)) throw;
      shared_ = std::make_unique<Shared>();  // repeat without the cached results of other cases
      result = fresh;
      compute(one, keep, observe, parts, result);
    }
  } catch (std::exception const& error) {
    // Insufficient memory is not a property of the case: a later run or another machine may have more.
    bool const no_memory = is_out_of_memory(error);
    if (!no_memory && stops_the_run(error)) throw;
    return failed_case(one.index, one.line_hash, device_.name(), format_user_message(error), no_memory);
  }
  check_inputs(one);  // the inputs must not have changed during the computation either
  return result;
}

void CaseRunner::compute(ManifestCase const& one, std::string const& keep, CaseObserver const& observe, CaseParts parts,
                         CaseResult& result) {
  auto start = std::chrono::steady_clock::now();
  Shared& shared = *shared_;
  CaseSetup loaded = load_case_setup(
      one.document ? one.document->copy() : SetupDocument::from_text(one.setup, fmt::format("case {}", one.index)),
      FieldMemory::taken);
  CaseKeys const keys = case_keys(loaded, one.inputs);
  CaseKeys const plans =
      sharing_ == Sharing::over_repeats ? case_keys(loaded, one.inputs, RepeatSeeds::left_out) : keys;
  std::optional<OutputFolder> folder;
  if (!keep.empty()) {
    refuse_case_over_inputs(keep, loaded.document.file_names());
    folder.emplace(keep, case_content());
  }

  ReusableParts known;
  BuiltMedium* medium = shared.media.find(keys.medium);
  if (!medium) {
    std::size_t const bytes = medium_bytes_needed(loaded.setup.medium);
    shared.media.make_room(bytes, kept_media_bytes);
    check_memory(loaded.setup, FieldMemory::needed, focused_dots_memory(loaded.setup));
    medium = &shared.media.keep(keys.medium, build_checked_medium(loaded.setup.medium), bytes);
  }
  known.medium = medium;
  Shared::Plan const* const plan = shared.plans.find(plans.scene);
  if (plan) {
    known.step = &plan->step;
    known.strain = &plan->strain;
  }
  known.plan = shared.rays.find(plans.rays);
  PreparedCase prepared = prepare_case(loaded, known);
  if (!plan) shared.plans.keep(plans.scene, {prepared.plan.step_estimate, prepared.strain});
  if (!known.plan) shared.rays.keep(plans.rays, prepared.plan);

  RenderTheory const theory = keep.empty() ? RenderTheory::no : RenderTheory::yes;  // theory at the dots, for truth.h5
  bool const given = loaded.setup.render.rays_per_dot.has_value();
  std::string const traced = fmt::format("\n{}, {} rays {}, for a level {}, fineness {}{}",
                                         to_string(prepared.plan.method), given ? "given" : "auto", prepared.plan.rays,
                                         prepared.plan.adaptive_criteria ? prepared.plan.adaptive_criteria->level : 0.0,
                                         prepared.plan.fineness, keep.empty() ? "" : ", theory");
  std::string const frames_key = keys.scene + traced;
  RenderedCase* const made = shared.renderings.find(frames_key);
  RenderedCase rendered = made ? *made : render_case(prepared, *device_.renderer, theory);
  if (!made) shared.renderings.keep(frames_key, rendered);
  rendered.exposure_e = choose_exposure(prepared.scene, *rendered.rendering->in_place);
  RecordedFrames const frames = record_frames(prepared, rendered);
  result.seconds_render = seconds_since(start);

  SourceFiles kept_frames;
  if (folder) {
    rendered.seconds = result.seconds_render;
    folder->fill([&](std::string const& place) {
      CaseOutcome const outcome = judge_case(loaded, prepared, rendered, frames);
      write_case(loaded, prepared, rendered, frames, outcome, place);
      kept_frames.add_known("reference", outcome.reference_sha256);
      kept_frames.add_known("flow", outcome.flow_sha256);
    });
  }
  if (parts == CaseParts::images) {
    result.pairs_only = true;
    result.seconds_correlate = result.seconds_compare = not_a_number;
    add_rendering(prepared, rendered, frames, result);
    result.measures.emplace_back("warnings", static_cast<double>(result.warnings.size()));
    folder->commit();
    return;
  }

  std::string const name = fmt::format("case {}", one.index);
  Measurement measured = correlate_frames(
      *frames.levels, with_known_dots(loaded.correlate, loaded.setup, rendered.rendering->truth.reference_px), device_);
  result.seconds_correlate = measured.seconds;
  int const every = lattice_step(measured.field, least_apart_px_);
  measured.field = every_nth(std::move(measured.field), every);

  start = std::chrono::steady_clock::now();
  std::vector<Vec2d> const& places = measured.field.position_px;
  std::string const truth_key =
      plans.scene + traced + "\nvectors " +
      content_hash({reinterpret_cast<char const*>(places.data()), places.size() * sizeof(Vec2d)});
  PointTruth* truth = shared.truths.find(truth_key);
  if (!truth) {
    truth =
        &shared.truths.keep(truth_key, truth_of_vectors(prepared, *device_.renderer, places, TruthAt::mid_position));
  }
  Comparison comparison = compare_vectors(
      prepared, rendered.rendering->truth, &rendered,
      {.field = measured.field, .settings = loaded.correlate, .name = name, .every = every}, *truth, device_);
  result.measures = flat_measures(compute_error_measures(comparison));
  std::vector<Vec2d> const still(places.size());
  result.measures.emplace_back("signal_px",
                               summarize_errors(comparison.point.displacement_px, still, comparison.mask)["rms_px"]);
  add_relative_errors(prepared.scene.setup, result);
  result.measures.emplace_back(
      "blur_px", summarize_errors(comparison.point.displacement_std_px, still, comparison.mask)["rms_px"]);
  add_rendering(prepared, rendered, frames, result);
  result.warnings.insert(result.warnings.end(), measured.field.warnings.begin(), measured.field.warnings.end());
  result.measures.emplace_back("warnings", static_cast<double>(result.warnings.size()));
  result.vectors = vector_errors(comparison);
  if (observe) observe({prepared, rendered, frames, comparison});
  result.seconds_compare = seconds_since(start);

  if (!folder) return;
  folder->fill([&](std::string const& place) {
    write_kept_results(
        place, measured.field, std::move(comparison),
        {"gladstone vectors", 1, loaded.document.resolved(), loaded.setup.render.seed, measured.device, kept_frames});
  });
  folder->commit();
}

}  // namespace gladstone::inline sweep
