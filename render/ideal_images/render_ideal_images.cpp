#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "render/base/freed_memory.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "render/ideal_images/ideal_images.h"
#include "render/scene/particle_scene.h"

namespace gladstone {
namespace {

constexpr int frames = 2;
constexpr int band_rows = 64;  // rows of an image that one thread renders at a time

/// Indices of the particle images that overlap each band of image rows, in ascending order. Sums within a band
/// therefore have a fixed order, independent of the thread that renders it.
class Bands {
 public:
  Bands(std::vector<ParticleImage> const& spots, int rows, int half)
      : begin_(static_cast<std::size_t>((rows + band_rows - 1) / band_rows) + 1) {
    auto const each = [&](auto const& enter) {
      for (std::size_t i = 0; i < spots.size(); ++i) {
        if (!(spots[i].light > 0)) continue;
        double const first = std::floor(spots[i].at.y + 0.5) - half, last = first + 2 * half;
        if (last < 0 || first > rows - 1) continue;
        int const from = static_cast<int>(std::max(first, 0.0)) / band_rows;
        int const to = static_cast<int>(std::min(last, rows - 1.0)) / band_rows;
        for (int band = from; band <= to; ++band) enter(static_cast<std::size_t>(band), i);
      }
    };
    each([this](std::size_t band, std::size_t) { ++begin_[band + 1]; });
    for (std::size_t band = 1; band < begin_.size(); ++band) begin_[band] += begin_[band - 1];
    listed_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    each([&](std::size_t band, std::size_t spot) { listed_[next[band]++] = static_cast<std::uint32_t>(spot); });
  }
  std::size_t count() const { return begin_.size() - 1; }
  std::uint32_t const* begin(std::size_t band) const { return listed_.data() + begin_[band]; }
  std::uint32_t const* end(std::size_t band) const { return listed_.data() + begin_[band + 1]; }

 private:
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> listed_;
};

constexpr int most_fast_width = 15;  // width of footprints that are computed in SIMD registers [px]

/// Computes the shares of a footprint along one axis, like GaussianSpot::shares() but 16 edges at a time, and sets
/// those behind its end to zero. @param out  16 numbers  @pre width <= most_fast_width
void compute_shares(GaussianSpot<double> const& shape, double p, int first, int width, double* out) {
  constexpr double offset[8] = {-0.5, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5};
  using Four = Lanes<double, 4>;
  Four const scale = Four::all(1 / shape.sigma), left = Four::all(first - p), right = Four::all(first + 8 - p);
  Four value[4] = {(left + Four::load(offset)) * scale, (left + Four::load(offset + 4)) * scale,
                   (right + Four::load(offset)) * scale, (right + Four::load(offset + 4)) * scale};
  GaussianSpot<double>::edge_values(value);
  double edges[17];
  for (int i = 0; i < 16; ++i) edges[i] = value[i / 4].lane(i % 4);
  edges[16] = edges[15];
  for (int i = 0; i < 16; ++i) out[i] = i < width ? edges[i + 1] - edges[i] : 0.0;
}

/// Adds shares times light to the pixels of one row. @tparam count  number of pixels
template <int count>
void add_row(double light, double const* from, double* to) {
  for (int i = 0; i < count; ++i) to[i] += light * from[i];
}

/// Adds particle images to the rows of a band.
class BandDrawing {
 public:
  BandDrawing(GaussianSpot<double> const& shape, std::size_t band, Image<double>& image)
      : shape_(shape),
        width_(2 * shape.half_width() + 1),
        top_(static_cast<int>(band) * band_rows),
        bottom_(std::min(top_ + band_rows, image.rows())),
        image_(image),
        across_(static_cast<std::size_t>(std::max(width_, 16))),
        down_(across_.size()) {}

  void add(ParticleImage const& one) {
    if (!(std::abs(one.at.x) < 1e8)) return;
    Footprint const print = shape_.footprint(one.at);
    int const left = std::max(0, print.column), right = std::min(image_.columns(), print.column + width_);
    if (left >= right) return;
    if (width_ <= most_fast_width) {
      compute_shares(shape_, one.at.x, print.column, width_, across_.data());
      compute_shares(shape_, one.at.y, print.row, width_, down_.data());
    } else {
      shape_.shares(one.at.x, print.column, width_, across_.data());
      shape_.shares(one.at.y, print.row, width_, down_.data());
    }
    // Shares of zero behind the footprint do not change a pixel.
    if (width_ <= 12 && print.column >= 0 && print.column + 12 <= image_.columns()) {
      add_rows(one.light, print, left, [this](double light, double* to) { add_row<12>(light, across_.data(), to); });
    } else if (width_ <= 16 && print.column >= 0 && print.column + 16 <= image_.columns()) {
      add_rows(one.light, print, left, [this](double light, double* to) { add_row<16>(light, across_.data(), to); });
    } else {
      double const* const from = across_.data() + (left - print.column);
      add_rows(one.light, print, left, [from, count = right - left](double light, double* to) {
        for (int i = 0; i < count; ++i) to[i] += light * from[i];
      });
    }
  }

