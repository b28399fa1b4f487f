#include "studies/case/target_pattern.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/scene/scene.h"

namespace gladstone::inline cases {
namespace {

constexpr double side_margin_mm = 10, bottom_margin_mm = 20, least_width_mm = 110;
constexpr double bar_thickness_mm = 1, letter_height_mm = 3.5;

/// Returns the largest of 1, 2 and 5 times a power of ten up to a length.
double round_length(double most) {
  double const power = std::pow(10.0, std::floor(std::log10(most)));
  for (double const digit : {5.0, 2.0}) {
    if (digit * power <= most) return digit * power;
  }
  return power;
}

void require_size(TargetPattern const& pattern) {
  if (pattern.diameter > 0) return;
  throw DataError(ErrorCode::out_of_range, KeyPath{"target.dot_diameter_mm"},
                  "is 0 (points cannot be printed); give the dots a size, or write .csv");
}

/// Positions of the parts of a page [mm], from its upper left corner, y downwards.
struct PagePlaces {
  explicit PagePlaces(TargetPattern const& of) : pattern(of), page(make_target_page(of)) {
    bar_top = page.size_mm.y - bottom_margin_mm + 6;
    text_base = bar_top + bar_thickness_mm + letter_height_mm + 1;
  }

  Vec2d dot(std::size_t i) const {
    Vec2d const from_middle = (pattern.centre[i] - pattern.middle) / unit::mm, half = pattern.extent / unit::mm / 2;
    return {page.corner_mm.x + half.x + from_middle.x, page.corner_mm.y + half.y - from_middle.y};
  }
  std::string text() const {
    return fmt::format("{:g} mm; page {:.6g} x {:.6g} mm, print at 100 %", page.scale_bar_mm, page.size_mm.x,
                       page.size_mm.y);
  }

  TargetPattern const& pattern;
  TargetPage page;
  double bar_top, text_base;
};

/// Returns a PDF object.
std::string pdf_object(std::size_t number, std::string const& content) {
  return fmt::format("{} 0 obj\n{}\nendobj\n", number, content);
}

std::string pdf_stream(std::string const& entries, std::string const& content) {
  return fmt::format("<< {}/Length {} >>\nstream\n{}\nendstream", entries, content.size(), content);
}

/// Returns the operators that fill a circle about the origin.
std::string pdf_circle(double radius) {
  double const r = radius, k = 4.0 / 3 * (std::sqrt(2.0) - 1) * radius;  // handles of a quarter of a circle
  return fmt::format(
      "{0:.6f} 0 m {0:.6f} {1:.6f} {1:.6f} {0:.6f} 0 {0:.6f} c -{1:.6f} {0:.6f} -{0:.6f} {1:.6f} -{0:.6f} 0 c "
      "-{0:.6f} -{1:.6f} -{1:.6f} -{0:.6f} 0 -{0:.6f} c {1:.6f} -{0:.6f} {0:.6f} -{1:.6f} {0:.6f} 0 c f",
      r, k);
}

/// Returns the drawing of a page in mm, y upwards from its lower left corner.
std::string pdf_content(PagePlaces const& places) {
  TargetPage const& page = places.page;
  Vec2d const extent = places.pattern.extent / unit::mm;
  double const height = page.size_mm.y, points = 72 / 25.4;
  std::string text = fmt::format("{0:.9f} 0 0 {0:.9f} 0 0 cm\n0 g\n", points);
  if (places.pattern.polarity == Polarity::bright) {
    text += fmt::format("{:.5f} {:.5f} {:.5f} {:.5f} re f\n1 g\n", page.corner_mm.x,
                        height - page.corner_mm.y - extent.y, extent.x, extent.y);
  }
  for (std::size_t i = 0; i < places.pattern.centre.size(); ++i) {
    Vec2d const at = places.dot(i);
    fmt::format_to(std::back_inserter(text), "q 1 0 0 1 {:.5f} {:.5f} cm /Dot Do Q\n", at.x, height - at.y);
  }
  text += fmt::format("0 g\n{:.5f} {:.5f} {:.5f} {:g} re f\n", side_margin_mm,
                      height - places.bar_top - bar_thickness_mm, page.scale_bar_mm, bar_thickness_mm);
  return text + fmt::format("BT /Letters {:g} Tf {:.5f} {:.5f} Td ({}) Tj ET", letter_height_mm, side_margin_mm,
                            height - places.text_base, places.text());
}

}  // namespace

TargetPattern make_target_pattern(Setup const& setup, std::string const& name) {
  if (!setup.experiment().sources.on_target)
    throw DataError(ErrorCode::wrong_format, name,
                    "has particles and no target; give the setup of a BOS experiment or calibration");
  if (setup.target.kind == TargetKind::image) {
    Vec2d const extent = setup.target_extent() / unit::mm;
    throw DataError(ErrorCode::unsupported, name,
                    fmt::format("has the image {} as target, without dots; print the image itself, {:.6g} x "
                                "{:.6g} mm large",
                                setup.target.file, extent.x, extent.y));
  }
  DotPattern const dots = build_target(setup);
  Vec2d low = dots.centre.front(), high = low;
  for (Vec2d const at : dots.centre) {
    low = {std::min(low.x, at.x), std::min(low.y, at.y)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y)};
  }
  double const diameter = 2 * dots.half_size;
  return {dots.centre, diameter, 0.5 * (low + high), high - low + Vec2d{diameter, diameter}, setup.target.polarity};
}

