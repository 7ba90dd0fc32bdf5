// What a scene needs is estimated from below, before anything is built.
#include "pbrt/build/built_scene.h"

#include "pbrt/images/image.h"
#include "support/build_text.h"
#include "support/errors.h"
#include "support/folder_test.h"
#include "support/parse_text.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

/// A mesh of 2 n^2 triangles.
std::string GridMesh(int n) {
    std::string points, indices;
    for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x) points += fmt::format("{} {} {} ", x, y, (x * y) % 7);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const int i = y * (n + 1) + x;
            indices += fmt::format("{} {} {} {} {} {} ", i, i + 1, i + n + 1, i + 1, i + n + 2, i + n + 1);
        }
    return "Shape \"trianglemesh\" \"point3 P\" [" + points + "] \"integer indices\" [" + indices + "]\n";
}

MemoryEstimate Estimate(const std::string &world) {
    DiagnosticSink sink;
    const SceneDescription description = ParseSceneText(SceneText().World(world), sink);
    sink.ThrowIfErrors();
    return EstimateMemory(description, 1000, true);
}

TEST(MemoryEstimate, OfMeshesIsBelowWhatTheyTakeButNotFar) {
    constexpr int kSide = 300;
    const std::string grid = GridMesh(kSide);
    const MemoryEstimate estimate = Estimate(grid);
    EXPECT_EQ(estimate.triangles, 2 * kSide * kSide);
    const BuiltScene built = BuildText(SceneText().World(Objects().Light("point").Add(grid)));
    const double mesh = (kSide + 1) * (kSide + 1) * 12.0 + 2 * kSide * kSide * 12.0;
    const double actual = mesh + double(built.scene->Acceleration().Bytes());
    EXPECT_LE(estimate.meshes, actual);
    EXPECT_GT(estimate.meshes, 0.3 * actual);
}

TEST(MemoryEstimate, CountsObjectsOnceAndOnlyIfUsed) {
    const std::string object = "ObjectBegin \"o\"\n" + GridMesh(10) + "ObjectEnd\n", use = "ObjectInstance \"o\"\n";
    EXPECT_EQ(Estimate(object).triangles, 0);
    EXPECT_EQ(Estimate(object + use + use).triangles, 200);
    EXPECT_EQ(Estimate(object + use + GridMesh(10)).triangles, 400);
}

class MemoryEstimateOfFiles : public FolderTest {};

TEST_F(MemoryEstimateOfFiles, CountsImagesByTheirHeads) {
    WriteImage(Path("a.png"), Image(PixelFormat::U8, {300, 200}, {"R", "G", "B"}));
    Write("b.hdr", std::string(5000, 'x'));
    const auto texture = [&](const std::string &name, const std::string &file) {
        return fmt::format("Texture \"{}\" \"spectrum\" \"imagemap\" \"string filename\" \"{}\"\n", name, Path(file));
    };
    EXPECT_EQ(Estimate(texture("a", "a.png")).images, 300 * 200 * 3 * 4.0 / 3);
    EXPECT_EQ(Estimate(texture("a", "a.png") + texture("b", "a.png")).images, 300 * 200 * 3 * 4.0 / 3);
    EXPECT_DOUBLE_EQ(Estimate(texture("b", "b.hdr")).images, 5000 * 4.0 / 3);
    // An error is shown at the directive that needs most: here the second of three.
    const MemoryEstimate three = Estimate(texture("b", "b.hdr") + texture("a", "a.png") + texture("c", "none.png"));
    EXPECT_EQ(three.largest, 300 * 200 * 3 * 4.0 / 3);
    EXPECT_EQ(three.largestAt.line, Estimate(texture("a", "a.png")).largestAt.line + 1);
    EXPECT_EQ(Estimate(texture("c", "none.png")).images, 0);
}

TEST(MemoryEstimate, TextListsPartsAndTheSumIsComparedWithTheLimit) {
    MemoryEstimate estimate;
    estimate.film = 1e6;
    ExpectWords(estimate.Text(), {"1.0 MB:", " film 1.0 MB"});
    for (const char *part : {"mesh", "image"}) EXPECT_EQ(estimate.Text().find(part), std::string::npos);
    EXPECT_NO_THROW(RequireMemory(estimate));
    estimate.meshes = 1e15;
    estimate.triangles = 20e6;
    estimate.images = 2e9;
    estimate.imageCount = 2;
    ExpectWords(estimate.Text(), {"1.0 PB:", "meshes 1.0 PB", "20 million", "2 images 2.0 GB", "film 1.0 MB"});
    EXPECT_THROW(RequireMemory(estimate), UserError);
}

}  // namespace
}  // namespace pbrt::test