 private:
  template <class Row>
  void add_rows(double light, Footprint print, int left, Row const& add) {
    for (int row = std::max(top_, print.row); row < std::min(bottom_, print.row + width_); ++row) {
      add(light * down_[static_cast<std::size_t>(row - print.row)], &image_(left, row));
    }
  }

  GaussianSpot<double> shape_;
  int width_, top_, bottom_;
  Image<double>& image_;
  std::vector<double> across_, down_;
};

Image<double> draw(std::vector<ParticleImage> const& spots, Scene const& scene) {
  CameraSetup const& camera = scene.setup.camera;
  GaussianSpot<double> const shape{scene.spot_sigma_px()};
  Image<double> image(camera.columns, camera.rows);
  Bands const bands(spots, camera.rows, shape.half_width());
  parallel_for(bands.count(), [&](std::size_t band) {
    BandDrawing drawing(shape, band, image);
    for (std::uint32_t const* spot = bands.begin(band); spot != bands.end(band); ++spot) drawing.add(spots[*spot]);
  });
  return image;
}

/// Returns the truth of particles with given image positions, and light in photons.
GroundTruth truth_of(Particles const& particles, std::array<std::vector<ParticleImage>, frames> const& spots) {
  GroundTruth truth;
  truth.resize(particles.size());
  truth.position_m = particles.place[0];
  truth.particles.second_m = particles.place[1];
  truth.particles.diameter_m = particles.diameter;
  for (auto* const theory : {&truth.eq9_px, &truth.chief_px, &truth.eq9_cone_px})
    theory->assign(truth.size(), {not_a_number, not_a_number});
  parallel_chunks(truth.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ParticleImage const &first = spots[0][i], &second = spots[1][i];
      bool const both = first.light > 0 && second.light > 0;
      truth.reference_px[i] = first.light > 0 ? first.at : Vec2d{not_a_number, not_a_number};
      truth.displacement_px[i] = both ? second.at - first.at : Vec2d{not_a_number, not_a_number};
      truth.displacement_error_px[i] = both ? Vec2d{} : Vec2d{not_a_number, not_a_number};
      truth.displacement_std_px[i] = second.light > 0 ? Vec2d{} : Vec2d{not_a_number, not_a_number};
      truth.flux[i] = {first.light, second.light};
    }
  });
  truth.particles.reference_ambient_px = truth.reference_px;
  truth.particles.displacement_ambient_px = truth.displacement_px;
  return truth;
}

}  // namespace

Rendering render_ideal_images(IdealImages const& ideal, Particles const& particles, ParticleLight light,
                              RenderImages images, ImageDrawer* drawer) {
  keep_freed_memory();  // Retain freed memory: for successive pairs, page faults took a third of the time.
  Scene const& scene = ideal.scene();
  LightThroughLens const through_lens(scene, light);
  IdealProjection const project = ideal.projection();
  std::array<std::vector<ParticleImage>, frames> spots;
  for (std::size_t pulse = 0; pulse < frames; ++pulse) {
    spots[pulse].resize(particles.size());
    parallel_chunks(particles.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        double const photons = particles.photons[pulse][i];
        if (!(photons > 0)) continue;
        Vec3d const place = particles.place[pulse][i];
        spots[pulse][i] = {project(place), photons * through_lens(place, i, static_cast<int>(pulse))};
      }
    });
  }
  Rendering rendering;
  rendering.table = TableState::by_formula;
  rendering.method = RenderMethod::formula;
  rendering.truth = truth_of(particles, spots);
  if (images == RenderImages::no) return rendering;
  double const unit = photon_unit(scene, particles, light);
  for (auto& frame : spots) {
    for (ParticleImage& spot : frame) spot.light /= unit;
  }
  if (drawer) {
    CameraSetup const& camera = scene.setup.camera;
    rendering.in_place = drawer->draw(spots, {scene.spot_sigma_px()}, camera.columns, camera.rows);
    if (images == RenderImages::yes) rendering.light = std::exchange(rendering.in_place, nullptr)->to_host();
    return rendering;
  }
  rendering.light = {draw(spots[0], scene), draw(spots[1], scene)};
  if (images == RenderImages::in_place) rendering.store_light_in_place();
  return rendering;
}

}  // namespace gladstone
