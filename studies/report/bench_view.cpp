#include "studies/report/bench_view.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>

#include "render/base/text_file.h"
#include "studies/design/sheet.h"
#include "studies/figures/design_map.h"
#include "studies/figures/gnuplot.h"
#include "studies/figures/layout_figure.h"
#include "studies/passing_folder.h"

namespace gladstone {
namespace {

constexpr double mm = unit::millimetre;

std::string text_of_layout(Bench<double> const& b) {
  return fmt::format(
      "Seen from the side, to scale: the dots stand Z_D = {:.5g} mm behind the medium's mid-plane, the lens (f = "
      "{:.5g} "
      "mm, f/{:.4g}) Z_A = {:.5g} mm before it. The camera sees {:.4g} x {:.4g} mm in the medium and {:.4g} x {:.4g} "
      "mm "
      "of the dots; the cone of light of a dot is {:.3g} mm wide in the medium.",
      b.z_d / mm, b.focal_length / mm, b.f_number, b.z_a / mm, b.given->camera.columns * b.pixel_at_medium() / mm,
      b.given->camera.rows * b.pixel_at_medium() / mm, b.given->camera.columns * b.pixel_at_dots() / mm,
      b.given->camera.rows * b.pixel_at_dots() / mm, b.cone_diameter() / mm);
}

/// A figure that the page holds; without gnuplot its words.
template <class Write>
ReportBlock drawn_block(std::string title, std::string words, Write const& write) {
  try {
    PassingFolder const folder;
    std::string const path = folder.path() + "/figure.png";
    write(path);
    return Picture{std::move(title), std::move(words), read_text_file(path)};
  } catch (GnuplotMissing const& missing) {
    spdlog::warn("{}", missing.what());
    return Paragraph{title + ". " + words};
  }
}

std::string map_text(Bench<double> const& b) {
  return fmt::format(
      "Resolution against sensitivity over Z_D, a curve for every f-number. The set-up is the point at {:.4g} px per "
      "kg/m^4 and {:.4g} mm.",
      b.sensitivity(), resolved_wavelength(b) / mm);
}

}  // namespace

std::optional<BenchView> bench_view(CaseSetup loaded) {
  Setup const& setup = loaded.setup;
  if (setup.piv || setup.calibration() || setup.pose || setup.camera.tilted() || setup.lenslets ||
      !setup.windows.empty() || !std::isfinite(setup.lens.f_number) || loaded.correlate.window_px.empty()) {
    return std::nullopt;
  }
  loaded.setup.medium.field.kind = FieldKind::none;
  auto given = std::make_unique<BenchGiven>(bench_given(loaded));
  Bench<double> const bench = bench_of(loaded.setup, *given);
  return BenchView{std::move(given), bench};
}

std::string layout_text(BenchView const& view) { return text_of_layout(view.bench); }

ReportBlock layout_block(BenchView const& view, std::string const& whose) {
  return drawn_block("Layout of " + whose, layout_text(view),
                     [&view](std::string const& path) { write_layout_figure(path, view.bench); });
}

ReportSection bench_section(BenchView const& view, std::string const& whose) {
  ReportBlock map = drawn_block("Design map of " + whose, map_text(view.bench),
                                [&view](std::string const& path) { write_design_map(path, view.bench, std::nullopt); });
  return {"Set-up", {layout_block(view, whose), std::move(map)}};
}

std::vector<std::string> draw_bench(std::string const& folder, std::string const& format, BenchView const& view) {
  std::vector<std::string> const drawn{folder + "/layout." + format, folder + "/design_map." + format};
  write_layout_figure(drawn.front(), view.bench);
  write_design_map(drawn.back(), view.bench, std::nullopt);
  return drawn;
}

}  // namespace gladstone
