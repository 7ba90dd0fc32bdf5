#include <unistd.h>
#include <zlib.h>

#include "support.h"
#include "support/errors.h"
#include "support/folder_test.h"

namespace pbrt::test {
namespace {

class SceneFiles : public FolderTest {
  protected:
    std::string Write(const std::string &name, const std::string &text) const {
        return FolderTest::Write(name, Quoted(text));
    }
    SceneDescription ParseMain(const std::string &text) {
        Write("main.pbrt", text);
        sink_ = {};
        return ParseSceneFiles({Path("main.pbrt")}, sink_);
    }
    SceneDescription ParseMainClean(const std::string &text) {
        SceneDescription scene = ParseMain(text);
        EXPECT_EQ("", Messages(sink_));
        return scene;
    }
    void ExpectMain(const std::string &text, const std::vector<Expected> &expected) {
        ParseMain(text);
        ExpectMessages(sink_, expected, text);
    }
    DiagnosticSink sink_;
};

TEST_F(SceneFiles, IncludeSplicesWithoutScope) {
    Write("part.pbrt", "Translate 1 0 0 Material 'm' CoordinateSystem 'c'");
    SceneDescription scene =
        ParseMainClean("WorldBegin Include 'part.pbrt' Shape 's' Identity CoordSysTransform 'c' Shape 's'");
    for (const ShapeEntity &s : scene.shapes) {
        EXPECT_EQ(s.ctm.start, Transform::Translate({1, 0, 0}));
        EXPECT_EQ(s.material.index, 0);
    }
}

TEST_F(SceneFiles, IncludeMayHoldHalfABlockAndTheOptions) {
    Write("begin.pbrt", "Film 'rgb' WorldBegin AttributeBegin Translate 1 0 0");
    Write("end.pbrt", "AttributeEnd");
    SceneDescription scene = ParseMainClean("Include 'begin.pbrt' Include 'end.pbrt' Shape 's'");
    EXPECT_TRUE(scene.shapes[0].ctm.start.IsIdentity());
}

TEST_F(SceneFiles, ParametersContinueBehindAnInclude) {
    Write("shape.pbrt", "Shape 'trianglemesh'\n 'integer indices' [ 0 1 2 ]\n# end\n");
    SceneDescription scene = ParseMainClean("WorldBegin\nInclude 'shape.pbrt'\n  'float alpha' .5\nShape 's'");
    ASSERT_EQ(scene.shapes.size(), 2u);
    const std::vector<Param> &own = scene.shapes[0].params.Own();
    ASSERT_EQ(own.size(), 2u);
    EXPECT_EQ(own[0].loc.file->name, Path("shape.pbrt"));
    EXPECT_EQ(own[1].name, "alpha");
    EXPECT_EQ(own[1].loc.file->name, Path("main.pbrt"));
    EXPECT_EQ(own[1].loc.line, 3);
    EXPECT_EQ(own[1].loc.column, 2);
}

TEST_F(SceneFiles, ListsContinueBehindAnInclude) {
    Write("list.pbrt", "Shape 's' 'float P' [ 1 2");
    SceneDescription scene = ParseMainClean("WorldBegin Include 'list.pbrt' 3 4 ] 'float q' 5");
    EXPECT_EQ(scene.shapes[0].params.Own()[0].floats, (std::vector<Float>{1, 2, 3, 4}));
    EXPECT_EQ(scene.shapes[0].params.Own().size(), 2u);
}

TEST_F(SceneFiles, NamesAreRelativeToTheTopLevelFileNeverToTheIncludingOne) {
    Write("parts/a.pbrt", "Include 'parts/b.pbrt'");
    Write("parts/b.pbrt", "Shape 'right'");
    SceneDescription scene = ParseMainClean("WorldBegin Include 'parts/a.pbrt'");
    EXPECT_EQ(scene.shapes.at(0).type, "right");
    EXPECT_EQ(scene.files.Resolve("parts/b.pbrt"), Path("parts/b.pbrt"));
    Write("parts/a.pbrt", "\n Include 'b.pbrt'");
    ExpectMain("WorldBegin Include 'parts/a.pbrt'", {{Severity::Error, 2, 9, "No such file"}});
    EXPECT_EQ(sink_.All()[0].loc.file->name, Path("parts/a.pbrt")) << "where the mistake is";
}

TEST_F(SceneFiles, CompressedFilesAreReadEverywhere) {
    auto compress = [&](const std::string &name, const std::string &text) {
        gzFile f = gzopen(Path(name).c_str(), "wb");
        gzputs(f, Quoted(text).c_str());
        gzclose(f);
    };
    compress("part.pbrt.gz", "Shape 'a'");
    compress("main.pbrt.gz", "WorldBegin Include 'part.pbrt.gz' Import 'part.pbrt.gz'\nBad");
    SceneDescription scene = ParseSceneFiles({Path("main.pbrt.gz")}, sink_);
    EXPECT_EQ(scene.shapes.size(), 2u);
    ExpectMessages(sink_, {{Severity::Error, 2, 0, "Bad"}}, "gz");
}

TEST_F(SceneFiles, FilesThatReadThemselvesAreErrors) {
    Write("a.pbrt", "Include 'b.pbrt'");
    Write("b.pbrt", "\nInclude './a.pbrt'");
    ExpectMain("WorldBegin Include 'a.pbrt'", {{Severity::Error, 2, 8, "reads itself"}});
    Write("b.pbrt", "\nImport 'a.pbrt'");
    ExpectMain("WorldBegin Include 'a.pbrt'", {{Severity::Error, 2, 7, "reads itself"}});
    Write("b.pbrt", "Shape 's'");
    EXPECT_EQ(ParseMainClean("WorldBegin Include 'a.pbrt' Include 'a.pbrt'").shapes.size(), 2u)
        << "twice in a row is fine";
}

TEST_F(SceneFiles, ImportGetsACopyOfTheState) {
    Write("part.pbrt",
          "Shape 'in' Translate 0 1 0 Material 'p' ReverseOrientation ColorSpace 'rec2020'\n"
          "Attribute 'shape' 'float r' 2 Shape 'in' CoordinateSystem 'theirs'\n"
          "Texture 't' 'float' 'constant' MakeNamedMaterial 'n' 'string type' 'diffuse'\n"
          "MakeNamedMedium 'm' 'string type' 'cloud' LightSource 'point'\n"
          "ObjectBegin 'o' Shape 'in' ObjectEnd ObjectInstance 'o'");
    SceneDescription scene = ParseMainClean(
        "WorldBegin Translate 1 0 0 Material 'm' Attribute 'shape' 'float r' 1\n"
        "Import 'part.pbrt' Shape 'out' NamedMaterial 'n' Shape 'out'");
    ASSERT_EQ(scene.shapes.size(), 4u);
    const ShapeEntity &changed = scene.shapes[1];
    EXPECT_EQ(changed.ctm.start, Transform::Translate({1, 1, 0}));
    EXPECT_EQ(scene.materials.at(size_t(changed.material.index)).type, "p");
    EXPECT_TRUE(changed.reverseOrientation);
    EXPECT_EQ(FloatOf(changed.params, "r", 0), 2);
    for (size_t i : {0, 2}) {  // at the beginning of the imported file, and after it in its importer
        const ShapeEntity &same = scene.shapes[i];
        EXPECT_EQ(same.ctm.start, Transform::Translate({1, 0, 0})) << i;
        EXPECT_EQ(same.material.index, 0) << i;
        EXPECT_FALSE(same.reverseOrientation) << i;
        EXPECT_EQ(same.colorSpace, "srgb") << i;
        EXPECT_EQ(FloatOf(same.params, "r", 0), 1) << i;
    }
    EXPECT_EQ(scene.textures.size() + scene.media.size() + scene.lights.size() + scene.instances.size(), 4u);
}

TEST_F(SceneFiles, ImportDoesNotShareCoordinateSystems) {
    Write("part.pbrt", "\nCoordSysTransform 'mine' CoordinateSystem 'theirs'");
    ExpectMain("WorldBegin CoordinateSystem 'mine' Import 'part.pbrt'\nCoordSysTransform 'theirs'",
               {{Severity::Warning, 2, 18, "mine"}, {Severity::Warning, 2, 18, "theirs"}});
}

TEST_F(SceneFiles, ImportInsideAnObjectAddsToIt) {
    Write("part.pbrt", "AttributeBegin Shape 'a' AttributeEnd Shape 'b'");
    SceneDescription scene =
        ParseMainClean("WorldBegin ObjectBegin 'o' Import 'part.pbrt' ObjectEnd ObjectInstance 'o'");
    EXPECT_TRUE(scene.shapes.empty());
    EXPECT_EQ(scene.objects.at(0).shapes.size(), 2u);
    Write("part.pbrt", "Shape 'a'\nObjectInstance 'o'\nObjectBegin 'p' ObjectEnd");
    ExpectMain("WorldBegin ObjectBegin 'o' Import 'part.pbrt' ObjectEnd",
               {{Severity::Error, 2, 0, "do not nest"}, {Severity::Error, 3, 0, "inside another"}});
    Write("part.pbrt", "\nObjectEnd");
    ExpectMain("WorldBegin ObjectBegin 'o' Import 'part.pbrt' ObjectEnd",
               {{Severity::Error, 2, 0, "without ObjectBegin"}});
}

TEST_F(SceneFiles, ImportMustBeBalanced) {
    Write("part.pbrt", "\nAttributeBegin");
    ExpectMain("WorldBegin Import 'part.pbrt'", {{Severity::Error, 2, 0, "without AttributeEnd"}});
    Write("part.pbrt", "\nAttributeEnd");
    ExpectMain("WorldBegin AttributeBegin Import 'part.pbrt' AttributeEnd", {{Severity::Warning, 2, 0, "ignored"}});
    Write("part.pbrt", "Shape 's'");
    ExpectMain("WorldBegin\nImport 'part.pbrt' 'float x' 1", {{Severity::Error, 2, 19, "Expected a directive"}});
}

TEST_F(SceneFiles, ImportedNamesAreGlobal) {
    Write("part.pbrt", "\nTexture 't' 'float' 'constant'\nMakeNamedMaterial 'n' 'string type' 'diffuse'");
    ExpectMain(
        "WorldBegin Texture 't' 'float' 'constant' Import 'part.pbrt'\nMakeNamedMaterial 'n' 'string type' 'mix'",
        {{Severity::Error, 2, 8, "defined twice"}, {Severity::Error, 2, 18, "defined twice"}});
    // Media and objects of the same name are not errors across imports; here the later one is used.
    Write("part.pbrt", "\nMakeNamedMedium 'm' 'string type' 'cloud'\nObjectBegin 'o' Shape 'b' Shape 'c' ObjectEnd");
    SceneDescription scene = ParseMain(
        "WorldBegin MakeNamedMedium 'm' 'string type' 'homogeneous'\n"
        "ObjectBegin 'o' Shape 'a' ObjectEnd Import 'part.pbrt'");
    ExpectMessages(sink_, {{Severity::Warning, 2, 16, "again"}, {Severity::Warning, 3, 12, "again"}}, "import");
    ASSERT_EQ(scene.media.size(), 1u);
    EXPECT_EQ(scene.media[0].type, "cloud");
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].shapes.size(), 2u);
}

