#include "analysis/vectors/joint_detection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/vectors/convention_fit.h"
#include "analysis/vectors/scale_and_shift.h"

namespace gladstone::inline vectors {
namespace {

using Verdict = DetectedConventions::Verdict;

/// Sample of one file's vectors, and the fit of the conventions in use to this sample.
struct Sample {
  VectorsWithTruth const* of;
  DisplacementField few;
  double most;  ///< upper limit of the difference between a vector and the truth [px], see fit_within()
  ConventionFit as_read;

  ConventionFit fit(VectorConventions const& conventions, VectorCorrection const& correction = {}) const {
    return fit_within(corrected(few, correction), conventions, of->truth, of->image_rows, most);
  }
};

/// A possible mistake, and the evidence for it from all files.
struct Candidate {
  ProbableMistake mistake;
  double sum = 0.0;
  std::size_t decisive = 0;  ///< index of the file with the strongest evidence
  double strongest = 0.0;
  std::size_t files = 0, followed = 0;  ///< number of files, and number of files that follow the truth after correction

  void add(ConventionFit const& undone, ConventionFit const& as_read, std::size_t file) {
    ++files;
    followed += undone.spread_px < 0.5 * undone.signal_spread_px ? 1 : 0;
    double const evidence = log_likelihood_statistic(undone, as_read);
    if (std::isfinite(evidence)) sum += evidence;
    if (!(evidence > strongest)) return;
    strongest = evidence;
    decisive = file;
    mistake.corrected_fit = undone;
    mistake.as_read = as_read;
  }
  bool corrects() const { return !(mistake.correction == VectorCorrection{}); }
  bool is_found() const {
    // Reject the correction if at most half of the files follow the truth after it, for example if each file has
    // another mistake.
    if (2 * followed <= files) return false;
    return sum > (corrects() ? 25.0 : 16.0) &&
           mistake.corrected_fit.spread_px < (corrects() ? 0.5 : 0.9) * mistake.as_read.spread_px;
  }
};

std::vector<VectorConventions> own_conventions(VectorFile const& file) {
  std::vector<VectorConventions> own = file.also;
  own.insert(own.begin(), file.conventions);
  return own;
}

/// Returns those of the format's own conventions that fit all files best, and stores their fits in the samples.
/// @pre the stored fits are those of the first conventions
VectorConventions choose_own(std::vector<Sample>& samples, std::vector<VectorConventions> const& own) {
  std::vector<ConventionFit> chosen;
  double most = 9.0;
  for (std::size_t k = 1; k < own.size(); ++k) {
    std::vector<ConventionFit> fits;
    double sum = 0.0;
    for (Sample const& sample : samples) {
      double const evidence = log_likelihood_statistic(fits.emplace_back(sample.fit(own[k])), sample.as_read);
      if (std::isfinite(evidence)) sum += evidence;
    }
    if (!(sum > most)) continue;
    most = sum;
    chosen = std::move(fits);
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) samples[i].as_read = chosen[i];
  return samples.front().as_read.conventions;
}

/// Returns every choice of axes, signs and columns that is not the format's own, with its best offset in each file.
std::vector<Candidate> other_axes(std::vector<DetectedConventions> const& detected, std::vector<Sample> const& samples,
                                  std::vector<VectorConventions> const& own, VectorConventions const& chosen) {
  std::vector<Candidate> all;
  for (std::size_t i = 0; i < detected.size(); ++i) {
    for (ConventionFit const& fit : detected[i].tried) {
      auto const same = [&fit](VectorConventions const& reading) { return same_axes(reading, fit.conventions); };
      if (std::any_of(own.begin(), own.end(), same)) continue;
      auto known = std::find_if(all.begin(), all.end(),
                                [&](Candidate const& one) { return same(one.mistake.corrected_fit.conventions); });
      if (known == all.end()) {
        known = all.insert(all.end(), Candidate{});
        known->mistake.corrected_fit.conventions = fit.conventions;
        known->mistake.reasons.push_back({MistakeReason::Kind::interpretation, fit.conventions, chosen});
      }
      known->add(fit, samples[i].as_read, i);
    }
  }
  for (Candidate& one : all) one.mistake.conventions = describe(one.mistake.corrected_fit.conventions);
  return all;
}

/// Returns the mistakes of single files that involve more than wrong axes and signs, with their evidence in all files.
std::vector<Candidate> corrections(std::vector<DetectedConventions> const& detected, std::vector<Sample> const& samples,
                                   VectorConventions const& chosen) {
  std::vector<Candidate> all;
  for (DetectedConventions const& one : detected) {
    ProbableMistake const& mistake = one.mistake;
    bool const only_axes =
        mistake.correction == VectorCorrection{} && !same_axes(mistake.corrected_fit.conventions, chosen);
    if (!mistake.found() || only_axes) continue;
    Candidate candidate;
    candidate.mistake = mistake;
    for (std::size_t i = 0; i < samples.size(); ++i)
      candidate.add(samples[i].fit(mistake.corrected_fit.conventions, mistake.correction), samples[i].as_read, i);
    all.push_back(std::move(candidate));
  }
  return all;
}

double candidate_penalty(Candidate const& candidate, std::vector<VectorConventions> const& own) {
  return (candidate.corrects() ? 1.5 : 0.0) + convention_penalty(candidate.mistake.corrected_fit.conventions, own);
}

/// Returns true if two candidates are the same mistake: they have the same axes and signs, and neither or both have a
/// correction.
bool alike(Candidate const& a, Candidate const& b) {
  return a.mistake.correction == b.mistake.correction
             ? same_axes(a.mistake.corrected_fit.conventions, b.mistake.corrected_fit.conventions)
             : a.corrects() && b.corrects();
}

/// Returns the index of the file that best distinguishes the conventions in use from other axes and signs.
std::size_t most_telling_file(std::vector<DetectedConventions> const& detected, std::vector<Sample> const& samples) {
  std::size_t telling = 0;
  double strongest = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ConventionFit const& as_read = samples[i].as_read;
    auto const rival = std::find_if(detected[i].tried.begin(), detected[i].tried.end(), [&](ConventionFit const& fit) {
      return !same_axes(fit.conventions, as_read.conventions);
    });
    if (rival == detected[i].tried.end() || !(log_likelihood_statistic(as_read, *rival) > strongest)) continue;
    strongest = log_likelihood_statistic(as_read, *rival);
    telling = i;
  }
  return telling;
}

/// Returns true if a file has an individual mistake, see CommonConventions::mistaken.
bool is_mistaken(DetectedConventions const& detected) {
  if (detected.mistake.found())
    return detected.mistake.corrected_fit.spread_px < 0.5 * detected.mistake.corrected_fit.signal_spread_px;
  return detected.verdict == Verdict::no_convention_fits;
}

}  // namespace

