#include "studies/sweep/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <numeric>
#include <thread>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/stop_point.h"
#include "studies/sweep/case_list.h"
#include "studies/sweep/case_locks.h"

namespace gladstone::inline sweep {
namespace {

namespace fs = std::filesystem;

/// RAII guard that claims a case, if no other process has claimed it.
class Claim {
 public:
  Claim(CaseLocks& claims, std::size_t index) : claims_(claims), index_(index), taken_(claims.take(index)) {}
  ~Claim() {
    if (taken_) claims_.release(index_);
  }
  Claim(Claim const&) = delete;
  Claim& operator=(Claim const&) = delete;
  bool taken() const { return taken_; }

 private:
  CaseLocks& claims_;
  std::size_t index_;
  bool taken_;
};

/// Computes the requested parts of a case. If its vectors and errors were computed before, they are computed again with
/// the images, so that the result retains all of its numbers.
CaseResult compute_case(std::string const& run, Manifest const& cases, std::size_t index, RunSelection const& selection,
                        CaseComputation const& compute) {
  auto const known = read_result(run, index, cases.line_hash(index), ResultPart::head);
  bool const measured = known && known->status == CaseStatus::ok && !known->pairs_only;
  CaseParts const parts = selection.pairs_only && !measured ? CaseParts::images : CaseParts::all;
  bool const kept = selection.keep_images || selection.pairs_only;
  return compute(cases[index], kept ? images_folder(run, index) : "", parts);
}

}  // namespace

std::string images_folder(std::string const& run, std::size_t index) {
  return (fs::path(run) / run_file::cases / std::to_string(index)).string();
}

std::vector<std::size_t> selected_cases(std::size_t count, RunSelection const& selection) {
  std::vector<std::size_t> all(selection.only ? 0 : count);
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (selection.only) all = parse_case_list(*selection.only, count);
  // Use contiguous parts, since neighbouring cases share the most.
  auto const end_of = [&](std::size_t pieces) {
    return all.begin() + static_cast<std::ptrdiff_t>(all.size() * pieces / selection.shards);
  };
  return {end_of(selection.shard), end_of(selection.shard + 1)};
}

RunState determine_run_state(std::string const& run, Manifest const& cases, std::vector<std::size_t> const& selected) {
  RunState state;
  CaseLocks const claims(run, CaseLocks::Use::look);
  for (std::size_t const index : selected) {
    throw_if_interrupted();
    // Skip cases without a result file, whose manifest lines need not be read.
    std::optional<CaseResult> result;
    if (has_result(run, index)) result = read_result(run, index, cases.line_hash(index), ResultPart::head);
    if (!result) {
      state.missing.push_back(index);
      if (claims.held(index)) state.running.push_back(index);
    } else if (result->status == CaseStatus::ok) {
      ++state.ok;
      if (result->pairs_only) state.pairs_only.push_back(index);
    } else {
      state.failed.push_back(std::move(*result));
    }
  }
  return state;
}

bool needs_recomputation(CaseResult const& result, RunSelection const& selection) {
  return result.status == CaseStatus::failed && (result.again || selection.retry_failed);
}

bool is_missing_parts(std::string const& run, CaseResult const& result, RunSelection const& selection) {
  if (result.status != CaseStatus::ok) return false;
  if (result.pairs_only && !selection.pairs_only) return true;
  return (selection.keep_images || selection.pairs_only) && !fs::exists(images_folder(run, result.index));
}

RunState remove_failed_results(std::string const& run, Manifest const& cases, std::vector<std::size_t> const& selected,
                               RunSelection const& selection) {
  RunState state = determine_run_state(run, cases, selected);
  if (selection.keep_images || selection.pairs_only || !state.pairs_only.empty()) {
    for (std::size_t const index : selected) {
      auto const result = read_result(run, index, cases.line_hash(index), ResultPart::head);
      if (!result || !is_missing_parts(run, *result, selection)) continue;
      state.missing.push_back(index);
      --state.ok;
    }
  }
  auto const due = [&](CaseResult const& one) { return needs_recomputation(one, selection); };
  if (std::none_of(state.failed.begin(), state.failed.end(), due)) return state;
  CaseLocks claims(run, CaseLocks::Use::take);
  std::erase_if(state.failed, [&](CaseResult const& failed) {
    Claim const claim(claims, failed.index);
    if (!claim.taken()) return false;
    // Check again, now that no other process can change the result.
    auto const result = read_result(run, failed.index, failed.line_hash, ResultPart::head);
    if (!result || !due(*result)) return false;
    remove_result(run, failed.index);
    state.missing.push_back(failed.index);
    return true;
  });
  return state;
}

bool record_failure(std::string const& run, Manifest const& cases, std::size_t index, std::string const& error,
                    bool again) {
  CaseLocks claims(run, CaseLocks::Use::take);
  Claim const claim(claims, index);
  if (!claim.taken() || read_result(run, index, cases.line_hash(index), ResultPart::head)) return false;
  write_result(run, failed_case(index, cases.line_hash(index), cases[index].device, error, again));
  return true;
}

void run_cases(std::string const& run, Manifest const& cases, std::vector<std::size_t> const& selected,
               RunSelection const& selection, CaseComputation const& compute, std::size_t first,
               std::function<void(std::size_t index, CaseEvent event)> const& tell) {
  fs::path const results = fs::path(run) / run_file::cases;
  std::error_code error;
  fs::create_directories(results, error);
  if (error) throw OutputError(results.string(), "cannot be created (" + error.message() + ')');
  remove_abandoned_results(run);
  CaseLocks claims(run, CaseLocks::Use::take);
  auto const is_done = [&](std::size_t index) {
    auto const result = read_result(run, index, cases.line_hash(index), ResultPart::head);
    return result && !is_missing_parts(run, *result, selection);
  };
  std::vector<std::size_t> waiting = selected;
  if (!waiting.empty()) std::rotate(waiting.begin(), waiting.begin() + (first % waiting.size()), waiting.end());
  auto pause = std::chrono::milliseconds(10);
  while (!waiting.empty()) {
    std::vector<std::size_t> with_others;
    for (std::size_t const index : waiting) {
      throw_if_interrupted();
      if (!is_done(index)) {
        Claim const claim(claims, index);
        if (!claim.taken()) {
          with_others.push_back(index);
          continue;
        }
        // Another process may have finished it between the check and the claim.
        if (!is_done(index)) {
          tell(index, CaseEvent::begun);
          stop_point("case-begun");
          CaseResult const result = compute_case(run, cases, index, selection, compute);
          stop_point("case-computed");
          write_result(run, result);
          tell(index, CaseEvent::finished);
        }
      }
    }
    if (with_others.size() == waiting.size()) {
      std::this_thread::sleep_for(pause);
      pause = std::min(2 * pause, std::chrono::milliseconds(500));
    }
    waiting = std::move(with_others);
  }
}

}  // namespace gladstone::inline sweep
