#include "studies/report/report_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "render/files/base64.h"

namespace gladstone {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// RFC 4648, section 10.
TEST(Base64, HasTheVectorsOfItsStandard) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string_view("\xff\x00", 2)), "/wA=");
}

Figure titled_figure(std::string title) {
  Figure figure;
  figure.add_title(std::move(title));
  return figure;
}

ReportPage hostile_page() {
  std::string const hostile = "</script><script>alert(\"1\")</script> & | `x`";
  ReportPage page;
  page.title = hostile;
  page.question = hostile;
  page.findings = {hostile};
  page.sections = {
      {hostile,
       {Paragraph{hostile}, TextList{{hostile}}, Verbatim{hostile, hostile},
        TextTable{hostile, {hostile}, {{{hostile}, TableCell::of(0.1234567)}}, true},
        FramePictures{hostile, hostile, "a", "b", "one", "two"},
        Chart{"figure", hostile, hostile, {{hostile, titled_figure(hostile)}}}, FigureFile{hostile, hostile}}}};
  page.data = {{"text", nlohmann::json(hostile).dump()}};
  return page;
}

TEST(ReportPage, TakesNoTextForMarks) {
  std::string const html = html_page(hostile_page());
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(html, HasSubstr("&lt;/script&gt;&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt; &amp;"));
  EXPECT_THAT(html, HasSubstr("data-value=\"0.1234567\">0.1235</td>"));
  EXPECT_THAT(markdown_page(hostile_page()), HasSubstr("\\<script\\>alert(\"1\")\\</script\\> & \\| \\`x\\`"));
}

TEST(ReportPage, HoldsAllThatItNeeds) {
  std::string const html = html_page(hostile_page());
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
  EXPECT_THAT(html, HasSubstr("d3js.org v5"));
  EXPECT_THAT(html, HasSubstr("src=\"data:image/png;base64," + base64("one")));
  EXPECT_THAT(html, HasSubstr("data-chart=\"figure\" data-figures=\"0\""));
  EXPECT_THAT(html, HasSubstr("\"charts\":[{\"chart\":\"figure\",\"figures\":[{\"figure\":{\"height\":520"));
  EXPECT_THAT(html, HasSubstr("Copyright"));
  EXPECT_THAT(html, HasSubstr("\"text\":\"\\u003c/script>\\u003cscript>"));
}

TEST(ReportPage, SaysThatANumberIsUnknown) {
  TableCell const cell = TableCell::of(std::nan(""));
  EXPECT_EQ(cell.text, "unknown");
  EXPECT_FALSE(cell.number);
  ReportPage page;
  page.sections = {{"s", {TextTable{"t", {"a_b.c", "b"}, {{{"x"}, TableCell::of(1)}, {{"y"}, cell}}}}}};
  EXPECT_THAT(html_page(page), HasSubstr("<th scope=\"col\">a_<wbr>b.<wbr>c</th>"));
  EXPECT_THAT(html_page(page), HasSubstr("<td>y</td><td class=\"number\">unknown</td>"));
}

// Displacements are printed to 1e-5 px, and a bias of zero has no sign; sorting uses the unrounded number.
TEST(ReportPage, ShowsPixelsInHundredThousandths) {
  EXPECT_EQ(TableCell::px(-4.738e-05).text, "-0.00005");
  EXPECT_EQ(TableCell::px(-3.5e-07).text, "0.00000");
  EXPECT_EQ(*TableCell::px(-3.5e-07).number, -3.5e-07);
  EXPECT_EQ(TableCell::px(0.0667).text, "0.06670");
  EXPECT_EQ(TableCell::px(std::nan("")).text, "unknown");
}

}  // namespace
}  // namespace gladstone
