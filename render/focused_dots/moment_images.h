#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "render/focused_dots/displacement_moments.h"
#include "render/focused_dots/spot_factors.h"

/// Light of dots whose displacements spread over several widths of a spot: they are sorted into squares, within each of
/// which a few moments tell the light (Hermite series, as in the fast Gauss transform of Greengard & Strain 1991). The
/// squares' middles lie on a lattice that divides the sensor's pixels, so that what a moment does to the image of a
/// source is the same for all dots, and worked out once.
namespace gladstone {

/// The lattice of squares on the sensor, by its side. It lies a little aside of the pixels, whose middles and edges are
/// where displacements of nothing put the points of regular targets: no two devices round those to different squares.
struct MomentLattice {
  static constexpr double aside = 0.01;  ///< middle of square 0 [px]
  int per_pixel = 1;                     ///< squares along a pixel's side
  int pixels = 1;                        ///< or pixels along a square's side; one of the two is 1

  /// With squares no larger than `side` [px].
  GLADSTONE_HD static MomentLattice no_coarser(double side) {
    if (side >= 1) return {1, static_cast<int>(side)};
    return {static_cast<int>(std::ceil(1 / side)), 1};
  }
  GLADSTONE_HD double side() const { return static_cast<double>(pixels) / per_pixel; }
  GLADSTONE_HD double per_side() const { return static_cast<double>(per_pixel) / pixels; }
  /// Where the middle of a square lies along an axis: a pixel, and which of per_pixel places about the pixel's middle.
  GLADSTONE_HD int pixel(int square) const {
    int const shifted = square + per_pixel / 2;
    int const down = shifted / per_pixel - (shifted % per_pixel < 0 ? 1 : 0);
    return down * pixels;
  }
  GLADSTONE_HD int phase(int square) const {
    int const rest = (square + per_pixel / 2) % per_pixel;
    return rest < 0 ? rest + per_pixel : rest;
  }
  /// From the pixel's middle to the square's [px].
  GLADSTONE_HD double offset(int phase) const {
    int const from_middle = phase - per_pixel / 2;
    return static_cast<double>(from_middle) / per_pixel + aside;
  }
};

/// A dot's squares of displacement, counted from the one at its middle: those of the sensor or, where they would be too
/// many, larger ones about every second or fourth of these along either axis.
struct DotSquares {
  static constexpr int most_step = 4;
  MomentLattice lattice;
  int step = 1;           ///< squares of the sensor from one to the next
  Vec2<int> first{0, 0};  ///< of the sensor's squares: the dot's square (0, 0)
  Vec2d zero{};           ///< displacement zero, from that square's middle [px]

  /// @param origin image of the dot displaced by zero [px]
  GLADSTONE_HD DotSquares(MomentLattice const& of_sensor, Vec2d origin, int squares_apart)
      : lattice(of_sensor), step(squares_apart) {
    using std::floor;
    auto const nearest = [per_side = lattice.per_side()](double p) {
      double const at = floor(p * per_side + 0.5);
      return at < -1e7 ? -1e7 : (at > 1e7 ? 1e7 : at);  // beyond, displacements are too far from it to be sorted
    };
    origin = origin - Vec2d{MomentLattice::aside, MomentLattice::aside};
    Vec2d const at{nearest(origin.x), nearest(origin.y)};
    first = {static_cast<int>(at.x), static_cast<int>(at.y)};
    zero = origin - lattice.side() * at;
  }
  GLADSTONE_HD Vec2<int> square_of(Vec2d displacement) const {
    using std::floor;
    auto const cell = [per_side = lattice.per_side() / step](double d) {
      double const at = floor(d * per_side + 0.5);
      return static_cast<int>(at < -1000 ? -1000 : (at > 1000 ? 1000 : at));
    };
    return {cell(displacement.x + zero.x), cell(displacement.y + zero.y)};
  }
  /// A displacement counted from a square's middle [px].
  GLADSTONE_HD Vec2d from_middle(Vec2d displacement, Vec2<int> square) const {
    double const side = step * lattice.side();
    return displacement + zero - Vec2d{side * square.x, side * square.y};
  }
  /// The sensor's square at the middle of one of the dot's.
  GLADSTONE_HD Vec2<int> on_sensor(Vec2<int> square) const { return first + step * square; }
  /// Of its middle on its pixel: y times per_pixel plus x.
  GLADSTONE_HD int phase(Vec2<int> square) const {
    Vec2<int> const at = on_sensor(square);
    return lattice.phase(at.y) * lattice.per_pixel + lattice.phase(at.x);
  }
};

/// What displacements spread over [px].
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

/// The squares that a distribution of displacements spans.
struct SquareRange {
  static constexpr int most = 576;  ///< that it pays to go through one by one
  Vec2<int> low{0, 0}, high{0, 0};

