#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "render/files/base64.h"
#include "studies/drawing/figure_json.h"
#include "studies/report/embedded_text.h"
#include "studies/report/report_page.h"

namespace gladstone::inline report {
namespace {

std::string escaped(std::string_view text) {
  std::string html;
  for (char const c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

/// Returns JSON that can be embedded in a script element: "<" is escaped, so that no text ends the script, and invalid
/// UTF-8 is replaced.
std::string json_in_script(nlohmann::json const& json) {
  std::string const text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string safe;
  for (char const c : text) safe += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return safe;
}

/// Returns a name in which line breaks are allowed after points and underscores.
std::string breakable(std::string_view name) {
  std::string html;
  for (char const c : name) {
    html += escaped(std::string_view(&c, 1));
    if (c == '.' || c == '_') html += "<wbr>";
  }
  return html;
}

/// Returns the HTML of a table cell.
/// @param numeric  true if other cells of its column are numbers
std::string cell_of(TableCell const& cell, bool numeric) {
  if (!cell.number) return (numeric ? "<td class=\"number\">" : "<td>") + escaped(cell.text) + "</td>";
  return fmt::format("<td class=\"number\" data-value=\"{}\">{}</td>", *cell.number, escaped(cell.text));
}

struct HtmlBlock {
  nlohmann::json& charts;  ///< figures of the charts, for report.js

  std::string operator()(Paragraph const& one) const { return "<p>" + escaped(one.text) + "</p>\n"; }

  std::string operator()(TextList const& list) const {
    std::string html = "<ul>\n";
    for (std::string const& item : list.items) html += "<li>" + escaped(item) + "</li>\n";
    return html + "</ul>\n";
  }

  std::string operator()(Verbatim const& one) const {
    return fmt::format("<details><summary>{}</summary><pre>{}</pre></details>\n", escaped(one.summary),
                       escaped(one.text));
  }

  std::string operator()(TextTable const& table) const {
    std::string html = fmt::format("<div class=\"scroll\"><table{}>\n<caption>{}</caption>\n<thead><tr>",
                                   table.filtered ? " class=\"filtered\"" : "", escaped(table.caption));
    for (std::string const& name : table.header) html += "<th scope=\"col\">" + breakable(name) + "</th>";
    html += "</tr></thead>\n<tbody>\n";
    std::vector<bool> numeric(table.header.size());
    for (auto const& row : table.rows) {
      for (std::size_t i = 0; i < row.size(); ++i) numeric[i] = numeric[i] || row[i].number;
    }
    for (auto const& row : table.rows) {
      html += "<tr>";
      for (std::size_t i = 0; i < row.size(); ++i) html += cell_of(row[i], numeric[i]);
      html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
  }

  std::string operator()(Chart const& chart) const {
    std::size_t const place = charts.size();
    nlohmann::json figures = nlohmann::json::array();
    for (auto const& [name, figure] : chart.figures)
      figures.push_back({{"name", name}, {"figure", figure_json(figure)}});
    charts.push_back({{"chart", chart.kind}, {"figures", std::move(figures)}});
    return fmt::format(
        "<figure class=\"chart\" data-chart=\"{}\" data-figures=\"{}\"><figcaption>{}</figcaption>\n<div "
        "class=\"controls\"></div>"
        "<div class=\"plot\"></div>\n<p class=\"alt\">{}</p></figure>\n",
        escaped(chart.kind), place, escaped(chart.title), escaped(chart.alt));
  }

  std::string operator()(FramePictures const& pair) const {
    auto const picture = [&](std::string const& name, std::string const& png) {
      return fmt::format("<div><img alt=\"{0}: {1}\" src=\"data:image/png;base64,{2}\"><span>{0}</span></div>",
                         escaped(name), escaped(pair.alt), base64(png));
    };
    return fmt::format(
        "<figure class=\"frames\"><figcaption>{}</figcaption>\n<div class=\"pair\">{}{}</div></figure>\n",
        escaped(pair.title), picture(pair.first_name, pair.first_png), picture(pair.second_name, pair.second_png));
  }

  std::string operator()(FigureFile const& figure) const {
    return fmt::format("<p>Figure file: <code>{}</code></p>\n", escaped(figure.path));
  }
};

}  // namespace

TableCell TableCell::of(double number) {
  if (number != number) return {"unknown"};
  return {fmt::format("{:.4g}", number), number};
}

TableCell TableCell::px(double number) {
  if (number != number) return {"unknown"};
  std::string text = fmt::format("{:.5f}", number);
  if (text == "-0.00000") text = "0.00000";
  return {std::move(text), number};
}

std::string html_page(ReportPage const& page) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      // forbid all external requests
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
      "script-src 'unsafe-inline'; img-src data:\">\n";
  html += fmt::format("<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n", escaped(page.title),
                      embedded::report_css);
  html += fmt::format("<header><h1>{}</h1>\n<p class=\"question\">{}</p>\n<ol class=\"findings\">\n",
                      escaped(page.title), escaped(page.question));
  for (std::string const& finding : page.findings) html += "<li>" + escaped(finding) + "</li>\n";
  html += "</ol></header>\n";
  nlohmann::json data;
  for (auto const& [name, json] : page.data) data[name] = nlohmann::json::parse(json);
  data["charts"] = nlohmann::json::array();
  HtmlBlock const html_block{data["charts"]};
  for (ReportSection const& section : page.sections) {
    html += fmt::format("<section>\n<h2>{}</h2>\n", escaped(section.title));
    for (ReportBlock const& block : section.blocks) html += std::visit(html_block, block);
    html += "</section>\n";
  }
  html += fmt::format(
      "<section><h2>Licence of the charting library</h2><details><summary>d3</summary><pre>{}</pre>"
      "</details></section>\n",
      escaped(embedded::d3_licence));
  html += "</main>\n<div id=\"spoken\" aria-live=\"polite\"></div>\n";
  html += "<script type=\"application/json\" id=\"data\">" + json_in_script(data) + "</script>\n";
  html += fmt::format("<script>{}</script>\n<script>{}</script>\n<script>{}</script>\n</body>\n</html>\n",
                      embedded::d3_js, embedded::figure_js, embedded::report_js);
  return html;
}

}  // namespace gladstone::inline report