TargetPage make_target_page(TargetPattern const& pattern) {
  Vec2d const extent = pattern.extent / unit::mm;
  double const width = std::max(least_width_mm, extent.x + 2 * side_margin_mm);
  return {{width, extent.y + side_margin_mm + bottom_margin_mm},
          {(width - extent.x) / 2, side_margin_mm},
          round_length((width - 2 * side_margin_mm) / 2)};
}

std::string target_svg(TargetPattern const& pattern) {
  require_size(pattern);
  PagePlaces const places(pattern);
  TargetPage const& page = places.page;
  Vec2d const extent = pattern.extent / unit::mm;
  bool const bright = pattern.polarity == Polarity::bright;
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"{0:.5f}mm\" height=\"{1:.5f}mm\" "
      "viewBox=\"0 0 {0:.5f} {1:.5f}\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      page.size_mm.x, page.size_mm.y);
  if (bright) {
    text += fmt::format("<rect x=\"{:.5f}\" y=\"{:.5f}\" width=\"{:.5f}\" height=\"{:.5f}\" fill=\"black\"/>\n",
                        page.corner_mm.x, page.corner_mm.y, extent.x, extent.y);
  }
  text += fmt::format("<g fill=\"{}\">\n", bright ? "white" : "black");
  for (std::size_t i = 0; i < pattern.centre.size(); ++i) {
    Vec2d const at = places.dot(i);
    fmt::format_to(std::back_inserter(text), "<circle cx=\"{:.5f}\" cy=\"{:.5f}\" r=\"{:.6f}\"/>\n", at.x, at.y,
                   pattern.diameter / unit::mm / 2);
  }
  text += fmt::format("</g>\n<rect x=\"{:g}\" y=\"{:.5f}\" width=\"{:g}\" height=\"{:g}\" fill=\"black\"/>\n",
                      side_margin_mm, places.bar_top, page.scale_bar_mm, bar_thickness_mm);
  return text + fmt::format(
                    "<text x=\"{:g}\" y=\"{:.5f}\" font-family=\"Helvetica, Arial, sans-serif\" "
                    "font-size=\"{:g}\">{}</text>\n</svg>\n",
                    side_margin_mm, places.text_base, letter_height_mm, places.text());
}

std::string target_pdf(TargetPattern const& pattern) {
  require_size(pattern);
  PagePlaces const places(pattern);
  constexpr double most_mm = 14400 / 72.0 * 25.4;  // PDF 1.4, appendix C.1: 14400 units
  Vec2d const size = places.page.size_mm;
  if (std::max(size.x, size.y) > most_mm) {
    throw DataError(ErrorCode::out_of_range, KeyPath{"target"},
                    fmt::format("needs a page of {:.6g} x {:.6g} mm (PDF has at most {:.0f} mm); write .svg", size.x,
                                size.y, most_mm));
  }
  double const radius = pattern.diameter / unit::mm / 2, points = 72 / 25.4;
  std::vector<std::string> const objects{
      "<< /Type /Catalog /Pages 2 0 R >>",
      "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
      fmt::format(
          "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.5f} {:.5f}] /Contents 4 0 R /Resources << /XObject << "
          "/Dot 5 0 R >> /Font << /Letters 6 0 R >> >> >>",
          size.x * points, size.y * points),
      pdf_stream("", pdf_content(places)),
      pdf_stream(fmt::format("/Type /XObject /Subtype /Form /BBox [-{0:.6f} -{0:.6f} {0:.6f} {0:.6f}] ", 1.01 * radius),
                 pdf_circle(radius)),
      "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"};
  std::string file = "%PDF-1.4\n", table;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    table += fmt::format("{:010} 00000 n \n", file.size());
    file += pdf_object(i + 1, objects[i]);
  }
  return file + fmt::format(
                    "xref\n0 {0}\n0000000000 65535 f \n{1}trailer\n<< /Size {0} /Root 1 0 R >>\nstartxref\n{2}\n"
                    "%%EOF\n",
                    objects.size() + 1, table, file.size());
}

std::string target_csv(TargetPattern const& pattern) {
  std::string text = "x_mm,y_mm\n";
  for (Vec2d const at : pattern.centre)
    fmt::format_to(std::back_inserter(text), "{},{}\n", at.x / unit::mm, at.y / unit::mm);
  return text;
}

}  // namespace gladstone::inline cases
