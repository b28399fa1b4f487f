#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "render/focused_dots/displacement_moments.h"
#include "render/focused_dots/spot_factors.h"

/// Light of dots whose displacements spread over several widths of the PSF. The displacements are sorted into squares,
/// and the light of each square is computed from a few moments (Hermite series, as in the fast Gauss transform of
/// Greengard & Strain 1991). The squares' centres are on a lattice that subdivides the sensor's pixels, so that the
/// image of a source for each moment is the same for all dots and is computed once.
namespace gladstone::inline focused_dots {

/// Lattice of squares on the sensor. It is offset from the pixels by `aside`: dots of regular targets with zero
/// displacement fall on pixel centres and edges, where different devices could otherwise round them into different
/// squares.
struct MomentLattice {
  static constexpr double aside = 0.01;  ///< position of the centre of square 0, relative to the centre of pixel 0 [px]
  int per_pixel = 1;                     ///< number of squares along a pixel's side
  int pixels = 1;                        ///< number of pixels along a square's side; this or per_pixel is 1

  /// Returns the lattice with the largest squares whose side does not exceed `side` [px].
  GLADSTONE_HD static MomentLattice no_coarser(double side) {
    if (side >= 1) return {1, static_cast<int>(side)};
    return {static_cast<int>(std::ceil(1 / side)), 1};
  }
  GLADSTONE_HD double side() const { return static_cast<double>(pixels) / per_pixel; }
  GLADSTONE_HD double per_side() const { return static_cast<double>(per_pixel) / pixels; }
  /// Position of a square's centre along an axis: a pixel, and one of per_pixel positions (phases) about the pixel's
  /// centre.
  GLADSTONE_HD int pixel(int square) const {
    int const shifted = square + per_pixel / 2;
    int const down = shifted / per_pixel - (shifted % per_pixel < 0 ? 1 : 0);
    return down * pixels;
  }
  GLADSTONE_HD int phase(int square) const {
    int const rest = (square + per_pixel / 2) % per_pixel;
    return rest < 0 ? rest + per_pixel : rest;
  }
  /// Returns the position of the centre of a square with this phase, relative to its pixel's centre [px].
  GLADSTONE_HD double offset(int phase) const {
    int const from_middle = phase - per_pixel / 2;
    return static_cast<double>(from_middle) / per_pixel + aside;
  }
};

/// Squares into which a dot's displacements are sorted, counted from the one at zero displacement: those of the
/// sensor's lattice or, if there would be too many, squares two or four times as wide.
struct DotSquares {
  static constexpr int most_step = 4;
  MomentLattice lattice;
  int step = 1;           ///< side of one of the dot's squares, as a multiple of the side of the sensor's squares
  Vec2<int> first{0, 0};  ///< index, in the sensor's lattice, of the dot's square (0, 0)
  Vec2d zero{};           ///< position of the undisplaced dot, relative to the centre of that square [px]

  /// @param origin  image position of the dot at zero displacement [px]
  /// @param squares_apart  side of a square in squares of the sensor's lattice
  GLADSTONE_HD DotSquares(MomentLattice const& of_sensor, Vec2d origin, int squares_apart)
      : lattice(of_sensor), step(squares_apart) {
    using std::floor;
    auto const nearest = [per_side = lattice.per_side()](double p) {
      double const at = floor(p * per_side + 0.5);
      // clamped, since farther displacements are not sorted into squares
      return at < -1e7 ? -1e7 : (at > 1e7 ? 1e7 : at);
    };
    origin = origin - Vec2d{MomentLattice::aside, MomentLattice::aside};
    Vec2d const at{nearest(origin.x), nearest(origin.y)};
    first = {static_cast<int>(at.x), static_cast<int>(at.y)};
    zero = origin - lattice.side() * at;
  }
  /// Returns the square that contains a displacement.
  GLADSTONE_HD Vec2<int> square_of(Vec2d displacement) const {
    using std::floor;
    auto const cell = [per_side = lattice.per_side() / step](double d) {
      double const at = floor(d * per_side + 0.5);
      return static_cast<int>(at < -1000 ? -1000 : (at > 1000 ? 1000 : at));
    };
    return {cell(displacement.x + zero.x), cell(displacement.y + zero.y)};
  }
  /// Returns a displacement relative to the displacement at a square's centre [px].
  GLADSTONE_HD Vec2d from_middle(Vec2d displacement, Vec2<int> square) const {
    double const side = step * lattice.side();
    return displacement + zero - Vec2d{side * square.x, side * square.y};
  }
  /// Returns the sensor's square at the centre of one of the dot's squares.
  GLADSTONE_HD Vec2<int> on_sensor(Vec2<int> square) const { return first + step * square; }
  /// Returns the two-dimensional phase of a square's centre: phase along y times per_pixel plus phase along x.
  GLADSTONE_HD int phase(Vec2<int> square) const {
    Vec2<int> const at = on_sensor(square);
    return lattice.phase(at.y) * lattice.per_pixel + lattice.phase(at.x);
  }
};

/// Bounding box of displacements [px].
struct Extent {
  Vec2d low{1e300, 1e300}, high{-1e300, -1e300};

