#include "pbrt/scenefile/parameter_reader.h"

#include "support.h"

namespace pbrt::test {
namespace {

Param Only(const std::string &parameters) {
    SceneDescription scene = ParseWorld("Shape 's' " + parameters);
    EXPECT_EQ(scene.shapes.size(), 1u);
    EXPECT_EQ(scene.shapes.at(0).params.Own().size(), 1u) << parameters;
    return scene.shapes.at(0).params.Own().at(0);
}

TEST(Parameters, EveryTypeFillsItsList) {
    using T = ParamType;
    EXPECT_EQ(Only("'integer a' [ 1 +2 -3 ]").ints, (std::vector<int>{1, 2, -3}));
    for (auto [word, type] : {std::pair{"float", T::Float},
                              {"point2", T::Point2},
                              {"vector2", T::Vector2},
                              {"point3", T::Point3},
                              {"vector3", T::Vector3},
                              {"normal", T::Normal},
                              {"rgb", T::Rgb},
                              {"blackbody", T::Blackbody},
                              {"spectrum", T::Spectrum}}) {
        Param p = Only(fmt::format("'{} a' [ 1 .5 -2e1 ]", word));
        EXPECT_EQ(p.type, type) << word;
        EXPECT_EQ(p.name, "a");
        EXPECT_EQ(p.floats, (std::vector<Float>{1, .5f, -20})) << word;
        EXPECT_TRUE(p.ints.empty() && p.strings.empty() && p.bools.empty());
    }
    EXPECT_EQ(Only("'bool a' [ true false ]").bools, (std::vector<uint8_t>{1, 0}));
    EXPECT_EQ(Only("'string a' [ 'x' 'y z' ]").strings, (std::vector<std::string>{"x", "y z"}));
    EXPECT_EQ(Only("'texture a' 't'").strings, std::vector<std::string>{"t"});
    EXPECT_EQ(Only("'spectrum a' 'metal-Au-k'").strings, std::vector<std::string>{"metal-Au-k"});
}

TEST(Parameters, OneValueNeedsNoBrackets) {
    EXPECT_EQ(Only("'float a'.25").floats, std::vector<Float>{.25f});
    EXPECT_EQ(Only("'integer a'+64").ints, std::vector<int>{64});
    EXPECT_EQ(Only("'bool a' true").bools, std::vector<uint8_t>{1});
    EXPECT_TRUE(Only("'float a' []").floats.empty());
}

TEST(Parameters, DeclarationsMayHaveBlanksAndTrailingWords) {
    for (const char *declaration : {"' float a'", "'float\ta'", "'  float   a  '", "'float a b c'"}) {
        Param p = Only(std::string(declaration) + " 1");
        EXPECT_EQ(p.name, "a") << declaration;
        EXPECT_EQ(p.type, ParamType::Float);
    }
}

TEST(Parameters, RepeatedOnesAreKeptAndTheLastWinsWithAWarning) {
    const Parsed parsed = Parse("WorldBegin\nShape 's' 'float r' 1 'integer r' 3\n 'float r' 2");
    ExpectMessages(parsed.sink, {{Severity::Warning, 3, 1, "'float r' replaces the one given at test.pbrt:2:10"}}, "");
    const ParamSet &params = parsed.scene.shapes[0].params;
    EXPECT_EQ(params.Own().size(), 3u);
    EXPECT_EQ(FloatOf(params, "r", 0), 2);
}

TEST(Parameters, LocationIsThatOfTheDeclaration) {
    Param p = Only("\n   'float a' 1");
    EXPECT_EQ(p.loc.line, 3);
    EXPECT_EQ(p.loc.column, 3);
    EXPECT_EQ(p.loc.file->name, "test.pbrt");
}

TEST(Parameters, TextureNamesAreComposed) {
    EXPECT_EQ(Only("'texture a' 'me\u0301tal'").strings[0], "m\u00e9tal");
    EXPECT_EQ(Only("'string materials' [ 'me\u0301tal' ]").strings[0], "m\u00e9tal");
    // File names are kept byte by byte, without Unicode composition.
    EXPECT_EQ(Only("'string filename' 'me\u0301tal\xff'").strings[0], "me\u0301tal\xff");
}

TEST(Parameters, LongListsKeepEveryNumber) {
    std::string text = "'float a' [";
    for (int i = 0; i < 100000; ++i) text += fmt::format(" {}", i) + (i % 1000 == 0 ? " # c\n" : "");
    Param p = Only(text + "]");
    ASSERT_EQ(p.floats.size(), 100000u);
    for (int i = 0; i < 100000; ++i) ASSERT_EQ(p.floats[i], Float(i));
    EXPECT_EQ(p.floats.capacity(), p.floats.size());
}

TEST(ParameterErrors, UnknownTypeListsTheTypesAndParsingContinues) {
    for (const char *type : {"point", "color", "xyz", "Float", "vector"})
        ExpectWorldError(fmt::format("Shape 's' '{} a' [ 1 2 3 ] 'float b' 1\nShape 't'", type), 2, 10,
                         "unknown parameter type");
    Parsed parsed = Parse("WorldBegin Shape 's' 'colour a' [ 1 ] 'string b' 'x' 'xyz c' 'y'\nShape 't' 'nope d' true");
    EXPECT_EQ(parsed.sink.ErrorCount(), 3u) << Messages(parsed.sink);
    EXPECT_EQ(parsed.scene.shapes.size(), 2u);
    EXPECT_EQ(parsed.scene.shapes[0].params.Own().size(), 1u);
}

TEST(ParameterErrors, MalformedDeclaration) {
    ExpectWorldError("Shape 's' 'float' 1", 2, 10, "type name");
    ExpectWorldError("Shape 's' '' 1", 2, 10, "type name");
    ExpectWorldError("Shape 's' '  ' 1", 2, 10, "type name");
}

TEST(ParameterErrors, WrongKindPointsAtTheValue) {
    ExpectWorldError("Shape 's' 'float a' [ 'x' ]", 2, 22, "numbers");
    ExpectWorldError("Shape 's' 'integer a' true", 2, 22, "numbers");
    ExpectWorldError("Shape 's' 'string a' [ 1 2 ]", 2, 23, "quoted");
    ExpectWorldError("Shape 's' 'texture a' false", 2, 22, "quoted");
    ExpectWorldError("Shape 's' 'spectrum a' true", 2, 23, "numbers or quoted");
}

TEST(ParameterErrors, MixedKinds) {
    ExpectWorldError("Shape 's' 'float a' [ 1 'x' ]", 2, 24, "all must be");
    ExpectWorldError("Shape 's' 'float a' [ 1 2 true ]", 2, 26, "all must be");
    ExpectWorldError("Shape 's' 'string a' [ 'x' 1 ]", 2, 27, "all must be");
    ExpectWorldError("Shape 's' 'spectrum a' [ 'x' 1 ]", 2, 29, "all must be");
    ExpectWorldError("Shape 's' 'bool a' [ true 'x' ]", 2, 26, "all must be");
}

TEST(ParameterErrors, BadNumbers) {
    for (const char *word : {"nan", "inf", "1e", "2x", "-", "Translate", "1.2.3"})
        ExpectWorldError(fmt::format("Shape 's' 'float a' [ 1\n {} ]", word), 3, 1, "Expected numbers");
    ExpectWorldError("Shape 's' 'integer a' [ 1 1.0 ]", 2, 26, "Expected an integer");
    ExpectWorldError("Shape 's' 'string a' x", 2, 21, "quoted");
    ExpectWorldError("Shape 's' 'bool a' True", 2, 19, "true or false");
    ExpectWorldError("Shape 's' 'float a' [ 1 1e39 ]", 2, 24, "1e39 is too large: a number must lie between");
    ExpectWorldError("Shape 's' 'float a' -1e400", 2, 20, "-1e400 is too large");
    ExpectWorldError("Translate 0 1e400 0", 2, 12, "1e400 is too large");
}

TEST(ParameterErrors, Brackets) {
    ExpectWorldError("Shape 's' 'float a' [ [ 1 ] ]", 2, 22, "[ inside");
    ExpectWorldError("Shape 's' 'float a' ]", 2, 20, "] without [");
    ExpectWorldError("Shape 's' 'float a' 1 ]", 2, 22, "Expected a directive");
    ExpectWorldError("Shape 's' 'float a' 1 2", 2, 22, "several values need");
}

TEST(ParameterErrors, EndOfFilePointsAtTheLastToken) {
    ExpectWorldError("Shape 's' 'float a' [ 1 2", 2, 20, "Premature end of file");
    ExpectWorldError("Shape\n\n", 2, 0, "Premature end of file");
    ExpectWorldError("Translate 1 2", 2, 12, "Premature end of file");
}

TEST(FindInvalidUtf8, FindsTheFirstBadByte) {
    for (const char *text : {"", "plain", "m\u00e9tal", "\u4e16\u754c", "\U0001f600", "\u0080\u07ff\u0800\uffff"})
        EXPECT_FALSE(FindInvalidUtf8(text)) << text;
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
    EXPECT_EQ(ComposeUtf8("\u1112\u1161\u11ab"), "\ud55c");  // Hangul
    // The order of independent marks does not matter.
    for (const char *text : {"e\u0302\u0323", "e\u0323\u0302", "\u00ea\u0323"}) EXPECT_EQ(ComposeUtf8(text), "\u1ec7");
    EXPECT_EQ(ComposeUtf8("q\u0307\u0323"), "q\u0323\u0307");
    EXPECT_EQ(ComposeUtf8("a\u0334\u0301"), "\u00e1\u0334");  // an overlay does not block an accent above
    // Singletons: Angstrom and Ohm sign, CJK compatibility ideograph. The next is excluded from composition.
    EXPECT_EQ(ComposeUtf8("\u212b\u2126\uf900"), "\u00c5\u03a9\u8c48");
    EXPECT_EQ(ComposeUtf8("\u0958"), "\u0915\u093c");
}

TEST(ComposeUtf8, LeavesOtherTextAlone) {
    for (const char *text : {"m\xe9tal", "e\u0301 \xff", "\xed\xa0\x80",  // invalid
                             "", "plain ascii", "m\u00e9tal", "\ud55c\uae00", "\u1ec7", "\U0001f600", "\ufb01",
                             "a\u0305\u0301", "\u0301a"})  // another mark above blocks, and one at the beginning stays
        EXPECT_EQ(ComposeUtf8(text), text);
}

}  // namespace
}  // namespace pbrt::test
