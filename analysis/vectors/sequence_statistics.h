#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "render/base/vec.h"
#include "render/files/hdf5_file.h"

namespace gladstone::inline vectors {

/// Reynolds stresses of the displacement, the central second moments [px^2]: with n - 1 in the denominator.
struct ReynoldsStress {
  double uu = 0, vv = 0, uv = 0;
};

/// Statistics of a sequence of displacement fields at each point. Values that too few vectors determine are NaN.
struct SequenceMoments {
  std::vector<Vec2d> position_px;
  int columns = 0, rows = 0;                 ///< size of the grid; 0: scattered points
  std::size_t samples = 0;                   ///< number of fields, including missing ones
  std::size_t lags = 0;                      ///< number of lags at which the autocorrelation was recorded
  std::vector<std::int64_t> count;           ///< number of measured vectors [1]
  std::vector<Vec2d> mean_px;                ///< mean displacement [px]
  std::vector<Vec2d> mean_error_px;          ///< standard error of the mean [px]
  std::vector<Vec2d> rms_px;                 ///< standard deviation, the square root of the normal stresses [px]
  std::vector<Vec2d> rms_error_px;           ///< standard error of rms_px [px]
  std::vector<ReynoldsStress> stress_px2;    ///< Reynolds stresses [px^2]
  std::vector<ReynoldsStress> stress_error;  ///< standard errors of stress_px2 [px^2]
  std::vector<Vec2d> independent;            ///< effective number of independent samples of u and v [1]
  /// Number of points whose autocorrelation is positive at every recorded lag, so that `independent` is too large.
  std::size_t unresolved = 0;
};

/// Accumulates the statistics of a sequence of displacement fields on one grid. The required memory does not depend on
/// the number of fields: it contains sums of the products of u and v up to fourth order and, for the autocorrelation,
/// the last `lags` fields and the sums of their products.
///
/// Includes vectors that were measured: valid vectors, and vectors replaced by a secondary peak of the same window.
/// Vectors replaced by the median of their neighbours are interpolated and would reduce the stresses.
///
/// With the autocorrelation rho_k at lag k and n vectors, the effective number of independent samples is
/// N = n/(1 + 2 sum_k (1 - k/n) rho_k); the sum ends before the first rho_k <= 0 (Smith, Neal, Feero & Richards,
/// Meas. Sci. Technol. 29 (2018) 125302). Standard errors with the central moments m_ij = mean(u^i v^j):
/// - mean: sqrt(m20/(N - 1)),
/// - stresses: sqrt((m40 - m20^2)/N_uu), sqrt((m22 - m11^2)/N_uv) (Benedict & Gould, Exp. Fluids 22 (1996) 129), where
///   N_uu contains rho_k^2 and N_uv the product of both autocorrelations (Gaussian processes),
/// - rms: standard error of the normal stress divided by twice the rms.
/// Sums are computed of the deviations from the first vector of each point, so that a large mean does not reduce the
/// accuracy. The result
/// does not depend on the number of threads.
class SequenceStatistics {
 public:
  /// @param lags  maximum number of lags; reduced for large fields, so that at most 512 MiB are used
  explicit SequenceStatistics(std::size_t lags = 32);

  /// Adds the next field. @pre it has the positions of the first one
  void add(DisplacementField const& field);
  /// Adds a gap in place of a missing field, so that the lags between its neighbours remain correct.
  void skip();

  std::size_t samples() const { return samples_; }
  SequenceMoments moments();

 private:
  /// Sums of a^i b^j over the vectors of a point, where a and b are the deviations of u and v from the first vector of
  /// the point.
  struct Powers {
    double n = 0, a = 0, b = 0, aa = 0, ab = 0, bb = 0, aaa = 0, aab = 0, abb = 0, bbb = 0, aaaa = 0, aabb = 0,
           bbbb = 0;
  };
  /// Points whose values are stored together, so that loops over them use SIMD instructions.
  static constexpr std::size_t block_points = 64;
  using Values = std::array<double, block_points>;
  /// Sums at one lag over the pairs of vectors at time t and t - lag, for the points of a block.
  struct Products {
    Values n{}, now_u{}, now_v{}, before_u{}, before_v{}, uu{}, vv{};
  };
  /// Deviations from the first vectors, for the points of a block.
  struct Deviations {
    Values u{}, v{};
    Values known{};  ///< 1 if measured, else 0 with u = v = 0
  };

  /// Central moments of a point, sums divided by n [px, px^2, px^4].
  struct CentralMoments {
    Vec2d mean;  ///< mean of the deviations
    double m20 = 0, m11 = 0, m02 = 0, m40 = 0, m22 = 0, m04 = 0;
  };
  /// Effective number of independent samples for the means and for the stresses.
  struct IndependentSamples {
    Vec2d mean;
    double uu = 0, vv = 0, uv = 0;
    bool unresolved = false;  ///< true if an autocorrelation is positive at every recorded lag
  };

  void start(DisplacementField const& field);
  void add_block(DisplacementField const& field, std::size_t block);
  /// Counts a field, and adds the products of the latest fields once several fields have been added.
  void finish_sample();
  /// Adds the products of the latest fields with those before them. Processing several fields at once reads and writes
  /// the sums only once.
  void add_products();
  CentralMoments central_moments(std::size_t point) const;
  IndependentSamples count_independent(std::size_t point, CentralMoments const& m) const;
  Deviations& deviations(std::size_t block, std::size_t sample) { return history_[block * slots_ + sample % slots_]; }

  std::size_t lags_, size_ = 0, blocks_ = 0, samples_ = 0;
  std::size_t slots_ = 0;          ///< number of fields in the history: the lags and the latest fields
  std::size_t with_products_ = 0;  ///< number of fields whose products have been added
  std::vector<Vec2d> position_px_, first_;
  int columns_ = 0, rows_ = 0;
  std::vector<Powers> powers_;
  std::vector<Products> products_;   ///< products for each block of points and each lag: [block][lag - 1]
  std::vector<Deviations> history_;  ///< latest fields of each block of points: [block][sample % slots_]
};

/// Writes statistics.h5. @throws OutputError
void write_sequence_statistics(std::string const& path, SequenceMoments const& moments, FileOrigin const& origin);

}  // namespace gladstone::inline vectors
