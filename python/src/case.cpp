#include "python/src/case.h"

#include <nlohmann/json.hpp>

#include "render/files/image_file.h"
#include "render/files/output_folder.h"
#include "render/files/source_files.h"
#include "render/files/text_file.h"
#include "studies/case/case_summary.h"
#include "studies/case/json_text.h"
#include "studies/case/log_silencer.h"
#include "studies/case/truth_file.h"
#include "studies/case/write_case.h"

namespace gladstone::python {
namespace {

/// Writes the files of a CASE folder by calling `write`; either all files are written, or none.
template <class Write>
void write_folder(std::string const& folder, CaseSetup const& loaded, Write const& write) {
  refuse_case_over_inputs(folder, loaded.document.file_names());
  OutputFolder output(folder, case_content());
  output.fill(write);
  output.commit();
}

}  // namespace

PairCase::PairCase(CameraCase camera, Backend const& device, ReusableParts const& known)
    : camera_(std::move(camera.name)), loaded_(std::move(camera.loaded)) {
  RecordedCase finished = render_case_in_memory(loaded_, *device.renderer, known);
  outcome_ = judge_case(loaded_, finished.prepared, finished.rendered, finished.frames);
  store_images(outcome_.levels);
  prepared_ = std::move(finished.prepared);
  rendered_ = std::move(finished.rendered);
  frames_ = std::move(finished.frames);
  frames_->levels.reset();  // release the frames: outcome_ contains the same grey levels
}

PairCase::PairCase(std::string folder)
    : loaded_(load_case_setup(in_case(folder, case_file::setup), {})), folder_(std::move(folder)) {
  stored_truth_ = read_truth(in_case(folder_, case_file::truth));
  FramePair<std::uint16_t> const levels{integer_levels(read_levels(in_case(folder_, case_file::reference))),
                                        integer_levels(read_levels(in_case(folder_, case_file::flow)))};
  outcome_.reference_sha256 = pixel_sha256(levels.reference);
  outcome_.flow_sha256 = pixel_sha256(levels.flow);
  outcome_.accuracy = truth_accuracy(stored_truth_, truth_tolerance_px);
  store_images(levels);
  summary_ = read_text_file(in_case(folder_, case_file::summary));
  nlohmann::json::json_pointer const image_error("/image_error/levels");
  nlohmann::json const stored = nlohmann::json::parse(summary_).value(image_error, nlohmann::json());
  if (stored.is_number()) outcome_.image_error_levels = stored.get<double>();
}

void PairCase::store_images(FramePair<std::uint16_t> const& levels) {
  images_.assign(levels.reference.begin(), levels.reference.end());
  images_.insert(images_.end(), levels.flow.begin(), levels.flow.end());
}

std::string PairCase::summary() {
  std::lock_guard const lock(mutex_);
  if (summary_.empty()) summary_ = json_text(case_summary(loaded_, *prepared_, *rendered_, *frames_, outcome_)) + "\n";
  return summary_;
}

void PairCase::save(std::string const& folder) {
  if (!frames_) throw DataError(ErrorCode::arguments, folder_, "was loaded from this folder; copy its files instead");
  std::lock_guard const lock(mutex_);
  write_folder(folder, loaded_, [&](std::string const& place) {
    write_case(loaded_, *prepared_, *rendered_, *frames_, outcome_, place);
  });
}

PreparedCase const& PairCase::prepared() {
  std::lock_guard const lock(mutex_);
  if (!prepared_) {
    LogSilencer const quiet;  // the warnings need not be logged again, since summary.json contains them
    prepared_ = prepare_case(loaded_);
  }
  return *prepared_;
}

RenderedCase const& PairCase::rendered(Backend const& device) {
  PreparedCase const& scene = prepared();
  std::lock_guard const lock(mutex_);
  if (!rendered_) rendered_ = render_case(scene, *device.renderer, RenderTheory::no);
  return *rendered_;
}

PlanesCase::PlanesCase(CameraCase one, Backend const& device)
    : camera(std::move(one.name)), loaded(std::move(one.loaded)) {
  hash_inputs(loaded);
  rendered = render_planes(loaded, *device.renderer);
  for (std::size_t plane = 0; plane < rendered.planes.size(); ++plane) {
    Recording const frame = record_plane(loaded.setup.camera, rendered, plane);
    images.insert(images.end(), frame.image.begin(), frame.image.end());
  }
}

void PlanesCase::save(std::string const& folder) {
  write_folder(folder, loaded, [&](std::string const& place) { write_calibration(loaded, rendered, place); });
}

}  // namespace gladstone::python
