#include "studies/render_setup.h"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "render/base/output_file.h"
#include "render/base/output_folder.h"
#include "render/base/setup_node.h"
#include "studies/calibration_case.h"
#include "studies/json_text.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;

SetupDocument read_document(std::string const& path, std::vector<std::string> const& overrides) {
  SetupDocument document = SetupDocument::from_file(path);
  for (auto const& assignment : overrides) document.override_key(assignment);
  return document;
}

}  // namespace

SetupRendering::SetupRendering(std::string path, std::vector<std::string> const& overrides)
    : path_(std::move(path)), document_(read_document(path_, overrides)) {
  for (CameraCase& one : camera_cases(document_)) {
    cameras_.push_back({one.name, load_case_setup(std::move(one.document))});
  }
}

void SetupRendering::refuse_over_inputs(std::string const& folder) const {
  for (OneCamera const& camera : cameras_) {
    std::vector<std::string> inputs = camera.loaded.document.file_names();
    inputs.push_back(path_);
    refuse_case_over_inputs(folder, inputs);
    if (!camera.name.empty()) refuse_case_over_inputs((fs::path(folder) / camera.name).string(), inputs);
  }
}

std::string SetupRendering::render(Renderer& renderer, std::string const& folder) {
  OutputFolder output(folder, case_content());
  BuiltMedium medium;
  nlohmann::ordered_json cameras;
  std::string summary;
  for (OneCamera& camera : cameras_) {
    bool const first = &camera == &cameras_.front();
    if (!camera.name.empty()) spdlog::info("camera {}", camera.name);
    KnownParts known;
    if (!first) known.medium = &medium;
    summary = render_one(camera, renderer, known, medium, camera.name, output);
    cameras[camera.name] = nlohmann::ordered_json::parse(summary);
  }
  if (cameras_.size() > 1) {
    summary = json_text(nlohmann::ordered_json{{"cameras", cameras}}) + "\n";
    output.fill([&](std::string const& place) {
      OutputFile::write_text((fs::path(place) / case_file::setup).string(), written());
      OutputFile::write_text((fs::path(place) / case_file::summary).string(), summary);
    });
  }
  output.commit();
  return summary;
}

std::string SetupRendering::render_one(OneCamera& camera, Renderer& renderer, KnownParts const& known,
                                       BuiltMedium& medium, std::string const& folder,
                                       OutputFolder const& output) const {
  std::string summary;
  auto const fill = [&](auto const& write) {
    output.fill([&](std::string const& place) {
      fs::path const own = fs::path(place) / folder;
      fs::create_directories(own);
      summary = write(own.string());
    });
  };
  if (camera.loaded.setup.calibration()) {
    hash_inputs(camera.loaded);
    RenderedCalibration const rendered = render_planes(camera.loaded, renderer);
    fill([&](std::string const& place) { return write_calibration(camera.loaded, rendered, place); });
    return summary;
  }
  FinishedCase const finished = finish_case(camera.loaded, renderer, known);
  fill([&](std::string const& place) {
    return write_case(camera.loaded, finished.prepared, finished.rendered, finished.frames, renderer, place);
  });
  medium = finished.prepared.scene.medium;
  return summary;
}

std::string SetupRendering::written() const {
  SetupDocument document = document_.copy();
  SetupNode const* const all = document.find({"camera"});
  std::vector<std::vector<std::string>> keys;
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    bool const own_lens = all->elements[i].find("lens") != nullptr;
    for (std::vector<std::string> key : cameras_[i].loaded.document.file_keys()) {
      if (own_lens && key.front() == "lens") key.insert(key.begin(), {"camera", '[' + std::to_string(i) + ']'});
      keys.push_back(std::move(key));
    }
  }
  document.name_files(keys);
  return document.written();
}

}  // namespace gladstone
