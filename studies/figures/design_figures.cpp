#include "studies/figures/design_figures.h"

#include <filesystem>

#include "studies/drawing/draw_figure.h"
#include "studies/figures/design_map.h"
#include "studies/figures/draw_or_warn.h"
#include "studies/figures/layout_figure.h"
#include "studies/figures/piv_map.h"

namespace gladstone::inline figures {

std::vector<std::string> draw_design(DesignReport const& report, std::string const& folder, std::string const& format) {
  std::vector<std::string> drawn;
  auto const draw = [&](std::string const& name, Figure const& figure) {
    std::string const path = (std::filesystem::path(folder) / (name + '.' + format)).string();
    draw_figure(figure, path);
    drawn.push_back(path);
  };
  draw_or_warn([&] {
    if (!report.best) {
      draw("layout", make_piv_layout_figure(report.setup));
      draw("design_map", make_piv_map(report.setup));
      return;
    }
    draw("layout", make_layout_figure(*report.best));
    draw("design_map", make_design_map(*report.best, report.answer ? &report.answer->question : nullptr));
    if (report.recommended_sheet && !report.answer->answer.front.empty()) {
      draw("front", make_design_front(report.answer->answer, report.answer->question.requirements.objective));
    }
  });
  return drawn;
}

}  // namespace gladstone::inline figures
