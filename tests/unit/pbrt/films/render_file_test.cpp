// Checkpoints as files, and what their messages name.
#include "pbrt/films/render_file.h"

#include "support/errors.h"
#include "support/folder_test.h"

namespace pbrt::test {
namespace {

TEST(RenderIdentities, NameEverythingThatDiffers) {
    const RenderIdentity a = {{"program", "1"}, {"file a.pbrt", "x"}, {"--maxdepth", "3"}, {"--quick", ""}};
    RenderIdentity b = a;
    EXPECT_EQ(DifferencesOf(a, b, "b.chk"), "");
    b["--maxdepth"] = "5";
    ExpectWords(DifferencesOf(a, b, "b.chk"), {"--maxdepth", "3", "5", "b.chk"});
    b.erase("--maxdepth");
    b.erase("--quick");
    ExpectWords(DifferencesOf(a, b, "b.chk"), {"--maxdepth", "3", "not given in b.chk", "--quick"});
    b = a;
    b["file a.pbrt"] = "y";
    b["file b.ply"] = "z";
    ExpectWords(DifferencesOf(a, b, "b.chk"), {"a.pbrt", "only b.chk", "b.ply"});
    ExpectWords(DifferencesOf(b, a, "a.chk"), {"a.pbrt", "b.ply", "a.chk"});
    b = a;
    b["program"] = "2";
    ExpectWords(DifferencesOf(a, b, "b.chk"), {"build", "1", "b.chk", "2"});
}

class RenderFiles : public FolderTest {};

TEST_F(RenderFiles, GiveBackAllThatWasWritten) {
    const std::string path = Path("render");
    RenderFileHead head;
    head.identity = {{"program", "1"}, {"--spp", "3"}};
    head.samplesFlag = 3;
    head.samplesPerBatch = 4;
    head.first = 2;
    head.end = 9;
    head.done = 5;
    head.isPart = true;
    head.passCount = 2;
    head.seconds = 1.5;
    head.renderSeconds = 0.1;
    head.film.type = "rgb";
    head.film.overrides.pixelBounds = Bounds2i{{1, 2}, {4, 6}};
    glm::mat4 matrix(2);
    matrix[1][2] = 0.1f;
    head.metadata.attributes = {{"a", 1}, {"b", 0.1f}, {"c", std::string("text \xff")}, {"d", matrix}, {"e", Infinity}};
    const std::unique_ptr<Film> film = head.film.Make();
    StateWriter learned;
    learned(std::string("lights"));
    WriteRenderFile(path, head, {1, 2, 3}, *film, learned);

    const RenderFile file(path);
    const RenderFileHead &read = file.Head();
    EXPECT_EQ(read.identity, head.identity);
    EXPECT_EQ(read.samplesFlag, 3);
    EXPECT_EQ(read.samplesPerBatch, 4);
    EXPECT_EQ(read.first, 2);
    EXPECT_EQ(read.end, 9);
    EXPECT_EQ(read.done, 5);
    EXPECT_TRUE(read.isPart);
    EXPECT_EQ(read.passCount, 2);
    EXPECT_EQ(read.seconds, 1.5);
    EXPECT_EQ(read.renderSeconds, 0.1);
    EXPECT_EQ(std::get<int>(read.metadata.attributes.at("a")), 1);
    EXPECT_EQ(std::get<float>(read.metadata.attributes.at("b")), 0.1f);
    EXPECT_TRUE(std::get<std::string>(read.metadata.attributes.at("c")).starts_with("text "));
    EXPECT_EQ(std::get<glm::mat4>(read.metadata.attributes.at("d")), matrix);
    EXPECT_EQ(std::get<float>(read.metadata.attributes.at("e")), Infinity);
    EXPECT_EQ(file.PassDone(), (std::vector<uint32_t>{1, 2, 3}));
    EXPECT_EQ(file.Learned().Text(), "lights");
    EXPECT_EQ(read.film.Make()->PixelBounds().low, (Point2i{1, 2}));
    EXPECT_NO_THROW(file.LoadFilm(*film));
}

}  // namespace
}  // namespace pbrt::test
