#include <glm/vec4.hpp>
#include <sstream>

#include "program.h"

namespace pbrt::test {

class Images : public SmallSceneProgram {};

TEST_F(Images, SeedChoosesTheNoise) {
    const ImageFile first = Render("--seed 1 scene.pbrt");
    EXPECT_TRUE(SamePixels(first, Render("--seed 1 scene.pbrt")));
    EXPECT_FALSE(SamePixels(first, Render("--seed 2 scene.pbrt")));
    EXPECT_EQ(IntOf(first, "pbrt.seed"), 1);
    EXPECT_TRUE(SamePixels(Render("--seed 0 scene.pbrt"), Render("scene.pbrt")));
}

TEST_F(Images, HeaderStoresTheSettingsOfTheRender) {
    const ImageFile file = Render("--spp 3 scene.pbrt");
    EXPECT_EQ(IntOf(file, "samplesPerPixel"), 3);
    EXPECT_GT(NumberOf(file, "renderTimeSeconds"), 0);
    EXPECT_LT(NumberOf(file, "renderTimeSeconds"), 60);
    EXPECT_EQ(TextOf(file, "lightSampler"), "bvh");
    EXPECT_EQ(TextOf(file, "pbrt.integrator"), "path");
    EXPECT_EQ(IntOf(file, "pbrt.maxDepth"), 3);
    EXPECT_TRUE(Has(TextOf(file, "pbrt.commandLine"), "--outfile out.exr --spp 3 scene.pbrt"));
    EXPECT_FALSE(file.metadata.attributes.contains("pbrt.interrupted"));
}

TEST_F(Images, HeaderMatricesMapTheWorldIntoThePicture) {
    const ImageFile file = Render("--spp 1 scene.pbrt");
    auto map = [&](const char *name, glm::vec4 p) {
        const glm::vec4 q = std::get<glm::mat4>(file.metadata.attributes.at(name)) * p;
        return Point3(q.x / q.w, q.y / q.w, q.z / q.w);
    };
    // LookAt 0 1 -5  0 0 0  0 1 0
    EXPECT_LT(Distance(map("worldToCamera", {0, 1, -5, 1}), Point3(0)), 1e-5f);
    EXPECT_LT(Distance(map("worldToCamera", {0, 0, 0, 1}), Point3(0, 0, std::sqrt(Float(26)))), 1e-5f);
    const Point3 middle = map("worldToNDC", {0, 0, 0, 1});
    EXPECT_NEAR(middle.x, 0.5f, 1e-5f);
    EXPECT_NEAR(middle.y, 0.5f, 1e-5f);
}

// A ball around (1, 2, 3), seen through a turned and mirrored camera.
TEST_F(Images, GBufferIsInTheRequestedSpace) {
    auto render = [&](const std::string &space) {
        Write("ball.pbrt",
              SceneText()
                  .Head("Scale -1 1 1")
                  .LookAt("3 4 -2  1 2 3  0 1 0")
                  .Camera(25)
                  .Film(16, 12, "'bool savefp16' false 'string coordinatesystem' '" + space + "'", "gbuffer")
                  .World(Objects().Light("infinite").Add("Translate 1 2 3").Shape("sphere")));
        return Render("--spp 1 --disable-pixel-jitter ball.pbrt");
    };
    const ImageFile world = render("world"), camera = render("camera");
    const auto cameraFromWorld = std::get<glm::mat4>(world.metadata.attributes.at("worldToCamera"));
    auto read = [](const Image &image, Point2i pixel, const char *name) {
        const int first = image.FindChannel(std::string(name) + ".X");
        return Vector3(image.Get(pixel, first), image.Get(pixel, first + 1), image.Get(pixel, first + 2));
    };
    int seen = 0;
    for (int i = 0; i < 16 * 12; ++i) {
        const Point2i pixel(i % 16, i / 16);
        const Point3 p = read(world.image, pixel, "P");
        const Normal3 n = read(world.image, pixel, "N");
        if (LengthSquared(n) == 0) continue;
        ++seen;
        EXPECT_NEAR(Distance(p, Point3(1, 2, 3) + n), 0, 1e-4f);
        EXPECT_LT(Distance(Vector3(cameraFromWorld * glm::vec4(p, 1)), read(camera.image, pixel, "P")), 1e-4f);
        EXPECT_LT(Distance(Vector3(cameraFromWorld * glm::vec4(n, 0)), read(camera.image, pixel, "N")), 1e-4f);
    }
    EXPECT_GT(seen, 30);
    EXPECT_LT(seen, 150);
}

// A square at z = 5 that faces the camera.
const char *const kSquare =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "-1 -1 5 0 0 -1 0 0\n1 -1 5 0 0 -1 1 0\n1 1 5 0 0 -1 1 1\n-1 1 5 0 0 -1 0 1\n4 0 1 2 3\n";

// A checkerboard of heights 0 and 2; the height at every corner is 0.
TEST_F(Images, DisplacedMeshesAreSplitToTheEdgeLength) {
    Write("square.ply", kSquare);
    Write(
        "relief.pbrt",
        SceneText()
            .Camera(15)
            .Film(32, 32, "'string coordinatesystem' 'world' 'bool savefp16' false", "gbuffer")
            .Samples(1)
            .World(
                Objects()
                    .Light("point")
                    .Add("Texture 'fields' 'float' 'checkerboard' 'float uscale' 4 'float vscale' 2 'float tex1' 0 "
                         "'float tex2' 2")
                    .Shape("plymesh",
                           "'string filename' 'square.ply' 'texture displacement' 'fields' 'float edgelength' 0.05")));
    auto depths = [&](const std::string &flags) {
        const Image image = Render(flags + " relief.pbrt").image;
        std::pair<int, int> counts(0, 0);  // numbers of pixels at z = 5 and at z = 3
        for (int i = 0; i < 32 * 32; ++i) {
            const Float z = image.Get({i % 32, i / 32}, image.FindChannel("P.Z"));
            counts.first += std::abs(z - 5) < 1e-4f;
            counts.second += std::abs(z - 3) < 1e-4f;
        }
        return counts;
    };
    auto [low, high] = depths("");
    EXPECT_GT(low, 100);
    EXPECT_GT(high, 100);
    EXPECT_EQ(depths("--displacement-edge-scale 1000"), std::pair(32 * 32, 0));
}

TEST_F(Images, SolidTexturesOfAMovingShapeLieWhereItStarts) {
    Write("square.ply", kSquare);
    const auto depths = [&](const std::string &parameter, const std::string &motion) {
        Write("solid.pbrt",
              SceneText()
                  .Camera(15)
                  .Film(16, 16, "'bool savefp16' false", "gbuffer")
                  .Samples(1)
                  .World(Objects()
                             .Light("point")
                             .Add("Texture 'cells' 'float' 'checkerboard' 'integer dimension' 3")
                             .Add("Translate 1 0 0.5 ActiveTransform EndTime " + motion + " ActiveTransform All")
                             .Shape("plymesh", "'string filename' 'square.ply' 'float edgelength' 0.1 'texture " +
                                                   parameter + "' 'cells'")));
        const Image image = Render("solid.pbrt").image;
        std::vector<Float> all;
        ForEachPixel(image, [&](Point2i p) { all.push_back(image.Get(p, image.FindChannel("P.Z"))); });
        return all;
    };
    for (const char *parameter : {"alpha", "displacement"}) {
        const std::vector<Float> still = depths(parameter, ""), moving = depths(parameter, "Translate 0 0 1e-5");
        for (size_t i = 0; i < still.size(); ++i) EXPECT_NEAR(moving[i], still[i], 1e-3f) << parameter << " " << i;
    }
}

TEST_F(Images, ErrorAgainstAReferenceFallsWaveByWave) {
    Render("--spp 400 --seed 99 scene.pbrt", "reference.exr");
    const ImageFile file =
        Render("--spp 64 --mse-reference-image reference.exr --mse-reference-out mse.txt scene.pbrt");
    std::istringstream lines(Read("mse.txt"));
    std::vector<double> mse;
    int samples = 0;
    char comma = 0;
    for (double error = 0; lines >> samples >> comma >> error;) mse.push_back(error);
    ASSERT_GE(mse.size(), 5u);
    EXPECT_GT(mse.back(), 0);
    EXPECT_LT(mse.back(), mse.front() / 8);
    EXPECT_NEAR(NumberOf(file, "MSE"), mse.back(), 1e-5 * mse.back());
    const std::string part = "--spp 400 --seed 99 --pixelbounds 13 19 10 14 --mse-reference-out part.txt scene.pbrt ";
    EXPECT_EQ(NumberOf(Render(part + "--mse-reference-image reference.exr"), "MSE"), 0);
    ExpectErrors({{"--quick --mse-reference-image reference.exr --mse-reference-out quick.txt scene.pbrt",
                   {"reference.exr: ", "32 x 24", "8 x 6"}}});
}

TEST_F(Images, AResumedRenderKeepsTheErrorsOfEarlierWaves) {
    Render("--spp 1 scene.pbrt", "reference.exr");
    const std::string render =
        "--mse-reference-image reference.exr --mse-reference-out mse.txt --checkpoint c.chk --resume scene.pbrt ";
    Render(render + "--spp 2");
    const std::string first = Read("mse.txt");
    Render(render + "--spp 4");
    EXPECT_TRUE(Read("mse.txt").starts_with(first + "3, ")) << Read("mse.txt");
}

}  // namespace pbrt::test
