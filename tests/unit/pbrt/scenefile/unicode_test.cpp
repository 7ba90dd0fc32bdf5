#include "pbrt/scenefile/parameter_reader.h"

#include <gtest/gtest.h>

namespace pbrt {
namespace {

TEST(FindInvalidUtf8, AcceptsWellFormedText) {
    for (const char *text : {"", "plain", "m\u00e9tal", "\u4e16\u754c", "\U0001f600", "\u0080\u07ff\u0800\uffff"})
        EXPECT_FALSE(FindInvalidUtf8(text)) << text;
}

TEST(FindInvalidUtf8, FindsTheFirstBadByte) {
    EXPECT_EQ(FindInvalidUtf8("m\xe9tal"), 1u);          // Latin-1
    EXPECT_EQ(FindInvalidUtf8("abc\xff"), 3u);           // never valid
    EXPECT_EQ(FindInvalidUtf8("a\x80"), 1u);             // a continuation byte alone
    EXPECT_EQ(FindInvalidUtf8("\xc0\xaf"), 0u);          // overlong
    EXPECT_EQ(FindInvalidUtf8("\xe0\x80\xaf"), 0u);      // overlong
    EXPECT_EQ(FindInvalidUtf8("\xed\xa0\x80"), 0u);      // surrogate
    EXPECT_EQ(FindInvalidUtf8("\xf4\x90\x80\x80"), 0u);  // beyond U+10FFFF
    EXPECT_EQ(FindInvalidUtf8("ok\xe4\xb8"), 2u);        // cut off
}

TEST(ComposeUtf8, ComposesCombiningMarks) {
    EXPECT_EQ(ComposeUtf8("me\u0301tal"), "m\u00e9tal");
    EXPECT_EQ(ComposeUtf8("A\u030a\u0301"), "\u01fa");
    EXPECT_EQ(ComposeUtf8("\u0438\u0306"), "\u0439");        // Cyrillic
    EXPECT_EQ(ComposeUtf8("\u03b1\u0301"), "\u03ac");        // Greek
    EXPECT_EQ(ComposeUtf8("\u304b\u3099"), "\u304c");        // kana
    EXPECT_EQ(ComposeUtf8("\u1112\u1161\u11ab"), "\ud55c");  // Hangul
}

TEST(ComposeUtf8, OrderOfIndependentMarksDoesNotMatter) {
    EXPECT_EQ(ComposeUtf8("e\u0302\u0323"), "\u1ec7");
    EXPECT_EQ(ComposeUtf8("e\u0323\u0302"), "\u1ec7");
    EXPECT_EQ(ComposeUtf8("\u00ea\u0323"), "\u1ec7");
    EXPECT_EQ(ComposeUtf8("q\u0307\u0323"), "q\u0323\u0307");
}

TEST(ComposeUtf8, BlockedMarksStay) {
    EXPECT_EQ(ComposeUtf8("a\u0334\u0301"), "\u00e1\u0334");   // an overlay does not block an accent above
    EXPECT_EQ(ComposeUtf8("a\u0305\u0301"), "a\u0305\u0301");  // another mark above does
    EXPECT_EQ(ComposeUtf8("\u0301a"), "\u0301a");
}

TEST(ComposeUtf8, SingletonsAndExclusions) {
    EXPECT_EQ(ComposeUtf8("\u212b"), "\u00c5");        // Angstrom sign
    EXPECT_EQ(ComposeUtf8("\u2126"), "\u03a9");        // Ohm sign
    EXPECT_EQ(ComposeUtf8("\u0958"), "\u0915\u093c");  // excluded from composition
    EXPECT_EQ(ComposeUtf8("\uf900"), "\u8c48");        // CJK compatibility ideograph
}

TEST(ComposeUtf8, LeavesInvalidTextAlone) {
    for (const char *text : {"m\xe9tal", "e\u0301 \xff", "\xed\xa0\x80"}) EXPECT_EQ(ComposeUtf8(text), text);
}

TEST(ComposeUtf8, LeavesComposedTextAlone) {
    for (const char *text : {"", "plain ascii", "m\u00e9tal", "\ud55c\uae00", "\u1ec7", "\U0001f600", "\ufb01"})
        EXPECT_EQ(ComposeUtf8(text), text);
}

}  // namespace
}  // namespace pbrt
