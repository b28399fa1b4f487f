#include <fmt/format.h>

#include "studies/report/report_page.h"

namespace gladstone::inline report {
namespace {

/// Escapes text so that it contains no Markdown syntax.
std::string plain(std::string_view text) {
  std::string marked;
  for (char const c : text) {
    if (std::string_view("\\`*_|<>[]#").find(c) != std::string_view::npos) marked += '\\';
    marked += c == '\n' ? ' ' : c;
  }
  return marked;
}

std::string table_line(std::vector<std::string> const& cells) {
  std::string line = "|";
  for (std::string const& cell : cells) line += ' ' + cell + " |";
  return line + '\n';
}

struct MarkdownBlock {
  std::string operator()(Paragraph const& one) const { return plain(one.text) + "\n\n"; }

  std::string operator()(TextList const& list) const {
    std::string text;
    for (std::string const& item : list.items) text += "- " + plain(item) + '\n';
    return text + '\n';
  }

  std::string operator()(Verbatim const& one) const {
    return fmt::format("{}:\n\n```\n{}{}```\n\n", plain(one.summary), one.text, one.text.ends_with('\n') ? "" : "\n");
  }

  std::string operator()(TextTable const& table) const {
    std::vector<std::string> header, rule;
    for (std::string const& name : table.header) {
      header.push_back(plain(name));
      rule.emplace_back("---");
    }
    std::string text = plain(table.caption) + "\n\n" + table_line(header) + table_line(rule);
    for (auto const& row : table.rows) {
      std::vector<std::string> cells;
      for (TableCell const& cell : row) cells.push_back(plain(cell.text));
      text += table_line(cells);
    }
    return text + '\n';
  }

  std::string operator()(Chart const& chart) const {
    return fmt::format("{}. {}\n\n", plain(chart.title), plain(chart.alt));
  }

  std::string operator()(FramePictures const& pair) const {
    return fmt::format("{}. {}\n\n", plain(pair.title), plain(pair.alt));
  }

  std::string operator()(FigureFile const& figure) const {
    return fmt::format("![{}](<{}>)\n\n", plain(figure.alt), figure.path);
  }
};

}  // namespace

std::string markdown_page(ReportPage const& page) {
  std::string text = fmt::format("# {}\n\n{}\n\n", plain(page.title), plain(page.question));
  int number = 0;
  for (std::string const& finding : page.findings) text += fmt::format("{}. {}\n", ++number, plain(finding));
  for (ReportSection const& section : page.sections) {
    text += fmt::format("\n## {}\n\n", plain(section.title));
    for (ReportBlock const& block : section.blocks) text += std::visit(MarkdownBlock{}, block);
  }
  return text;
}

}  // namespace gladstone::inline report
