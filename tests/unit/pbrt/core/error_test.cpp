#include "pbrt/core/error.h"

#include <gtest/gtest.h>

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

TEST(Format, LeavesOutWhatItDoesNotKnow) {
    EXPECT_EQ(Format({Severity::Error, {}, "Bad."}), "Error: Bad.");
    EXPECT_EQ(Format({Severity::Error, At("text", 0, 0), "Bad."}), "Error: f.pbrt: Bad.");
    EXPECT_EQ(Format({Severity::Error, At("text", 9, 0), "Bad."}), "Error: f.pbrt:9:0: Bad.") << "no such line";
    EXPECT_EQ(Format({Severity::Error, {}, "Bad."}, true), "\033[1;31mError\033[0m: Bad.");
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
        EXPECT_STREQ(e.what(), "Error: one\nError: two");
    }
}

TEST(ListChoices, NamesANearOneFirst) {
    EXPECT_EQ(ListChoices("spere", {"disk", "sphere"}), "did you mean \"sphere\"? valid: disk, sphere");
    EXPECT_EQ(ListChoices("SPHERE", {"disk", "sphere"}), "did you mean \"sphere\"? valid: disk, sphere");
    EXPECT_EQ(ListChoices("torus", {"disk", "sphere"}), "valid: disk, sphere");
    EXPECT_EQ(ListChoices("x", {}), "it takes none");
}

TEST(CheckDeathTest, PrintsTheExpressionAndTheValues) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    int n = 3;
    EXPECT_DEATH(PBRT_CHECK_MSG(n == 4, "n = {}", n), "n == 4: n = 3");
    EXPECT_DEATH(PBRT_CHECK(n < 0), "check failed: n < 0");
}

}  // namespace
}  // namespace pbrt