  GLADSTONE_HD int columns() const { return high.x - low.x + 1; }
  GLADSTONE_HD int rows() const { return high.y - low.y + 1; }
  GLADSTONE_HD int count() const { return columns() * rows(); }
  GLADSTONE_HD int index(Vec2<int> square) const { return (square.y - low.y) * columns() + square.x - low.x; }
  GLADSTONE_HD Vec2<int> square(int index) const { return {low.x + index % columns(), low.y + index / columns()}; }
};

/// A dot's squares and which of them its displacements span: the smallest squares that are few.
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

/// Images of a source, one for each moment of its displacements within a square and each term of the place on the
/// source, for each place of the square's middle on its pixel. A view.
struct MomentImages {
  MomentLattice lattice;
  int half = 0;                    ///< pixels to each side of the square's
  int terms = 0;                   ///< of the place: PlaceRule::terms, or 1 for a point; 0: there are no images
  int stride = 0;                  ///< from one image to the next
  double const* values = nullptr;  ///< [phase y][phase x][moment][term][row, column]

  /// Of a source as wide as 2 half_px under a Gaussian spot, values still to be worked out; none where they would take
  /// too much memory. @param side most of a square [px] @param terms 6, or 1 for a point
  static MomentImages plan(double half_px, GaussianSpot<double> const& spot, double side, int terms);

  static constexpr int pad = 16;  ///< stride is a multiple of it
  /// Numbers that the factors of a point take.
  GLADSTONE_HD static constexpr int factors(int pitch) { return 2 * (DisplacementMoments::order + 1) * pitch; }

  GLADSTONE_HD bool exist() const { return terms > 0; }
  GLADSTONE_HD int width() const { return 2 * half + 1; }
  GLADSTONE_HD int count() const { return DisplacementMoments::count * terms; }
  GLADSTONE_HD int phases() const { return lattice.per_pixel * lattice.per_pixel; }
  /// Middle of a phase's squares, from their pixel's [px]. @param phase y times per_pixel plus x
  GLADSTONE_HD Vec2d middle(int phase) const {
    return {lattice.offset(phase % lattice.per_pixel), lattice.offset(phase / lattice.per_pixel)};
  }
  std::size_t size() const {
    return static_cast<std::size_t>(phases()) * static_cast<std::size_t>(count()) * static_cast<std::size_t>(stride);
  }
  /// Pixels that the light of one of the sensor's squares falls on.
  GLADSTONE_HD Footprint footprint(Vec2<int> square) const {
    return {lattice.pixel(square.x) - half, lattice.pixel(square.y) - half, width()};
  }
  /// The first image of a phase.
  GLADSTONE_HD double const* of_phase(int phase) const {
    return values + static_cast<std::size_t>(phase) * count() * stride;
  }
};

/// Points of a unit disc (or square) with weights of sum one, as a view.
struct CubatureView {
  Vec2d const* points = nullptr;  ///< in units of the half size
  double const* weights = nullptr;
  int count = 0;
};

/// Adds what a source's points leave in the images of one phase and some moments, by a group of lanes.
/// @tparam pixels that a lane works out side by side: a spot's width and more, row by row, or 1
/// @tparam moments from `begin` on @param first of the phase and moment `begin`
/// @param room for the factors of so many points at a time
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
          int const order = M::order_of(begin + k), b = begin + k - M::at(order, 0);
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

/// Works out a plan's images, on all cores. @param source in units of half_px, with weights of sum one
std::vector<double> make_moment_images(MomentImages const& plan, CubatureView const& source, double half_px,
                                       GaussianSpot<double> const& spot);

}  // namespace gladstone