  GLADSTONE_HD void include(Vec2d d) {
    low = {d.x < low.x ? d.x : low.x, d.y < low.y ? d.y : low.y};
    high = {d.x > high.x ? d.x : high.x, d.y > high.y ? d.y : high.y};
  }
  GLADSTONE_HD void include(Extent const& o) {
    low = {o.low.x < low.x ? o.low.x : low.x, o.low.y < low.y ? o.low.y : low.y};
    high = {o.high.x > high.x ? o.high.x : high.x, o.high.y > high.y ? o.high.y : high.y};
  }
};

/// Range of the squares (DotSquares) that a dot's displacements cover.
struct SquareRange {
  static constexpr int most = 576;  ///< maximum number of squares that are processed one by one
  Vec2<int> low{0, 0}, high{0, 0};

  GLADSTONE_HD int columns() const { return high.x - low.x + 1; }
  GLADSTONE_HD int rows() const { return high.y - low.y + 1; }
  GLADSTONE_HD int count() const { return columns() * rows(); }
  GLADSTONE_HD int index(Vec2<int> square) const { return (square.y - low.y) * columns() + square.x - low.x; }
  GLADSTONE_HD Vec2<int> square(int index) const { return {low.x + index % columns(), low.y + index / columns()}; }
};

/// Squares of the smallest size for which the displacements of a dot cover at most SquareRange::most squares, and the
/// range of these squares.
struct SpannedSquares {
  DotSquares squares;
  SquareRange range;
  bool few;

  GLADSTONE_HD SpannedSquares(MomentLattice const& lattice, Vec2d origin, Extent const& extent)
      : squares(lattice, origin, 1) {
    span(extent);
    for (int step = 2; !few && step <= DotSquares::most_step; step *= 2) {
      squares = DotSquares(lattice, origin, step);
      span(extent);
    }
  }

 private:
  GLADSTONE_HD void span(Extent const& extent) {
    range.low = squares.square_of(extent.low);
    range.high = squares.square_of(extent.high);
    few = range.count() <= SquareRange::most;
  }
};

/// Images of a source: one for each phase of a square's centre, each moment of the displacements within the square, and
/// each term of the polynomial in the position on the source. A non-owning view.
struct MomentImages {
  MomentLattice lattice;
  int half = 0;                    ///< half width of an image, without its middle pixel [px]
  int terms = 0;                   ///< number of terms: PlaceRule::terms, or 1 for a point; 0: no images
  int stride = 0;                  ///< distance between successive images in `values` [numbers]
  double const* values = nullptr;  ///< [phase y][phase x][moment][term][row, column]

  /// Determines size and number of the images of a source with a Gaussian PSF, without their `values`. Returns no
  /// images if they would need more than 64 MiB or the PSF is too wide.
  /// @param half_px  half size of the source's image [px]
  /// @param side  maximum side of a square [px]
  /// @param terms  6, or 1 for a point
  static MomentImages plan(double half_px, GaussianSpot<double> const& spot, double side, int terms);

  static constexpr int pad = 16;  ///< alignment: `stride` is a multiple of this
  /// Number of PSF factors of one point.
  GLADSTONE_HD static constexpr int factors(int pitch) { return 2 * (DisplacementMoments::order + 1) * pitch; }

