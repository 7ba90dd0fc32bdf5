#include "pbrt/core/error.h"

#include <gtest/gtest.h>

#include "support/errors.h"

namespace pbrt {
namespace {

FileLoc At(const std::string &text, int line, int column) {
    return {std::make_shared<SourceFile>(SourceFile{"f.pbrt", text}), line, column};
}

TEST(Format, QuotesTheLineAndPutsTheCaretUnderTheColumn) {
    EXPECT_EQ(Format({Severity::Error, At("one\ntwo three\nfour", 2, 4), "Bad."}),
              "Error: f.pbrt:2:4: Bad.\n    two three\n        ^");
    EXPECT_EQ(Format({Severity::Warning, At("\tx\r\n", 1, 1), "Hm."}), "Warning: f.pbrt:1:1: Hm.\n     x\n     ^");
}

TEST(Format, LeavesOutPartsWithoutAPlace) {
    EXPECT_EQ(Format({Severity::Error, {}, "Bad."}), "Error: Bad.");
    EXPECT_EQ(Format({Severity::Error, At("text", 0, 0), "Bad."}), "Error: f.pbrt: Bad.");
    EXPECT_EQ(Format({Severity::Error, At("text", 9, 0), "Bad."}), "Error: f.pbrt:9:0: Bad.")
        << "a line that the file does not have is not quoted";
    EXPECT_EQ(Format({Severity::Error, {}, "Bad."}, true), "\033[1;31mError\033[0m: Bad.");
}

TEST(CountText, HasThePluralOfItsNoun) {
    EXPECT_EQ(CountText(1, "sample") + ", " + CountText(2, "sample"), "1 sample, 2 samples");
    EXPECT_EQ(CountText(1, "leaf", "leaves") + ", " + CountText(0, "leaf", "leaves"), "1 leaf, 0 leaves");
}

TEST(Format, LongLinesAreCutAroundTheCaret) {
    std::string text = std::string(5000, 'a') + "X" + std::string(5000, 'b');
    std::string message = Format({Severity::Error, At(text, 1, 5000), "Bad."});
    EXPECT_LT(message.size(), 400u);
    size_t lineBegin = message.find('\n') + 1, caretBegin = message.find('\n', lineBegin) + 1;
    EXPECT_EQ(message[lineBegin + (message.find('^') - caretBegin)], 'X') << message;
}

TEST(DiagnosticSink, CollectsAndThrowsErrorsOnly) {
    DiagnosticSink sink;
    sink.Warning({}, "careful");
    EXPECT_NO_THROW(sink.ThrowIfErrors());
    EXPECT_FALSE(sink.HasErrors());
    sink.Error({}, "one");
    sink.Add(UserError("two"));
    EXPECT_EQ(sink.ErrorCount(), 2u);
    EXPECT_EQ(sink.All().size(), 3u);
    try {
        sink.ThrowIfErrors();
        FAIL();
    } catch (const UserError &e) {
        EXPECT_EQ(e.Diagnostics().size(), 2u);
        EXPECT_STREQ(e.what(), "Error: one\n(1 more error)");
        EXPECT_EQ(FormatAll(e), "Error: one\nError: two\n");
    }
}

TEST(DiagnosticSink, KeepsTheFirstErrorsAndCountsTheRest) {
    DiagnosticSink sink, other;
    for (int i = 0; i < 39'990; ++i) sink.Error({}, fmt::format("mistake {}", i));
    EXPECT_TRUE(sink.IsFull());
    for (int i = 0; i < 10; ++i) other.Error({}, "late");
    sink.Add(other);
    EXPECT_EQ(sink.All().size(), kMaxDiagnostics);
    EXPECT_EQ(sink.ErrorCount(), 40'000u);
    EXPECT_EQ(sink.Omitted(), 39'900u);
    try {
        sink.ThrowIfErrors();
        FAIL();
    } catch (const UserError &e) {
        EXPECT_EQ(e.Diagnostics().size(), kMaxDiagnostics);
        EXPECT_EQ(e.Count(), 40'000u);
        const std::string all = FormatAll(e);
        EXPECT_TRUE(all.ends_with("Error: mistake 99\n... and 39900 more errors not shown.\n")) << all;
        EXPECT_LT(std::string(e.what()).size(), 100u);
        // Errors that were only counted stay counted when they are passed to another sink.
        DiagnosticSink outer;
        outer.Warning({}, "careful");
        outer.Add(e);
        EXPECT_EQ(outer.ErrorCount(), 40'000u);
        EXPECT_EQ(outer.All().size(), kMaxDiagnostics + 1);
    }
}

TEST(DiagnosticSink, ErrorsAreKeptHoweverManyWarningsThereWere) {
    DiagnosticSink sink;
    for (int i = 0; i < 1000; ++i) sink.Warning({}, "careful");
    EXPECT_EQ(sink.All().size(), kMaxDiagnostics + 1);
    test::ExpectWords(sink.All().back().message, {"more warnings"});
    sink.Error({}, "bad");
    EXPECT_EQ(sink.All().back().message, "bad");
}

TEST(FormatAll, QuotesEveryFileItNames) {
    std::string text;
    for (int i = 1; i <= 1000; ++i) text += fmt::format("line {}\r\n", i);
    const FileLoc first = At(text, 1000, 2), second = At("other", 1, 0);
    FileLoc again = first;
    again.line = 7;
    const UserError e({{Severity::Error, first, "a"}, {Severity::Error, second, "b"}, {Severity::Error, again, "c"}});
    EXPECT_EQ(FormatAll(e),
              "Error: f.pbrt:1000:2: a\n    line 1000\n      ^\nError: f.pbrt:1:0: b\n    other\n    ^\n"
              "Error: f.pbrt:7:2: c\n    line 7\n      ^\n");
}

TEST(UserError, WhatNeedsNotTheFile) {
    // A scene with many mistakes throws many such errors, so making one must not search the whole file.
    const UserError e("Bad.", At(std::string(1000, '\n') + "quoted", 1001, 3));
    EXPECT_STREQ(e.what(), "Error: f.pbrt:1001:3: Bad.");
    EXPECT_EQ(FormatAll(e), "Error: f.pbrt:1001:3: Bad.\n    quoted\n       ^\n");
}

TEST(UserError, AMonstrousMessageIsCut) {
    const UserError e("begin " + std::string(10'000'000, 'x') + " end");
    const std::string &message = e.Diagnostics().front().message;
    EXPECT_LT(message.size(), 5000u);
    EXPECT_TRUE(message.starts_with("begin ") && message.ends_with(" end"));
}

TEST(Abbreviate, CutsLongTextBetweenCharacters) {
    EXPECT_EQ(Abbreviate("short"), "short");
    EXPECT_EQ(Abbreviate(std::string(100, 'a')), std::string(60, 'a') + "...");
    EXPECT_EQ(Abbreviate("abc\xc3\xa9", 4), "abc...");  // the two bytes of an accented e are not separated
    EXPECT_EQ(Abbreviate("two\nlines"), "two lines");
}

TEST(ListChoices, NamesANearOneFirst) {
    EXPECT_EQ(ListChoices("SPERE", {"disk", "sphere"}), "did you mean \"sphere\"? valid: disk, sphere");
    EXPECT_EQ(ListChoices("torus", {"disk", "sphere"}), "valid: disk, sphere");
    EXPECT_EQ(ListChoices("x", {}), "it takes none");
    std::vector<std::string> many;
    for (int i = 0; i < 5000; ++i) many.push_back(fmt::format("name{:04}", i));
    const std::string list = ListChoices("name49999", many);
    EXPECT_TRUE(list.starts_with("did you mean \"name4999\"? valid: name0000, ")) << list;
    EXPECT_TRUE(list.ends_with("name0099 and 4900 more")) << list;
    // The edit distance to such a long name would take years to compute.
    EXPECT_LT(ListChoices(std::string(10'000'000, 'x'), {std::string(10'000'000, 'y'), "a"}).size(), 200u);
}

TEST(CheckDeathTest, PrintsTheExpressionAndTheValues) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    int n = 3;
    EXPECT_DEATH(PBRT_CHECK_MSG(n == 4, "n = {}", n), "n == 4: n = 3");
    EXPECT_DEATH(PBRT_CHECK(n < 0), "check failed: n < 0");
}

}  // namespace
}  // namespace pbrt
