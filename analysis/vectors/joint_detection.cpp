#include "analysis/vectors/joint_detection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/vectors/convention_fit.h"
#include "analysis/vectors/scale_and_shift.h"

namespace gladstone {
namespace {

using detail::same_axes;
using Verdict = DetectedConventions::Verdict;

/// A sample of one file's vectors, and how well the conventions in use fit it.
struct Sample {
  VectorsWithTruth const* of;
  DisplacementField few;
  double most;  ///< upper limit of a difference, see fit_within()
  ConventionFit as_read;

  ConventionFit fit(LikelyMistake const& mistake) const {
    return detail::fit_within(detail::corrected(few, mistake.correction), mistake.reading, of->truth, of->image_rows,
                              most);
  }
};

/// A possible mistake, and the evidence for it from all files.
struct Candidate {
  LikelyMistake mistake;
  double sum = 0.0;
  std::size_t decisive = 0;  ///< index of the file with the strongest evidence
  double strongest = 0.0;
  std::size_t files = 0, followed = 0;  ///< number of files, and of those that follow the truth without the mistake

  void add(ConventionFit const& undone, ConventionFit const& as_read, std::size_t file) {
    ++files;
    followed += undone.rms_px < 0.5 * undone.signal_px ? 1 : 0;
    double const evidence = evidence_for(undone, as_read);
    if (std::isfinite(evidence)) sum += evidence;
    if (!(evidence > strongest)) return;
    strongest = evidence;
    decisive = file;
    mistake.rms_px = undone.rms_px;
    mistake.rms_as_read = as_read.rms_px;
  }
  bool is_found() const {
    bool const corrects = !(mistake.correction == VectorCorrection{});
    if (corrects && 2 * followed <= files) return false;  // files with different units, for example
    return sum > (corrects ? 25.0 : 16.0) && mistake.rms_px < (corrects ? 0.5 : 0.9) * mistake.rms_as_read;
  }
};

std::vector<VectorConventions> own_conventions(VectorFile const& file) {
  std::vector<VectorConventions> own = file.also;
  own.insert(own.begin(), file.conventions);
  return own;
}

/// Returns those of the format's own conventions that fit all files best.
VectorConventions choose_own(std::vector<Sample> const& samples, std::vector<VectorConventions> const& own) {
  VectorConventions chosen = own.front();
  double most = 9.0;
  for (VectorConventions const& one : own) {
    double sum = 0.0;
    for (Sample const& sample : samples) {
      auto const fit = [&](VectorConventions const& conventions) {
        LikelyMistake reading;
        reading.reading = conventions;
        return sample.fit(reading);
      };
      double const evidence = evidence_for(fit(one), fit(own.front()));
      if (std::isfinite(evidence)) sum += evidence;
    }
    if (!(sum > most)) continue;
    most = sum;
    chosen = one;
  }
  return chosen;
}

/// Returns every choice of axes, signs and columns that is not the format's own, with its best offset in each file.
std::vector<Candidate> other_axes(std::vector<DetectedConventions> const& detected, std::vector<Sample> const& samples,
                                  std::vector<VectorConventions> const& own, VectorConventions const& chosen) {
  std::vector<Candidate> all;
  for (std::size_t i = 0; i < detected.size(); ++i) {
    for (ConventionFit const& fit : detected[i].tried) {
      auto const same = [&fit](VectorConventions const& reading) { return same_axes(reading, fit.conventions); };
      if (std::any_of(own.begin(), own.end(), same)) continue;
      auto known =
          std::find_if(all.begin(), all.end(), [&](Candidate const& one) { return same(one.mistake.reading); });
      if (known == all.end()) {
        known = all.insert(all.end(), Candidate{});
        known->mistake.reading = fit.conventions;
        known->mistake.text = difference_of(fit.conventions, chosen);
        known->mistake.conventions = describe(fit.conventions);
      }
      known->add(fit, samples[i].as_read, i);
    }
  }
  return all;
}

/// Returns the mistakes found in single files that are more than other axes or signs, with their evidence in all files.
std::vector<Candidate> corrections(std::vector<DetectedConventions> const& detected, std::vector<Sample> const& samples,
                                   VectorConventions const& chosen) {
  std::vector<Candidate> all;
  for (DetectedConventions const& one : detected) {
    LikelyMistake const& mistake = one.mistake;
    bool const only_axes = mistake.correction == VectorCorrection{} && !same_axes(mistake.reading, chosen);
    if (!mistake.found() || only_axes) continue;
    Candidate candidate;
    candidate.mistake = mistake;
    for (std::size_t i = 0; i < samples.size(); ++i) candidate.add(samples[i].fit(mistake), samples[i].as_read, i);
    all.push_back(std::move(candidate));
  }
  return all;
}

double unlikelihood_of(Candidate const& candidate, std::vector<VectorConventions> const& own) {
  double const correction = candidate.mistake.correction == VectorCorrection{} ? 0.0 : 1.5;
  return correction + detail::unlikelihood(candidate.mistake.reading, own);
}

}  // namespace

CommonConventions detect_common_conventions(std::vector<VectorsWithTruth> const& files) {
  std::vector<VectorConventions> const own = own_conventions(files.front().file);
  CommonConventions result;
  std::vector<Sample> samples;
  for (VectorsWithTruth const& one : files) {
    result.detected.push_back(detect_conventions(one.file, one.truth, one.image_rows));
    DisplacementField few = detail::sample(one.file.field, 4000);  // the sample of detect_conventions()
    double const most = detail::largest_difference(few, own.front(), one.truth, one.image_rows);
    samples.push_back({&one, std::move(few), most, {}});
  }
  result.conventions = choose_own(samples, own);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    LikelyMistake as_read;
    as_read.reading = result.conventions;
    samples[i].as_read = samples[i].fit(as_read);
  }

