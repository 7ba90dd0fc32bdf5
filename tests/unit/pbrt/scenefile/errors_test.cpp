#include "support.h"

#include "support/errors.h"

namespace pbrt::test {
namespace {

TEST(Blocks, WorldDirectivesBeforeWorldBegin) {
    for (const char *directive :
         {"AreaLightSource 'd' 'float x' [ 1 2 ]", "AttributeBegin", "AttributeEnd", "Import 'x'", "LightSource 'p'",
          "MakeNamedMaterial 'm' 'string type' 'd'", "Material 'd'", "NamedMaterial 'm'", "ObjectBegin 'o'",
          "ObjectEnd", "ObjectInstance 'o'", "ReverseOrientation", "Shape 's' 'bool x' true", "TransformBegin",
          "TransformEnd", "Texture 't' 'float' 'constant'"})
        ExpectError(fmt::format("\n  {}\nWorldBegin", directive), 2, 2, "not allowed before WorldBegin");
}

TEST(Blocks, OptionsDirectivesAfterWorldBegin) {
    for (const char *directive : {"Accelerator 'a'", "Camera 'c' 'float x' [ 1 ]", "Film 'f'", "Integrator 'i'",
                                  "PixelFilter 'f'", "Sampler 's'", "TransformTimes 0 1"})
        ExpectWorldError(fmt::format("  {}\nShape 's'", directive), 2, 2, "not allowed after WorldBegin");
    ExpectWorldError("  WorldBegin\nShape 's'", 2, 2, "given before");
}

TEST(Blocks, EveryOtherDirectiveIsAllowedOnBothSides) {
    const std::string anywhere =
        "ActiveTransform All Attribute 'shape' 'float x' 1 ColorSpace 'srgb' Identity\n"
        "ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ] Transform [ 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ]\n"
        "CoordinateSystem 'c' CoordSysTransform 'c' LookAt 0 0 0 0 0 1 0 1 0 MediumInterface '' ''\n"
        "Option 'seed' 1 Rotate 1 0 0 1 Scale 1 1 1 Translate 0 0 0\n";
    ParseClean(anywhere + "MakeNamedMedium 'a' 'string type' 'cloud' WorldBegin " + anywhere +
               "MakeNamedMedium 'b' 'string type' 'cloud'");
}

TEST(Blocks, AWordInTheWrongBlockIsReportedOnce) {
    ExpectError("Shape 's'\nShape 's'\nShape 's'\nWorldBegin", 1, 0, "not allowed");
}

TEST(Blocks, UnmatchedOnes) {
    ExpectWorldError("ObjectEnd", 2, 0, "without ObjectBegin");
    ExpectWorldError(" ObjectBegin 'o' Shape 's'", 2, 1, "without ObjectEnd");
    ExpectWorldError("ObjectBegin 'o' Shape 's'\nAttributeEnd ObjectEnd", 3, 0, "AttributeEnd inside the ObjectBegin");
    ExpectWorldError("ObjectBegin 'o'\n AttributeBegin Shape 's' ObjectEnd", 3, 1, "This AttributeBegin has no end");
    ExpectWorldError("AttributeBegin ObjectEnd\nAttributeEnd", 2, 15, "without ObjectBegin");
}

TEST(Blocks, TransformBlocksWarnOnce) {
    ExpectWorldWarning("TransformBegin TransformEnd\nTransformBegin AttributeEnd AttributeBegin TransformEnd", 2, 0,
                       "deprecated");
}

TEST(Blocks, TransformTimesEndNoEarlierThanTheyStart) {
    ExpectError(" TransformTimes 1 .5\nWorldBegin", 1, 1, "before it starts");
    ParseClean("TransformTimes 1 1 WorldBegin");
}

TEST(Names, RedefinitionPointsAtTheName) {
    ExpectWorldError("Texture 't' 'spectrum' 'constant'\nTexture 't' 'spectrum' 'mix'", 3, 8, "test.pbrt:2");
    ExpectWorldError("MakeNamedMaterial 'm' 'string type' 'a'\nMakeNamedMaterial 'm' 'string type' 'a'", 3, 18,
                     "defined twice");
    ExpectWorldError("MakeNamedMedium 'm' 'string type' 'a'\nMakeNamedMedium 'm' 'string type' 'a'", 3, 16,
                     "defined twice");
    ExpectWorldError("ObjectBegin 'o' ObjectEnd\nObjectBegin 'o' Shape 's' ObjectEnd", 3, 12, "defined twice");
}

TEST(Names, UndefinedMaterialIsReportedOnceAtTheFirstShape) {
    ExpectWorldError("NamedMaterial 'absent'\n Shape 's'\nShape 's'", 3, 1, "'absent', which is not defined (so do 1");
    ExpectWorldError(
        "MakeNamedMaterial 'gold' 'string type' 'a' NamedMaterial 'golf' ObjectBegin 'o'\n"
        "Shape 's' ObjectEnd",
        3, 0, "did you mean 'gold'");
    ParseWorld("NamedMaterial 'absent'");
}

TEST(Names, UndefinedMediumIsReportedWhereItIsUsed) {
    ExpectWorldError("MediumInterface 'fog'\nShape 's'\nShape 's'", 3, 0, "Medium 'fog'");
    ExpectWorldError("MediumInterface '' 'fog'\nLightSource 'point'", 3, 0, "Medium 'fog'");
    ExpectError("MediumInterface 'fog'\nCamera 'perspective' MediumInterface ''\nWorldBegin", 2, 0, "Medium 'fog'");
    ParseWorld("MediumInterface 'fog'");
}

TEST(Names, ObjectsDoNotNest) {
    ExpectWorldError("ObjectBegin 'a'\n ObjectBegin 'b' Shape 's' ObjectEnd ObjectEnd", 3, 1, "inside another");
    ExpectWorldError("ObjectBegin 'a' Shape 's'\n ObjectInstance 'a' ObjectEnd", 3, 1, "do not nest");
}

TEST(Names, MustNotBeEmptyAndMustBeUtf8) {
    ExpectWorldError("MakeNamedMaterial '' 'string type' 'a'", 2, 18, "must not be empty");
    ExpectWorldError("NamedMaterial '' Shape 's'", 2, 14, "must not be empty");
    for (const char *directive : {"NamedMaterial", "MakeNamedMaterial", "MakeNamedMedium", "CoordinateSystem",
                                  "CoordSysTransform", "ObjectBegin", "ObjectInstance", "Texture", "MediumInterface"})
        ExpectWorldError(fmt::format("\n{} 'm\xe9tal'", directive), 3, int(std::string(directive).size()) + 1, "UTF-8");
}

TEST(Names, NamedThingsNeedAType) {
    ExpectWorldError("MakeNamedMaterial 'm' 'float type' 1", 2, 0, "'string type'");
    ExpectWorldError("MakeNamedMedium 'm'", 2, 0, "'string type'");
    ExpectWorldError("MakeNamedMaterial 'm' 'string type' [ 'a' 'b' ]", 2, 22, "takes 1 value");
}

TEST(Words, UnknownOnesAreReportedAndSkipped) {
    ExpectWorldError(" shape 's' 'bool x' true", 2, 1, "did you mean 'Shape'");
    ExpectWorldError("Attribute 'camera' 'float x' 1", 2, 10, "valid: shape, light, material, medium, texture");
    ExpectWorldError("Texture 't' 'color' 'constant'", 2, 12, "valid: float, spectrum");
    ExpectWorldError("ActiveTransform Start", 2, 16, "StartTime");
    ExpectWorldWarning("CoordSysTransform 'nowhere'", 2, 18, "valid: world");
}

TEST(Words, TooManyUnknownOnesEndTheParse) {
    Parsed parsed = Parse("WorldBegin a b c d e f g h");
    EXPECT_EQ(parsed.sink.ErrorCount(), 5u) << Messages(parsed.sink);
}

TEST(Arguments, NumbersStringsAndWords) {
    ExpectWorldError("Scale 1 2 Shape", 2, 10, "Expected a number");
    ExpectWorldError("Rotate nan 0 0 1", 2, 7, "Expected a number");
    ExpectWorldError("Transform 1 0 0 0", 2, 10, "Expected [");
    ExpectWorldError("Transform [ 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 ]", 2, 42, "Expected a number");
    ExpectWorldError("Transform [ 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1 ]", 2, 44, "Expected ]");
    ExpectWorldError("Shape s", 2, 6, "in quotes");
    ExpectWorldError("ActiveTransform 'All'", 2, 16, "StartTime");
    ExpectWorldError("'Shape'", 2, 0, "Expected a directive");
    ExpectWorldError("[", 2, 0, "Expected a directive");
}

TEST(Arguments, DegenerateTransformations) {
    ExpectWorldError(" LookAt 0 0 0  0 1 0  0 1 0", 2, 1, "parallel");
    ExpectWorldError(" LookAt 1 2 3  1 2 3  0 1 0", 2, 1, "the same");
    ExpectWorldError(" Rotate 30 0 0 0", 2, 1, "length zero");
    ExpectWorldWarning(" Scale 1 0 1", 2, 1, "flattens");
    ExpectWorldWarning(" Transform [ 1 0 0 0  0 1 0 0  0 0 0 0  0 0 0 1 ]", 2, 1, "flattens");
}

TEST(Collection, AllStructuralErrorsAreReportedAtOnce) {
    Parsed parsed = Parse(
        "WorldBegin\nCamera 'perspective'\nMaterial 'diffuse' 'color reflectance' [ 1 1 1 ]\n"
        "Shape 's' 'bool a' 1\nWorldEnd\nObjectInstance 'x'\nAttributeBegin\n");
    ExpectMessages(parsed.sink,
                   {{Severity::Error, 2, 0, "Camera"},
                    {Severity::Error, 3, 19, "color"},
                    {Severity::Error, 4, 19, "true or false"},
                    {Severity::Error, 5, 0, "WorldEnd"},
                    {Severity::Error, 7, 0, "AttributeBegin"},
                    {Severity::Error, 6, 15, "'x'"}},
                   "collection");
    EXPECT_THROW(parsed.sink.ThrowIfErrors(), UserError);
}

TEST(Collection, ASyntaxErrorEndsTheParseWithoutFollowUps) {
    ExpectError("Camera 'perspective' 'float fov' [ x ]\nWorldBegin AttributeBegin", 1, 35, "Expected numbers");
    ExpectWorldError("AttributeBegin ObjectInstance 'o'\nShape 's", 3, 6, "Unterminated");
}

TEST(Transformations, ProductsBeyondFloatAreErrorsAtTheDirective) {
    ExpectWorldError("Scale 1e30 1 1\n Scale 1e30 1 1", 3, 1, "beyond the largest 32-bit float");
    ExpectWorldError("Translate 3e38 0 0 Translate 3e38 0 0", 2, 19, "beyond the largest 32-bit float");
    ExpectWorldError("ActiveTransform EndTime Scale 1e30 1 1 Scale 1e30 1 1", 2, 39, "beyond the largest");
    // A faulty directive has no effect, so the directives after it give no errors.
    EXPECT_EQ(Parse("WorldBegin Scale 1e30 1 1 Scale 1e30 1 1 Translate 1 2 3 Shape 's'").sink.ErrorCount(), 1u);
    EXPECT_EQ(ParseWorld("Scale 1e30 1e-30 1 Scale 1e-30 1e30 1 Shape 's'").shapes[0].ctm.start.Matrix()[0][0], 1);
    // The length of this axis has no finite square.
    const Transform t = ParseWorld("Rotate 90 0 0 1e30 Shape 's'").shapes[0].ctm.start;
    EXPECT_NEAR(t.Vector({1, 0, 0}).y, 1, 1e-6);
}

TEST(Collection, ManyErrorsAreCountedAndAMistakeOfMegabytesIsCut) {
    std::string text = "WorldBegin";
    for (int i = 0; i < 20'000; ++i) text += " AttributeBegin";
    for (int i = 0; i < 20'000; ++i) text += "\nShape 's' 'float a' 1e400";
    const Parsed many = Parse(text);
    EXPECT_EQ(many.sink.ErrorCount(), 40'000u);
    EXPECT_EQ(many.sink.All().size(), kMaxDiagnostics);

    const std::string monster(2'000'000, 'x');
    for (const std::string &bad :
         {"Shape '" + monster + "' 'float a' [ '" + monster + "' ]", "Shape 's' '" + monster + " a' 1", monster,
          "'" + monster + "'", "Shape 's' 'float " + monster + "' true", "Option '" + monster + "' 1",
          "Shape 's' 'float a' " + monster, "ObjectInstance '" + monster + "'",
          "NamedMaterial '" + monster + "' Shape 's'", "MediumInterface '" + monster + "' Shape 's'",
          "CoordSysTransform '" + monster + "'", "Translate " + monster, "ColorSpace '" + monster + "'",
          "Include '" + monster + "'"}) {
        const Parsed parsed = Parse("WorldBegin\n" + bad);
        ASSERT_GE(parsed.sink.All().size(), 1u) << bad.substr(0, 40);
        EXPECT_LT(Messages(parsed.sink).size(), 6000u) << bad.substr(0, 40);
    }
}

TEST(Collection, ALackOfManyNamesListsOnlySomeOfThem) {
    std::string text = "WorldBegin";
    for (int i = 0; i < 3000; ++i) text += fmt::format("\nMakeNamedMaterial 'm{0}' 'string type' 'd'", i);
    for (int i = 0; i < 3000; ++i) text += fmt::format("\nNamedMaterial 'n{0}' Shape 's' ObjectInstance 'o{0}'", i);
    const Parsed parsed = Parse(text);
    EXPECT_EQ(parsed.sink.ErrorCount(), 6000u);
    EXPECT_LT(Messages(parsed.sink).size(), 100'000u);
}

TEST(Blocks, NestingHasALimit) {
    const size_t most = size_t(1) << 17;
    std::string text;
    for (size_t i = 0; i <= most; ++i) text += "AttributeBegin\n";
    const Parsed parsed = Parse("WorldBegin\n" + text);
    ASSERT_EQ(parsed.sink.All().size(), 1u);
    EXPECT_EQ(parsed.sink.All()[0].loc.line, int(most) + 2);
    ExpectWords(parsed.sink.All()[0].message, {"131072"});
}

}  // namespace
}  // namespace pbrt::test
