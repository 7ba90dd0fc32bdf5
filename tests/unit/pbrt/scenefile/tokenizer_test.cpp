#include "pbrt/scenefile/tokenizer.h"

#include <gtest/gtest.h>

namespace pbrt {
namespace {

std::shared_ptr<const SourceFile> Source(const std::string &name, const std::string &text) {
    return std::make_shared<SourceFile>(SourceFile{name, text});
}

/// All tokens as "kind:text@line:column", kinds W, S, [ and ].
std::string Dump(Tokenizer &tokens) {
    std::string out;
    for (Token t = tokens.Next(); t.kind != TokenKind::End; t = tokens.Next()) {
        const char *kind = t.kind == TokenKind::Word ? "W" : t.kind == TokenKind::String ? "S" : "";
        out += fmt::format("{}{}{}@{}:{}", out.empty() ? "" : " ", kind, t.text, t.line, t.column);
    }
    return out;
}

std::string Dump(const std::string &text) {
    Tokenizer tokens;
    tokens.Push(Source("a", text), "a");
    return Dump(tokens);
}

void ExpectFails(const std::string &text, int line, int column) {
    try {
        Dump(text);
        ADD_FAILURE() << text;
    } catch (const UserError &e) {
        EXPECT_EQ(e.Diagnostics().at(0).loc.line, line) << e.what();
        EXPECT_EQ(e.Diagnostics().at(0).loc.column, column) << e.what();
    }
}

TEST(Tokenizer, NeedsNoBlanksAroundQuotesAndBrackets) {
    EXPECT_EQ(Dump("Camera\"a\"\"b c\"27[-1]x"), "WCamera@1:0 Sa@1:6 Sb c@1:9 W27@1:14 [@1:16 W-1@1:17 ]@1:19 Wx@1:20");
}

TEST(Tokenizer, CountsLinesFromOneAndColumnsFromZero) {
    EXPECT_EQ(Dump("a\n\n\tb\r\n  c"), "Wa@1:0 Wb@3:1 Wc@4:2");
    EXPECT_EQ(Dump(""), "");
    EXPECT_EQ(Dump(" \n\t\r\n"), "");
}

TEST(Tokenizer, CommentsStartOnlyWhereATokenWould) {
    EXPECT_EQ(Dump("# all\na # b\nfoo#bar \"x # y\"#c"), "Wa@2:0 Wfoo#bar@3:0 Sx # y@3:8");
    EXPECT_EQ(Dump("# to CR\rx"), "Wx@1:8");
    EXPECT_EQ(Dump("[#]\n]"), "[@1:0 ]@2:0");
    EXPECT_EQ(Dump("a #"), "Wa@1:0");
}

TEST(Tokenizer, ReplacesEscapes) {
    EXPECT_EQ(Dump(R"("a\"b" "\\" "\'" "\t")"), "Sa\"b@1:0 S\\@1:7 S'@1:12 S\t@1:17");
    EXPECT_EQ(Dump(R"("\n\r\b\f")"), "S\n\r\b\f@1:0");
    ExpectFails("x\n \"ab\\q\"", 2, 4);
}

TEST(Tokenizer, StringsEndOnTheirLine) {
    ExpectFails("x \"abc\n\"", 1, 2);
    ExpectFails("x\n  \"abc", 2, 2);
    ExpectFails("\"abc\\\n\"", 1, 0);
    ExpectFails("\"abc\\", 1, 0);
}

TEST(Tokenizer, Utf16IsAnErrorAndUtf8MarkIsSkipped) {
    ExpectFails("\xff\xfeL", 1, 0);
    ExpectFails("\xfe\xff", 1, 0);
    EXPECT_EQ(Dump("\xef\xbb\xbfx"), "Wx@1:3");
}

TEST(Tokenizer, InnerFilesAreSplicedIn) {
    Tokenizer tokens;
    tokens.Push(Source("outer", "a b c"), "outer");
    EXPECT_EQ(tokens.Next().text, "a");
    tokens.Push(Source("inner", "x\n y"), "inner");
    EXPECT_TRUE(tokens.IsOpen("inner") && tokens.IsOpen("outer"));
    EXPECT_EQ(tokens.Next().text, "x");
    Token y = tokens.Next();
    EXPECT_EQ(tokens.Peek().text, "b");
    EXPECT_EQ(tokens.Loc(y).file->name, "inner");
    EXPECT_EQ(tokens.Loc(y).line, 2);
    EXPECT_FALSE(tokens.IsOpen("inner"));
    Token b = tokens.Next();
    EXPECT_EQ(tokens.Loc(b).file->name, "outer");
    EXPECT_EQ(Dump(tokens), "Wc@1:4");
    Tokenizer imported(&tokens);
    EXPECT_FALSE(imported.IsOpen("inner"));
}

TEST(Tokenizer, BulkReadingStopsAtWhatIsNoNumber) {
    Tokenizer tokens;
    tokens.Push(Source("a", "1 2.5 # c\n -3e1] 4 5x 6 1e99"), "a");
    std::vector<Float> floats;
    tokens.ReadFloats(floats);
    EXPECT_EQ(floats, (std::vector<Float>{1, 2.5f, -30}));
    EXPECT_EQ(tokens.Next().kind, TokenKind::Close);
    tokens.ReadFloats(floats);
    EXPECT_EQ(floats.size(), 4u);
    Token junk = tokens.Next();
    EXPECT_EQ(junk.text, "5x");
    EXPECT_EQ(junk.line, 2);
    std::vector<int> ints;
    tokens.ReadInts(ints);
    EXPECT_EQ(ints, std::vector<int>{6});
    EXPECT_EQ(tokens.Peek().text, "1e99");
    tokens.ReadFloats(floats);
    EXPECT_EQ(floats.size(), 4u);
}

}  // namespace
}  // namespace pbrt
