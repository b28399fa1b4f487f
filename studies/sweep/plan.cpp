#include "studies/sweep/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/files/input_file.h"
#include "render/files/input_guard.h"
#include "render/files/output_file.h"
#include "render/files/partial.h"
#include "render/files/text_file.h"
#include "studies/sweep/case_locks.h"
#include "studies/sweep/results.h"

namespace gladstone::inline sweep {
namespace {

namespace fs = std::filesystem;

/// Reads the heads of all intact results in RUN. @throws DataError if one is of another version
std::vector<CaseResult> whole_results(fs::path const& run) {
  std::vector<CaseResult> results;
  std::error_code error;
  for (fs::directory_iterator entry(run / run_file::cases, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    if (entry->path().extension() != ".json" || !entry->is_regular_file(ignored)) continue;
    throw_if_interrupted();
    std::string const path = entry->path().string();
    if (auto result = parse_result(read_text_file(path), path, ResultPart::head)) results.push_back(std::move(*result));
  }
  return results;
}

/// Returns true if a folder contains only what write_plan() leaves behind when it is interrupted, by a full disk or a
/// signal.
bool left_by_a_cut_plan(fs::path const& folder) {
  std::error_code error;
  // study.toml and base.toml are written after cases/; without cases/ they are the user's files.
  bool const ours = fs::is_directory(folder / run_file::cases, error) && fs::is_empty(folder / run_file::cases, error);
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::string const name = entry->path().filename().string();
    bool const partial = is_partial(name, sibling_stem(run_file::manifest)) ||
                         is_partial(name, sibling_stem(run_file::study)) ||
                         is_partial(name, sibling_stem(run_file::base));
    bool const written =
        name == run_file::cases || name == run_file::study || name == run_file::base || name == run_file::claims;
    if (!partial && !(ours && written) && name != "lost+found") return false;
  }
  return !error;
}

/// Checks that RUN does not exist, is empty or is a study. @throws OutputError otherwise
void refuse_foreign_run(fs::path const& folder) {
  fs::path const manifest = folder / run_file::manifest;
  std::error_code error;
  if (fs::exists(manifest, error)) {
    UnrecordedReading const to_be_replaced;
    if (read_manifest_version(InputFile(manifest.string(), "another folder"))) return;
    throw OutputError(
        manifest.string(),
        "is not a gladstone manifest, and would be overwritten; choose another folder, or remove this file");
  }
  if (fs::exists(folder, error) && (!fs::is_directory(folder, error) || !left_by_a_cut_plan(folder))) {
    throw OutputError(folder.string(),
                      fmt::format("exists and contains no planned study (no {}); choose another folder or empty it",
                                  run_file::manifest));
  }
}

/// Passes the lines of a plan, with line ends, to `take` in their order until it returns false.
void each_line(StudyPlan const& plan, std::string const& label, std::function<bool(std::string const&)> const& take) {
  constexpr std::size_t at_once = 4096;
  Progress progress(label, plan.size());
  std::vector<std::string> lines;
  for (std::size_t first = 0; first < plan.size(); first += at_once) {
    lines.resize(std::min(at_once, plan.size() - first));
    parallel_chunks(lines.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) lines[i] = plan.line(first + i) + '\n';
    });
    for (std::string const& line : lines) {
      if (!take(line)) return;
    }
    progress.advance(lines.size());
  }
}

/// Returns true if a manifest equals the plan byte by byte.
bool is_the_same(InputFile const& manifest, StudyPlan const& plan) {
  std::uint64_t offset = 0;
  std::string there;
  bool same = true;
  each_line(plan, "comparing plans", [&](std::string const& line) {
    there.resize(line.size());
    there.resize(manifest.read(offset, there.data(), there.size()));
    offset += line.size();
    return same = there == line;
  });
  return same && offset == manifest.size();
}

/// @param manifest  final path, for messages
void write_lines(StudyPlan const& plan, std::string const& path, std::string const& manifest) {
  auto const fail = [&manifest](int error) {
    throw OutputError(manifest, fmt::format("cannot be written ({})", std::strerror(error != 0 ? error : EIO)));
  };
  errno = 0;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), std::fclose);
  if (!file) fail(errno);
  each_line(plan, "planning", [&](std::string const& line) {
    if (std::fwrite(line.data(), 1, line.size(), file.get()) != line.size()) fail(errno);
    return true;
  });
  if (std::fclose(file.release()) != 0) fail(errno);
}

}  // namespace

void check_plan_folder(std::string const& run, StudyFile const& study) {
  fs::path const folder(run), manifest = folder / run_file::manifest;
  refuse_foreign_run(folder);
  refuse_inputs_as_outputs({manifest.string(), (folder / run_file::study).string(), (folder / run_file::base).string(),
                            (folder / run_file::claims).string()},
                           {study.path, study.base_path});
  ProtectedWritePermit const own;
  OutputFile const tried(manifest.string());
}

PlanOutcome write_plan(std::string const& run, StudyPlan const& plan) {
  fs::path const folder(run), manifest = folder / run_file::manifest;
  std::error_code error;
  PlanOutcome planned = PlanOutcome::fresh;
  if (fs::exists(manifest, error)) {
    refuse_foreign_run(folder);
    UnrecordedReading const to_be_replaced;
    InputFile const there(manifest.string(), "another folder");
    int const version = *read_manifest_version(there);
    std::vector<CaseResult> const results = whole_results(folder);
    if (is_the_same(there, plan)) return PlanOutcome::unchanged;
    planned = PlanOutcome::replaced;
    auto const lost = [&plan](CaseResult const& result) {
      return result.index >= plan.size() || plan[result.index].line_hash != result.line_hash;
    };
    if (auto const count = std::count_if(results.begin(), results.end(), lost); count > 0) {
      std::string const why = version == manifest_version
                                  ? "from another study"
                                  : fmt::format(
                                        "by another gladstone (its manifest is of version {}, this one writes "
                                        "version {})",
                                        version, manifest_version);
      throw OutputError(run,
                        fmt::format("was planned {}, and {} of its {} results would be lost; choose another folder, "
                                    "or remove this one",
                                    why, count, results.size()));
    }
    if (CaseLocks(run, CaseLocks::Use::look).any_held()) {
      throw OutputError(run,
                        "was planned from another study whose cases are being computed; choose another folder, or "
                        "stop them first");
    }
  } else {
    refuse_foreign_run(folder);
  }
  ProtectedWritePermit const own;
  OutputFile output(manifest.string());
  fs::create_directories(folder / run_file::cases, error);
  if (error) throw OutputError((folder / run_file::cases).string(), "cannot be created (" + error.message() + ')');
  OutputFile::write_text((folder / run_file::study).string(), plan.study().text);
  OutputFile::write_text((folder / run_file::base).string(), plan.base());
  CaseLocks const made(run, CaseLocks::Use::take);
  write_lines(plan, output.temporary_path(), manifest.string());
  output.commit();
  return planned;
}

}  // namespace gladstone::inline sweep