TEST_F(SceneFiles, ASyntaxErrorEndsOnlyTheImportedFile) {
    Write("part.pbrt", "AttributeBegin Translate 1 2\nx");
    SceneDescription scene = ParseMain("WorldBegin Import 'part.pbrt' Shape 's'\nWorldEnd");
    ExpectMessages(sink_, {{Severity::Error, 2, 0, "Expected a number"}, {Severity::Error, 2, 0, "WorldEnd"}},
                   "import");
    EXPECT_EQ(scene.shapes.size(), 1u);
}

TEST_F(SceneFiles, SeveralFilesAreOneScene) {
    std::string a = Write("a/one.pbrt", "Film 'rgb' Include 'part.pbrt'");
    Write("a/part.pbrt", "WorldBegin Translate 1 0 0");
    std::string b = Write("b/two.pbrt", "Include 'part.pbrt'");
    Write("b/part.pbrt", "Shape 's'");
    SceneDescription scene = ParseSceneFiles({a, b}, sink_);
    EXPECT_EQ("", Messages(sink_));
    EXPECT_EQ(scene.shapes.at(0).ctm.start, Transform::Translate({1, 0, 0}));
    EXPECT_EQ(scene.files.Resolve("part.pbrt"), Path("b/part.pbrt"));
}

TEST_F(SceneFiles, AMissingTopLevelFileIsOneError) {
    ParseSceneFiles({Path("none.pbrt")}, sink_);
    ExpectMessages(sink_, {{Severity::Error, 0, 0, "none.pbrt: No such file"}}, "none");
    sink_ = {};
    ParseSceneFiles({folder_.string()}, sink_);
    EXPECT_EQ(sink_.ErrorCount(), 1u);
}

