#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/standard_correlator.h"
#include "render/base/error.h"
#include "studies/benchmark/particle_pair.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

constexpr Vec2d ensemble_shift{2.3, -1.6};

PairSequence sequence_of(std::size_t pairs, ParticleSettings const& settings) {
  return {pairs, [settings](std::size_t k) {
            ParticleSettings one = settings;
            one.seed = settings.seed + k;
            ParticlePair pair = render_particle_pair(one, [](Vec2d) { return ensemble_shift; });
            return HostFrames(std::move(pair.reference), std::move(pair.flow));
          }};
}

struct EnsembleErrors {
  double gross = 0.0;  ///< fraction of the vectors with errors above 1 px
  double rms = 0.0;    ///< rms error of the others, per component [px]
};

EnsembleErrors compute_error_measures(DisplacementField const& field) {
  EnsembleErrors errors;
  double good = 0.0;
  for (Vec2d const& d : field.raw_px) {
    Vec2d const error = d - ensemble_shift;
    if (!(length(error) < 1.0)) {
      errors.gross += 1.0 / static_cast<double>(field.size());
      continue;
    }
    errors.rms += 0.5 * dot(error, error);
    good += 1.0;
  }
  errors.rms = std::sqrt(errors.rms / good);
  return errors;
}

CorrelationSettings settings_of(std::vector<int> const& windows) {
  CorrelationSettings settings;
  settings.window_px = windows;
  settings.overlap = 0.5;
  return settings;
}

// The mean of a single plane is that plane.
TEST(Ensemble, OfOnePairIsThePair) {
  CorrelationSettings const settings = settings_of({32, 16});
  PairSequence const one = sequence_of(1, {.noise = 0.02});
  HostFrames const frames = one.frames(0);
  DisplacementField const alone = make_correlator(settings)->correlate(frames.reference(), frames.flow());
  DisplacementField const together = correlate_ensemble(one, settings);
  ASSERT_EQ(alone.size(), together.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(alone.raw_px[i].x, together.raw_px[i].x);
    EXPECT_EQ(alone.status[i], together.status[i]);
  }
}

// Two particles in a window of 16 px and noise of a tenth of their light: single pairs give dozens of gross errors. The
// mean of n planes has the same peak, and its random peaks are lower by sqrt(n). The errors of the other vectors come
// from independent particles and noise and also decrease by sqrt(n), to a quarter for 16 pairs, except for a common
// part: the error of the three-point fit itself, for which a factor of 1.5 is allowed.
TEST(Ensemble, FindsWhatNoSinglePairShows) {
  ParticleSettings const seeding{.particles_per_px = 2.0 / 256.0, .noise = 0.1, .seed = 11};
  CorrelationSettings const settings = settings_of({16});
  EnsembleErrors const alone = compute_error_measures(correlate_ensemble(sequence_of(1, seeding), settings));
  EnsembleErrors const together = compute_error_measures(correlate_ensemble(sequence_of(16, seeding), settings));
  EXPECT_GT(alone.gross, 0.1);
  EXPECT_LT(together.gross, 0.005);
  EXPECT_LT(together.rms, 1.5 * alone.rms / 4.0);
}

TEST(Ensemble, OfSeveralPassesFollowsTheFrames) {
  for (char const* method : {"scc", "rpc", "zncc"}) {
    CorrelationSettings settings = settings_of({32, 16});
    settings.method = method;
    EnsembleErrors const errors = compute_error_measures(
        correlate_ensemble(sequence_of(6, {.particles_per_px = 3.0 / 256.0, .noise = 0.05}), settings));
    EXPECT_EQ(errors.gross, 0.0) << method;
    EXPECT_LT(errors.rms, 0.04) << method;
  }
}

// A window that is masked in one pair is measured from the others.
TEST(Ensemble, MeasuresMaskedWindowsFromTheOtherPairs) {
  PairSequence const whole = sequence_of(4, {});
  PairSequence const holed{4, [&](std::size_t k) {
                             HostFrames const frames = whole.frames(k);
                             Image<double> reference = frames.reference();
                             if (k % 2 == 1)
                               for (int j = 0; j < 80; ++j)
                                 for (int i = 0; i < 80; ++i) reference(i, j) = std::nan("");
                             return HostFrames(std::move(reference), frames.flow());
                           }};
  DisplacementField const field = correlate_ensemble(holed, settings_of({32}));
  EXPECT_EQ(std::count(field.status.begin(), field.status.end(), VectorStatus::valid),
            static_cast<std::ptrdiff_t>(field.size()));
  EXPECT_EQ(compute_error_measures(field).gross, 0.0);
}

TEST(Ensemble, RefusesWhatIsOfSinglePairs) {
  CorrelationSettings settings = settings_of({32});
  settings.method = "opencv";
  EXPECT_THAT([&] { correlate_ensemble(sequence_of(2, {}), settings); },
              ThrowsDataError(ErrorCode::unsupported, "ensemble"));
  settings.method = "scc";
  settings.uncertainty = "image_matching";
  EXPECT_THAT([&] { correlate_ensemble(sequence_of(2, {}), settings); },
              ThrowsDataError(ErrorCode::unsupported, "ensemble"));
}

}  // namespace
}  // namespace gladstone
