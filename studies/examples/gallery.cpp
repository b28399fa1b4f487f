#include "studies/examples/gallery.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "analysis/errors/error_summary.h"
#include "studies/case/case.h"
#include "studies/case/shared_folder.h"
#include "studies/case/write_case.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/draw_or_warn.h"
#include "studies/figures/map_panels.h"

namespace gladstone::inline examples {
namespace {

namespace fs = std::filesystem;

struct GalleryPicture {
  char const* name;  ///< name of the setup
  char const* title;
  char const* look;  ///< what the image shows
};

/// The first image is the reference for the others.
constexpr std::array pictures{
    GalleryPicture{"normal", "normal", "particles in the middle of the sheet, in focus"},
    GalleryPicture{"out_of_focus", "out of focus",
                   "discs in the shape of the stop instead of points, and less light in each pixel"},
    GalleryPicture{"aberration", "lens aberration near the edges",
                   "images elongated towards the corners, round in the middle"},
    GalleryPicture{"perspective", "perspective", "oblique view: the image scale varies across the image"},
    GalleryPicture{"shock", "normal shock in an oblique view",
                   "particles behind the front are displaced and elongated"},
    GalleryPicture{"oblique", "oblique view, sensor square to the axis", "sharp along one line only"},
    GalleryPicture{"scheimpflug", "oblique view, Scheimpflug", "the same view with a tilted sensor: sharp everywhere"},
    GalleryPicture{"plenoptic", "plenoptic raw image",
                   "one image of the stop for a particle in focus, parts of it behind several lenslets for others"},
};

/// Fraction of pixels of the normal image shown without clipping; the brightest particles are white.
constexpr double shown_share = 0.998;

std::vector<double> levels_of(Image<double> const& image) { return {image.begin(), image.end()}; }

MapFigure grey_figure(int columns, std::vector<GalleryPicture> const& of, std::vector<Image<double>> const& images,
                      double white) {
  MapFigure figure;
  figure.columns = columns;
  for (std::size_t i = 0; i < of.size(); ++i) {
    MapPanel panel;
    panel.title = of[i].title;
    panel.map = images[i];
    panel.scale = ColourScale::grey;
    panel.lower = 0;
    panel.upper = white;
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace

std::string run_gallery(std::string const& folder, Backend const& device) {
  std::string const cases = (fs::path(shared_folder()) / "studies" / "cases" / "figure1").string();
  std::vector<Image<double>> images;
  std::vector<GalleryPicture> const all(pictures.begin(), pictures.end());
  for (GalleryPicture const& picture : all) {
    spdlog::info("{}: {}", picture.name, picture.title);
    std::string const place = (fs::path(folder) / picture.name).string();
    std::string const path = (fs::path(cases) / (std::string(picture.name) + ".toml")).string();
    CaseSetup loaded = load_case_setup(path, {});
    std::vector<std::string> inputs = loaded.document.file_names();
    inputs.push_back(path);
    refuse_case_over_inputs(place, inputs);
    images.push_back(render_to_folder(loaded, *device.renderer, place).frames.levels->reference());
  }
  double const white = std::max(1.0, quantile(levels_of(images.front()), shown_share));
  std::string text = fmt::format("Images in {}: level 0 is black, levels from {:.0f} on are white.\n\n", folder, white);
  for (GalleryPicture const& picture : all)
    text += fmt::format("{:<13} {}: {}\n", picture.name, picture.title, picture.look);
  draw_or_warn([&] {
    for (std::size_t i = 1; i < all.size(); ++i) {
      draw_figure(make_map_figure(grey_figure(2, {all[0], all[i]}, {images[0], images[i]}, white)),
                  (fs::path(folder) / all[i].name / "beside.png").string());
    }
    draw_figure(make_map_figure(grey_figure(4, all, images, white)), (fs::path(folder) / "gallery.png").string());
  });
  return text;
}

}  // namespace gladstone::inline examples
