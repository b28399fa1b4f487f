#include "studies/sweep/state_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace gladstone::inline sweep {
namespace {

constexpr std::size_t most_named = 20;

std::string and_more(std::size_t count) {
  return count > most_named ? fmt::format("  and {} more; --json names all\n", count - most_named) : "";
}

}  // namespace

nlohmann::ordered_json state_json(std::string const& run, Manifest const& cases, RunState const& state) {
  nlohmann::ordered_json json{{"run", run},
                              {"cases", state.ok + state.failed.size() + state.missing.size()},
                              {"done", state.ok},
                              {"failed", state.failed.size()},
                              {"missing", state.missing.size()},
                              {"running", state.running.size()},
                              {"pairs_only", state.pairs_only.size()}};
  json["failures"] = nlohmann::ordered_json::array();
  for (CaseResult const& failed : state.failed) {
    json["failures"].push_back({{"case", failed.index},
                                {"title", cases[failed.index].title()},
                                {"error", failed.error},
                                {"again", failed.again}});
  }
  json["missing_cases"] = state.missing;
  json["running_cases"] = state.running;
  return json;
}

std::string state_text(std::string const& run, Manifest const& cases, RunState const& state) {
  std::string text = fmt::format("{}: {} cases, {} done, {} failed, {} missing", run,
                                 state.ok + state.failed.size() + state.missing.size(), state.ok, state.failed.size(),
                                 state.missing.size());
  text += state.running.empty() ? "\n" : fmt::format(" ({} of them being computed)\n", state.running.size());
  if (!state.pairs_only.empty()) {
    text += fmt::format("{} of the finished cases have images only; sweep run without --pairs-only measures them\n",
                        state.pairs_only.size());
  }
  for (std::size_t i = 0; i < std::min(most_named, state.failed.size()); ++i) {
    CaseResult const& failed = state.failed[i];
    text += fmt::format("failed: {}: {}{}\n", cases[failed.index].title(), failed.error,
                        failed.again ? " (the next run tries it again; with fewer --jobs each has more memory)" : "");
  }
  text += and_more(state.failed.size());
  for (std::size_t i = 0; i < std::min(most_named, state.missing.size()); ++i) {
    text += fmt::format("missing: {}\n", cases[state.missing[i]].title());
  }
  return text + and_more(state.missing.size());
}

}  // namespace gladstone::inline sweep