CommonConventions detect_common_conventions(std::vector<VectorsWithTruth> const& files) {
  std::vector<VectorConventions> const own = own_conventions(files.front().file);
  CommonConventions result;
  std::vector<Sample> samples;
  for (VectorsWithTruth const& one : files) {
    result.detected.push_back(detect_conventions(one.file, one.truth, one.image_rows));
    DisplacementField few = sample(one.file.field, 4000);  // same number of vectors as in detect_conventions()
    double const most = largest_difference(few, own.front(), one.truth, one.image_rows);
    samples.push_back({&one, std::move(few), most, {}});
    samples.back().as_read = samples.back().fit(own.front());
  }
  result.conventions = choose_own(samples, own);

  for (std::size_t i = 0; i < samples.size(); ++i)
    if (is_mistaken(result.detected[i])) result.mistaken.push_back(i);

  std::vector<Candidate> all = other_axes(result.detected, samples, own, result.conventions);
  for (Candidate& one : corrections(result.detected, samples, result.conventions)) all.push_back(std::move(one));
  auto best =
      std::max_element(all.begin(), all.end(), [](Candidate const& a, Candidate const& b) { return a.sum < b.sum; });
  if (best == all.end() || !best->is_found()) {
    result.decisive = most_telling_file(result.detected, samples);
    result.fit = samples[result.decisive].as_read;
    result.ambiguous =
        std::any_of(all.begin(), all.end(), [](Candidate const& one) { return !one.corrects() && one.sum > -9.0; });
    return result;
  }
  // If the flow is similar in both interpretations, estimator errors can account for a tenth of the evidence.
  double const most = best->sum, close = std::max(9.0, 0.1 * most);
  for (auto one = all.begin(); one != all.end(); ++one) {
    if (most - one->sum <= close && candidate_penalty(*one, own) < candidate_penalty(*best, own)) best = one;
  }
  result.mistake = best->mistake;
  result.decisive = best->decisive;
  result.fit = samples[result.decisive].as_read;
  for (Candidate const& other : all) {
    bool const as_likely = candidate_penalty(other, own) < candidate_penalty(*best, own) + 0.5;
    if (alike(other, *best) || most - other.sum > close || !as_likely) continue;
    result.mistake.reasons.insert(result.mistake.reasons.end(), other.mistake.reasons.begin(),
                                  other.mistake.reasons.end());
    result.mistake.conventions.clear();
    result.ambiguous = true;
  }
  return result;
}

}  // namespace gladstone::inline vectors
