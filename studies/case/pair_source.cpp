#include "studies/case/pair_source.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/ideal_images/host_pair_batches.h"
#include "render/setup/setup_node.h"
#include "studies/case/backend.h"
#include "studies/case/cameras.h"
#include "studies/case/case.h"

namespace gladstone::inline cases {
namespace {

/// Reads a setup completely. @throws DataError if it has several cameras
Setup read_one_camera(SetupDocument const& document, std::string const& name) {
  if (!camera_names(document).empty())
    throw DataError(ErrorCode::unsupported, name, "has several cameras; a batch needs a setup with one camera");
  return load_case_setup(document.copy()).setup;
}

/// Returns true if a value is a number or an array of numbers.
bool is_numeric(SetupNode const& node) {
  if (node.kind != SetupNode::Kind::array) return node.is_number();
  return std::all_of(node.elements.begin(), node.elements.end(), is_numeric);
}

/// Returns true if every key that is replaced belongs to [flow] and is a number before and after. Such changes affect
/// neither which keys the setup requires nor other tables.
bool changes_numbers_of_flow(SetupDocument const& before, SetupDocument const& after,
                             PairSource::Changes const& changes) {
  return std::all_of(changes.begin(), changes.end(), [&](std::string const& assignment) {
    std::string const path = assignment.substr(0, assignment.find('='));
    if (!path.starts_with("flow.")) return false;
    std::string const key = path.substr(5);
    SetupNode const *const old = before.find({"flow", key}), *const now = after.find({"flow", key});
    return old && now && is_numeric(*old) && is_numeric(*now);
  });
}

/// Reads the flow of a setup; nullopt if it has problems, which reading the whole setup reports.
std::optional<FlowSetup> read_flow_alone(SetupDocument document) {
  FlowSetup flow = read_flow_setup(document.root().table("flow"));
  if (document.has_problems()) return std::nullopt;
  return flow;
}

}  // namespace

PairSource::PairSource(SetupDocument document, std::string const& name, std::string const& device)
    : document_(std::move(document)),
      name_(name),
      setup_(read_one_camera(document_, name_)),
      on_gpu_(open_device(device).name() != "cpu") {
  build_pair_model(setup_);
}

OwnedPairModel PairSource::build_model(Changes const& changes) const {
  if (changes.empty()) return build_pair_model(setup_);
  SetupDocument document = document_.copy();
  for (std::string const& assignment : changes) document.override_key(assignment);
  if (changes_numbers_of_flow(document_, document, changes)) {
    if (std::optional<FlowSetup> flow = read_flow_alone(document.copy())) {
      Setup setup = setup_;
      setup.piv->flow = std::move(*flow);
      return build_pair_model(setup);
    }
  }
  return build_pair_model(read_one_camera(document, name_));
}

std::vector<OwnedPairModel> PairSource::build_models(std::vector<Changes> const& changes) const {
  std::vector<OwnedPairModel> models(changes.size());
  parallel_for(changes.size(), [&](std::size_t pair) { models[pair] = build_model(changes[pair]); });
  return models;
}

std::unique_ptr<PairBatchRenderer> PairSource::open(std::vector<OwnedPairModel> const& models) const {
  return on_gpu_ ? open_pair_batches(models) : make_host_pair_batches(models);
}

}  // namespace gladstone::inline cases