  std::vector<Candidate> all = other_axes(result.detected, samples, own, result.conventions);
  for (Candidate& one : corrections(result.detected, samples, result.conventions)) all.push_back(std::move(one));
  auto best =
      std::max_element(all.begin(), all.end(), [](Candidate const& a, Candidate const& b) { return a.sum < b.sum; });
  if (best == all.end() || !best->is_found()) {
    double strongest = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      auto const rival =
          std::find_if(result.detected[i].tried.begin(), result.detected[i].tried.end(),
                       [&](ConventionFit const& fit) { return !same_axes(fit.conventions, result.conventions); });
      if (rival == result.detected[i].tried.end()) continue;
      double const evidence = evidence_for(samples[i].as_read, *rival);
      if (!(evidence > strongest)) continue;
      strongest = evidence;
      result.decisive = i;
    }
    result.fit = samples[result.decisive].as_read;
    result.ambiguous = std::any_of(all.begin(), all.end(), [](Candidate const& one) {
      return one.mistake.correction == VectorCorrection{} && one.sum > -9.0;
    });
    return result;
  }
  // Estimator errors in a flow of similar appearance can account for a tenth of the evidence.
  double const most = best->sum, alike = std::max(9.0, 0.1 * most);
  for (auto one = all.begin(); one != all.end(); ++one) {
    if (most - one->sum <= alike && unlikelihood_of(*one, own) < unlikelihood_of(*best, own)) best = one;
  }
  result.mistake = best->mistake;
  result.decisive = best->decisive;
  result.fit = samples[result.decisive].as_read;
  for (Candidate const& other : all) {
    bool const as_likely = unlikelihood_of(other, own) < unlikelihood_of(*best, own) + 0.5;
    bool const same = other.mistake.correction == best->mistake.correction
                          ? same_axes(other.mistake.reading, best->mistake.reading)
                          : !(other.mistake.correction == VectorCorrection{});
    if (same || most - other.sum > alike || !as_likely) continue;
    result.mistake.text += ", or " + other.mistake.text;
    result.mistake.conventions.clear();
    result.ambiguous = true;
  }
  return result;
}

}  // namespace gladstone