  GLADSTONE_HD bool exist() const { return terms > 0; }
  GLADSTONE_HD int width() const { return 2 * half + 1; }
  GLADSTONE_HD int count() const { return DisplacementMoments::count * terms; }
  GLADSTONE_HD int phases() const { return lattice.per_pixel * lattice.per_pixel; }
  /// Returns the centre of the squares of a phase relative to the pixel's centre [px].
  /// @param phase  phase along y times per_pixel plus phase along x
  GLADSTONE_HD Vec2d middle(int phase) const {
    return {lattice.offset(phase % lattice.per_pixel), lattice.offset(phase / lattice.per_pixel)};
  }
  std::size_t size() const {
    return static_cast<std::size_t>(phases()) * static_cast<std::size_t>(count()) * static_cast<std::size_t>(stride);
  }
  /// Returns the pixels that the light of one of the sensor's squares reaches.
  GLADSTONE_HD Footprint footprint(Vec2<int> square) const {
    return {lattice.pixel(square.x) - half, lattice.pixel(square.y) - half, width()};
  }
  /// Returns the first image of the squares of a phase (position in the pixel).
  GLADSTONE_HD double const* of_phase(int phase) const {
    return values + static_cast<std::size_t>(phase) * count() * stride;
  }
};

/// Points of a unit disc or square with weights of sum one: a non-owning view.
struct CubatureView {
  Vec2d const* points = nullptr;  ///< points in units of the half size
  double const* weights = nullptr;
  int count = 0;
};

/// Adds the contributions of a source's points to the images of one phase and some moments, by a group of lanes.
/// @tparam pixels  number of pixels that a lane processes together: at least the width of the PSF (row by row), or 1
/// @tparam moments  number of moments, from `begin` on
/// @param first  image of the phase and of moment `begin`
/// @param room  work space for the factors of `points` points
template <int pixels, int moments, class Group>
GLADSTONE_HD void add_to_images(Group const& group, MomentImages const& images, CubatureView const& source,
                                double half_px, GaussianSpot<double> const& spot, int phase, int begin, double* first,
                                double* room, int points) {
  using M = DisplacementMoments;
  constexpr bool rows = pixels > 1;
  constexpr int orders = M::order + 1, terms = PlaceRule::terms;
  int const width = 2 * spot.half_width() + 1, pitch = rows ? pixels : width + 1, side = images.width();
  auto const at_point = [&](int i) { return images.middle(phase) + half_px * source.points[i]; };
  for (int base = 0; base < source.count; base += points) {
    group.poll();
    int const here = source.count - base < points ? source.count - base : points;
    spot_factors<orders>(
        group, spot, [&](int which) { return at_point(base + which); }, here, pitch, 2 * orders * pitch, room);
    for (int unit = group.lane(); unit < (rows ? side : side * side); unit += group.size()) {
      int const row = rows ? unit : unit / side;
      double sums[rows ? 1 : moments * terms] = {};
      for (int which = 0; which < here; ++which) {
        Footprint const reach = spot.footprint(at_point(base + which));
        int const j = row - images.half - reach.row, left = reach.column + images.half;
        int const i = rows ? 0 : unit % side - left;
        if (j < 0 || j >= width || i < 0 || i >= width) continue;
        double basis[terms];
        PlaceRule::basis(source.points[base + which], basis);
        double const* const along_x = room + which * 2 * orders * pitch + i;
        double const* const along_y = room + which * 2 * orders * pitch + orders * pitch + j;
        for (int k = 0; k < moments; ++k) {
          int const order = M::total_order(begin + k), b = begin + k - M::at(order, 0);
          for (int term = 0; term < terms && term < images.terms; ++term) {
            double const share = source.weights[base + which] * basis[term] * along_y[b * pitch];
            double* const to =
                rows ? first + (k * images.terms + term) * images.stride + row * side + left : sums + k * terms + term;
            for (int c = 0; c < pixels; ++c) to[c] += share * along_x[(order - b) * pitch + c];
          }
        }
      }
      for (int k = 0; k < moments * terms && !rows; ++k) {
        if (k % terms < images.terms) first[(k / terms * images.terms + k % terms) * images.stride + unit] += sums[k];
      }
    }
    group.sync();
  }
}

/// Computes the images of plan() on all CPU cores.
/// @param source  points in units of half_px, with weights of sum one
std::vector<double> make_moment_images(MomentImages const& plan, CubatureView const& source, double half_px,
                                       GaussianSpot<double> const& spot);

}  // namespace gladstone::inline focused_dots
