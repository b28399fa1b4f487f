#include "render/files/text_encoding.h"

#include <gtest/gtest.h>

namespace gladstone {
namespace {

// RFC 3629, section 3: one to four bytes, up to U+10FFFF.
TEST(Utf8, AcceptsRfc3629Sequences) {
  for (std::string_view const text : {"", "plain", "\xc2\x80", "D\xc3\xbcse", "\xe2\x82\xac", "\xed\x9f\xbf",
                                      "\xee\x80\x80", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"})
    EXPECT_TRUE(is_utf8(text)) << text;
}

TEST(Utf8, RejectsInvalidByteSequences) {
  for (std::string_view const text : {"D\xfcse",               // ISO-8859-1
                                      "\x80",                  // begins with a continuation byte
                                      "\xc3",                  // truncated
                                      "\xe2\x82",              // truncated
                                      "\xe2\x28\xac",          // no continuation byte
                                      "\xc0\xaf",              // overlong form
                                      "\xe0\x80\xaf",          // overlong form
                                      "\xf0\x80\x80\xaf",      // overlong form
                                      "\xed\xa0\x80",          // surrogate
                                      "\xf4\x90\x80\x80",      // above U+10FFFF
                                      "\xf8\x88\x80\x80\x80",  // five bytes
                                      "\xff"})
    EXPECT_FALSE(is_utf8(text)) << text;
}

}  // namespace
}  // namespace gladstone