TEST_F(SceneFiles, DashIsStandardInput) {
    std::string path = Write("in.pbrt", "WorldBegin\nShape 's' Bad");
    int saved = dup(STDIN_FILENO);
    ASSERT_NE(freopen(path.c_str(), "r", stdin), nullptr);
    lseek(STDIN_FILENO, 0, SEEK_SET);
    SceneDescription scene = ParseSceneFiles({"-"}, sink_);
    dup2(saved, STDIN_FILENO);
    close(saved);
    EXPECT_EQ(scene.shapes.size(), 1u);
    ASSERT_EQ(sink_.ErrorCount(), 1u);
    EXPECT_EQ(Format(sink_.All()[0]).find("Error: <stdin>:2:10: "), 0u);
    EXPECT_EQ(scene.files.Resolve("x.png"), "x.png");
}

TEST_F(SceneFiles, EveryLocationOfAFileSharesOneSource) {
    SceneDescription scene = ParseMainClean("WorldBegin Shape 'a' 'float x' 1 Shape 'b'");
    EXPECT_EQ(scene.shapes[0].loc.file, scene.shapes[1].loc.file);
    EXPECT_EQ(scene.shapes[0].loc.file, scene.shapes[0].params.Own()[0].loc.file);
}

TEST_F(SceneFiles, NestingHasALimit) {
    for (const char *directive : {"Include", "Import"}) {
        for (int i = 0; i < 300; ++i)
            Write(fmt::format("{}.pbrt", i), fmt::format("\n  {} '{}.pbrt'\n", directive, i + 1));
        Write("300.pbrt", "Shape 's'\n");
        ParseMain(fmt::format("WorldBegin\n{} '0.pbrt'\n", directive));
        ASSERT_EQ(sink_.All().size(), 1u) << Messages(sink_);
        const Diagnostic &d = sink_.All()[0];
        ExpectWords(d.message, {"nested", "256"});
        // The 256th open file, counting main.pbrt.
        EXPECT_TRUE(d.loc.file->name.ends_with("/254.pbrt")) << d.loc.file->name;
        EXPECT_EQ(d.loc.line, 2);
        Write("200.pbrt", "Shape 's'\n");
        EXPECT_EQ(ParseMainClean(fmt::format("WorldBegin\n{} '0.pbrt'\n", directive)).shapes.size(), 1u);
    }
}

TEST_F(SceneFiles, FilesThatMultiplyAreStopped) {
    // Every level includes the next one twice: 2^30 files in all.
    for (const char *directive : {"Include", "Import"}) {
        for (int i = 0; i < 30; ++i)
            Write(fmt::format("{}.pbrt", i), fmt::format("{0} '{1}.pbrt' {0} '{1}.pbrt'", directive, i + 1));
        Write("30.pbrt", "");
        ParseMain(fmt::format("WorldBegin {} '0.pbrt'", directive));
        ASSERT_GE(sink_.All().size(), 1u);
        ExpectWords(sink_.All()[0].message, {"More than 20000 files"});
        EXPECT_LE(sink_.ErrorCount(), 31u);
    }
}

}  // namespace
}  // namespace pbrt::test
