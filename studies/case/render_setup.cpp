#include "studies/case/render_setup.h"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/files/output_file.h"
#include "render/files/output_folder.h"
#include "studies/case/case_kind.h"
#include "studies/case/json_text.h"
#include "studies/case/sequence_pair.h"

namespace gladstone::inline cases {
namespace {

namespace fs = std::filesystem;

}  // namespace

SetupRenderer::SetupRenderer(SetupDocument document, std::string path)
    : path_(std::move(path)), document_(std::move(document)) {
  if (!describes_sequence(document_)) select_pair(document_);
  cameras_ = load_cameras(document_);
}

void SetupRenderer::refuse_over_inputs(std::string const& folder) const {
  for (CameraCase const& camera : cameras_) {
    std::vector<std::string> inputs = camera.loaded.document.file_names();
    inputs.push_back(path_);
    refuse_case_over_inputs(folder, inputs);
    if (!camera.name.empty()) refuse_case_over_inputs((fs::path(folder) / camera.name).string(), inputs);
  }
}

RenderedSetup SetupRenderer::render(Renderer& renderer, std::string const& folder, SharedParts const& shared) {
  OutputFolder output(folder, case_content());
  RenderedSetup all;
  nlohmann::ordered_json contents;
  BuiltMedium& medium = all.medium;
  if (shared.medium) medium = *shared.medium;
  for (CameraCase& camera : cameras_) {
    bool const first = &camera == &cameras_.front();
    if (!camera.name.empty()) spdlog::info("camera {}", camera.name);
    ReusableParts known;
    if (!first || shared.medium) known.medium = &medium;
    RenderedCamera& entry = all.cameras.emplace_back();
    entry.folder = camera.name.empty() ? folder : (fs::path(folder) / camera.name).string();
    auto const of_camera = shared.cameras.find(camera.name);
    nlohmann::ordered_json summary =
        render_one(camera, renderer, known, medium, output, entry,
                   of_camera == shared.cameras.end() ? SharedParts::OfCamera{} : of_camera->second);
    if (cameras_.size() > 1) {
      contents["cameras"][camera.name] = std::move(summary);
    } else {
      contents = std::move(summary);
    }
  }
  if (cameras_.size() > 1) {
    output.fill([&](std::string const& place) {
      OutputFile::write_text((fs::path(place) / case_file::setup).string(), written());
      OutputFile::write_text((fs::path(place) / case_file::summary).string(), json_text(contents) + "\n");
    });
  }
  output.commit();
  all.summary = std::make_shared<nlohmann::ordered_json const>(std::move(contents));
  return all;
}

nlohmann::ordered_json SetupRenderer::render_one(CameraCase& camera, Renderer& renderer, ReusableParts const& known,
                                                 BuiltMedium& medium, OutputFolder const& output, RenderedCamera& entry,
                                                 SharedParts::OfCamera const& shared) const {
  CaseWriter const write = case_kind(camera.loaded.setup).render(camera.loaded, renderer, known, shared, entry, medium);
  nlohmann::ordered_json summary;
  output.fill([&](std::string const& place) {
    fs::path const own = fs::path(place) / camera.name;
    fs::create_directories(own);
    summary = write(own.string());
  });
  return summary;
}

std::vector<std::string> SetupRenderer::camera_names() const {
  std::vector<std::string> names;
  for (CameraCase const& camera : cameras_) names.push_back(camera.name);
  return names;
}

std::vector<std::string> SetupRenderer::rendered_inputs() const {
  std::vector<std::string> inputs;
  for (CameraCase const& camera : cameras_) {
    std::vector<std::string> const files = camera.loaded.document.file_names();
    std::vector<std::vector<std::string>> const keys = camera.loaded.document.file_keys();
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (keys[i].front() != "correlate") inputs.push_back(files[i]);
    }
  }
  return inputs;
}

std::string SetupRenderer::written() const { return written_setup(document_.copy(), cameras_); }

}  // namespace gladstone::inline cases
